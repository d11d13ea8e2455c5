#include "coppice/base/segment_distance.h"
#include "coppice/extract/cloud/strand_internal.h"

#include <algorithm>
#include <cmath>

namespace coppice::extract_internal {
namespace {

constexpr double kFirstReach = 0.75;  // [spacing] from the path, where points are gathered at first
constexpr double kWiden = 1.5;        // times the reach, as long as the branch goes on beyond it
constexpr double kMostReach = 4;      // [spacing]
constexpr double kGrowth = 1.25;      // times the mean distance: a branch that goes on beyond the reach
constexpr double kOfOwner = 2.3;      // [radius] of what the branch leaves, less
constexpr double kLess = 0.6;         // [spacing]: no branch is much thicker
constexpr double kStep = 0.8;         // [radius] between nodes, at least
constexpr double kMostNodes = 1e6;
constexpr double kWindow = 1.5;  // [step] along the line, from which a node takes its points

}  // namespace

Strand::Strand(std::span<const Vec3> points, const Graph& graph, std::span<const float> spacing,
               std::span<const std::uint32_t> node, double step)
    : points_(points), graph_(graph), spacing_(spacing), node_(node), step_(step), seen_(points.size(), 0) {}

std::uint32_t Strand::trace(std::uint32_t start, const Paths& paths) {
    path_.clear();
    line_.clear();
    std::uint32_t p = start;
    double sum = 0;
    for (; node_[p] == kNone; p = paths.parent[p]) {
        path_.push_back(p);
        sum += spacing_[p];
    }
    about_ = path_.empty() ? double{spacing_[p]} : sum / static_cast<double>(path_.size());
    std::ranges::reverse(path_);
    line_.push_back(Vec3d(points_[p]));
    for (const std::uint32_t q : path_) line_.push_back(Vec3d(points_[q]));
    return p;
}

double Strand::length() const {
    double sum = 0;
    for (std::size_t i = 1; i < line_.size(); ++i) sum += distance(line_[i], line_[i - 1]);
    return sum;
}

/// Draws the line to the middle of itself; its ends stay.
void Strand::smooth() {
    constexpr int kPasses = 3;
    std::vector<Vec3d> moved = line_;
    for (int pass = 0; pass < kPasses; ++pass) {
        for (std::size_t i = 1; i + 1 < line_.size(); ++i)
            moved[i] = 0.5 * line_[i] + 0.25 * (line_[i - 1] + line_[i + 1]);
        line_.swap(moved);
    }
}

/// The nearest place on the line to a point, sought from place `about` on.
Strand::Member Strand::foot(std::uint32_t point, double about) const {
    constexpr std::size_t kAside = 4;
    const Vec3d p(points_[point]);
    const std::size_t most = line_.size() - 2;
    Member best{point, 0, std::numeric_limits<double>::infinity()};
    std::size_t k = std::min(static_cast<std::size_t>(about), most);
    for (bool moves = true; moves;) {
        const double before = best.squared;
        const std::size_t first = k < kAside ? 0 : k - kAside, last = std::min(k + kAside, most);
        for (std::size_t j = first; j <= last; ++j) {
            const Vec3d d = line_[j + 1] - line_[j];
            const double t = closest_parameter(p, line_[j], d);
            const double squared = length_squared(p - line_[j] - d * t);
            if (squared < best.squared) best = {point, static_cast<double>(j) + t, squared};
        }
        const std::size_t next = std::min(static_cast<std::size_t>(best.t), most);
        moves = best.squared < before && next != k;
        k = next;
    }
    return best;
}

/// Collects the free points within reach of the line that hang together with the path; returns their mean
/// distance from the line [m].
double Strand::gather(double reach) {
    ++round_;
    members_.clear();
    for (std::size_t k = 0; k < path_.size(); ++k) {
        const double share = static_cast<double>(k + 1) / static_cast<double>(path_.size());
        members_.push_back(foot(path_[k], share * static_cast<double>(line_.size() - 1)));
        seen_[path_[k]] = round_;
    }
    for (std::size_t i = 0; i < members_.size(); ++i) {
        const Member from = members_[i];
        for (std::uint32_t e = graph_.first[from.point]; e < graph_.first[from.point + 1]; ++e) {
            const std::uint32_t q = graph_.to[e];
            if (seen_[q] == round_ || node_[q] != kNone) continue;
            seen_[q] = round_;
            const Member member = foot(q, from.t);
            if (member.squared <= reach * reach) members_.push_back(member);
        }
    }
    double sum = 0;
    for (const Member& m : members_) sum += std::sqrt(m.squared);
    return sum / static_cast<double>(members_.size());
}

void Strand::recentre() {
    way_.assign(line_.size(), 0);
    for (std::size_t i = 1; i < line_.size(); ++i) way_[i] = way_[i - 1] + distance(line_[i], line_[i - 1]);
    const double whole = way_.back();
    const double wanted = whole / std::max(step_ * about_, kStep * radius_);
    const auto count = static_cast<std::size_t>(std::clamp(wanted, 1.0, kMostNodes));
    const double h = whole / static_cast<double>(count);
    if (!(h > 0)) return;
    moments_.assign(count + 1, {});
    for (const Member& m : members_) {
        const std::size_t k = std::min(static_cast<std::size_t>(m.t), line_.size() - 2);
        const double s = std::lerp(way_[k], way_[k + 1], m.t - static_cast<double>(k)) / h;
        const Vec3d p(points_[m.point]);
        const auto first = static_cast<std::size_t>(std::max(0.0, std::ceil(s - kWindow)));
        for (std::size_t j = first; j <= count && static_cast<double>(j) < s + kWindow; ++j) {
            const double x = s - static_cast<double>(j), w = 1 - x * x / (kWindow * kWindow);
            Moments& sum = moments_[j];
            sum.w += w;
            sum.x += w * x;
            sum.xx += w * x * x;
            sum.p += w * p;
            sum.xp += (w * x) * p;
        }
    }
    std::vector<Vec3d> next(count + 1);
    std::size_t k = 0;
    for (std::size_t j = 0; j <= count; ++j) {
        const double along = h * static_cast<double>(j);
        while (k + 2 < line_.size() && way_[k + 1] < along) ++k;
        const double l = way_[k + 1] - way_[k];
        next[j] = lerp(line_[k], line_[k + 1], l > 0 ? std::clamp((along - way_[k]) / l, 0.0, 1.0) : 0);
        const Moments& sum = moments_[j];
        if (!(sum.w > 0)) continue;
        // A line needs points on some length; else their mean.
        const double spread = sum.xx * sum.w - sum.x * sum.x;
        next[j] = spread > 0.05 * sum.w * sum.w ? (sum.p * sum.xx - sum.xp * sum.x) / spread : sum.p / sum.w;
    }
    line_.swap(next);
}

void Strand::shape(double thickest) {
    smooth();
    radius_ = 0;
    double reach = kFirstReach * about_;
    gather(reach);
    recentre();
    radius_ = gather(reach);
    const double most = std::min(kMostReach * about_, kOfOwner * thickest - kLess * about_);
    std::vector<Vec3d> line;
    std::vector<Member> members;
    for (; kWiden * reach <= most; reach *= kWiden) {
        line = line_;
        members = members_;
        recentre();
        const double wider = gather(kWiden * reach);
        if (wider < kGrowth * radius_) {
            line_.swap(line);
            members_.swap(members);
            break;
        }
        radius_ = wider;
    }
}

std::uint32_t Strand::add_to(DraftTree& tree, std::vector<std::uint32_t>& node, std::uint32_t owner) const {
    const std::uint32_t first = tree.size();
    const double radius = std::min(radius_, tree.radius[owner]);
    std::uint32_t above = owner;
    for (std::size_t k = 1; k < line_.size(); ++k) above = tree.add(above, line_[k], radius);
    for (const Member& m : members_)
        node[m.point] = first + std::min(static_cast<std::uint32_t>(m.t), tree.size() - first - 1);
    return above;
}

}  // namespace coppice::extract_internal
