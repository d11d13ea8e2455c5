#include "coppice/extract/cloud/centerline_internal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/id.h"
#include "coppice/base/kernel/segment_distance.h"

namespace coppice::extract_internal {
namespace {

// [spacing] initial distance from the path within which points are gathered
constexpr double kFirstReach = 0.75;
constexpr double kWiden = 1.5;    // factor of the reach as long as the branch continues beyond it
constexpr double kMaxReach = 4;   // [spacing] maximum reach
constexpr double kGrowth = 1.25;  // factor of the mean distance at which a branch continues beyond the reach
constexpr double kOfOwner = 2.3;  // [radius of the parent] maximum radius of a branch, reduced by
constexpr double kLess = 0.6;     // [spacing] this
constexpr double kNarrowest = 0.05, kNarrow = 0.3;  // [spacing] range of the radius of narrow branches
constexpr double kStep = 0.8;                       // [radius] minimum distance between nodes
constexpr double kMaxNodes = 1e6;
constexpr double kWindow = 1.5;  // [step] half-width of the window along the line for the points of a node

/// Smooths a line; its ends are fixed.
void smooth(std::vector<Vec3d>& line) {
    constexpr int kPasses = 3;
    std::vector<Vec3d> moved = line;
    for (int pass = 0; pass < kPasses; ++pass) {
        for (std::size_t i = 1; i + 1 < line.size(); ++i)
            moved[i] = 0.5 * line[i] + 0.25 * (line[i - 1] + line[i + 1]);
        line.swap(moved);
    }
}

/// Returns the closest point on a line to p, searched from index `from` on.
BranchPoint closest_on_line(std::span<const Vec3d> line, std::uint32_t point, Vec3d p, double from) {
    constexpr std::size_t kAside = 4;
    const std::size_t most = line.size() - 2;
    BranchPoint best{point, 0, std::numeric_limits<double>::infinity()};
    std::size_t k = std::min(static_cast<std::size_t>(from), most);
    for (bool moves = true; moves;) {
        const double before = best.squared;
        const std::size_t first = k < kAside ? 0 : k - kAside, last = std::min(k + kAside, most);
        for (std::size_t j = first; j <= last; ++j) {
            const Vec3d d = line[j + 1] - line[j];
            const double t = closest_parameter(p, line[j], d);
            const double squared = length_squared(p - line[j] - d * t);
            if (squared < best.squared) best = {point, static_cast<double>(j) + t, squared};
        }
        const std::size_t next = std::min(static_cast<std::size_t>(best.t), most);
        moves = best.squared < before && next != k;
        k = next;
    }
    return best;
}

/// Makes the points within reach the members; returns their mean distance from the line [m].
double gather_members(Centerline& branch, BranchPoints& points, double reach) {
    branch.members = points_about(branch, points, reach);
    double sum = 0;
    for (const BranchPoint& m : branch.members) sum += std::sqrt(m.squared);
    return sum / static_cast<double>(branch.members.size());
}

/// Moments of the points near a node of the line, as a function of the steps along it.
struct Moments {
    double w = 0, x = 0, xx = 0;
    Vec3d p, xp;

    void add(double along, double weight, Vec3d at) {
        w += weight;
        x += weight * along;
        xx += weight * along * along;
        p += weight * at;
        xp += (weight * along) * at;
    }
    /// Returns the position at the node on the line fitted to the points; their mean if they have no extent
    /// along it.
    Vec3d middle() const {
        const double spread = xx * w - x * x;
        return spread > 0.05 * w * w ? (p * xx - xp * x) / spread : p / w;
    }
};

/// Returns the moments about `count` + 1 nodes at intervals of `h` [m], where `way` [m] is the length up to
/// each point of the line.
std::vector<Moments> moments_along(const Centerline& branch, const BranchPoints& points,
                                   std::span<const double> way, std::size_t count, double h) {
    std::vector<Moments> moments(count + 1);
    for (const BranchPoint& m : branch.members) {
        const std::size_t k = std::min(static_cast<std::size_t>(m.t), branch.line.size() - 2);
        const double s = std::lerp(way[k], way[k + 1], m.t - static_cast<double>(k)) / h;
        const Vec3d p(points.position[m.point]);
        const auto first = static_cast<std::size_t>(std::max(0.0, std::ceil(s - kWindow)));
        for (std::size_t j = first; j <= count && static_cast<double>(j) < s + kWindow; ++j) {
            const double x = s - static_cast<double>(j);
            moments[j].add(x, 1 - x * x / (kWindow * kWindow), p);
        }
    }
    return moments;
}

/// Replaces the line by one through the middle of its members, with nodes at intervals of a step or most of a
/// radius.
void recentre(Centerline& branch, const BranchPoints& points) {
    const auto& line = branch.line;
    std::vector<double> way(line.size(), 0);
    for (std::size_t i = 1; i < line.size(); ++i) way[i] = way[i - 1] + distance(line[i], line[i - 1]);
    const double whole = way.back();
    const double wanted = whole / std::max(points.step * branch.spacing, kStep * branch.radius);
    const auto count = static_cast<std::size_t>(std::clamp(wanted, 1.0, kMaxNodes));
    const double h = whole / static_cast<double>(count);
    if (!(h > 0)) return;
    const std::vector<Moments> moments = moments_along(branch, points, way, count, h);
    std::vector<Vec3d> next(count + 1);
    std::size_t k = 0;
    for (std::size_t j = 0; j <= count; ++j) {
        const double along = h * static_cast<double>(j);
        while (k + 2 < line.size() && way[k + 1] < along) ++k;
        const double l = way[k + 1] - way[k];
        next[j] = lerp(line[k], line[k + 1], l > 0 ? std::clamp((along - way[k]) / l, 0.0, 1.0) : 0);
        if (moments[j].w > 0) next[j] = moments[j].middle();
    }
    branch.line.swap(next);
}

}  // namespace

std::vector<BranchPoint> points_about(const Centerline& branch, BranchPoints& points, double reach) {
    const auto& graph = points.graph;
    const std::uint32_t round = ++points.round;
    std::vector<BranchPoint> found;
    const auto closest = [&](std::uint32_t p, double from) {
        return closest_on_line(branch.line, p, Vec3d(points.position[p]), from);
    };
    for (std::size_t k = 0; k < branch.path.size(); ++k) {
        const double share = static_cast<double>(k + 1) / static_cast<double>(branch.path.size());
        found.push_back(closest(branch.path[k], share * static_cast<double>(branch.line.size() - 1)));
        points.seen[branch.path[k]] = round;
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
        const BranchPoint from = found[i];
        for (std::uint32_t e = graph.first[from.point]; e < graph.first[from.point + 1]; ++e) {
            const std::uint32_t q = graph.to[e];
            if (points.seen[q] == round || points.node[q] != kNoIndex) continue;
            points.seen[q] = round;
            const BranchPoint near = closest(q, from.t);
            if (near.squared <= reach * reach) found.push_back(near);
        }
    }
    return found;
}

std::uint32_t trace_path(Centerline& branch, const BranchPoints& points, std::uint32_t start,
                         const Paths& paths) {
    branch.path.clear();
    branch.line.clear();
    std::uint32_t p = start;
    double sum = 0;
    for (; points.node[p] == kNoIndex; p = paths.parent[p]) {
        branch.path.push_back(p);
        sum += points.spacing[p];
    }
    branch.spacing =
        branch.path.empty() ? double{points.spacing[p]} : sum / static_cast<double>(branch.path.size());
    std::ranges::reverse(branch.path);
    branch.line.push_back(Vec3d(points.position[p]));
    for (const std::uint32_t q : branch.path) branch.line.push_back(Vec3d(points.position[q]));
    return p;
}

double line_length(const Centerline& branch) {
    double sum = 0;
    for (std::size_t i = 1; i < branch.line.size(); ++i) sum += distance(branch.line[i], branch.line[i - 1]);
    return sum;
}

void fit_centerline(Centerline& branch, BranchPoints& points, double thickest) {
    smooth(branch.line);
    branch.radius = 0;
    double reach = kFirstReach * branch.spacing;
    gather_members(branch, points, reach);
    recentre(branch, points);
    branch.radius = gather_members(branch, points, reach);
    if (points.narrow) {
        branch.radius = std::clamp(branch.radius, kNarrowest * branch.spacing, kNarrow * branch.spacing);
        return;
    }
    const double most = std::min(kMaxReach * branch.spacing, kOfOwner * thickest - kLess * branch.spacing);
    for (; kWiden * reach <= most; reach *= kWiden) {
        const std::vector<Vec3d> line = branch.line;
        const std::vector<BranchPoint> members = branch.members;
        recentre(branch, points);
        const double wider = gather_members(branch, points, kWiden * reach);
        if (wider < kGrowth * branch.radius) {
            branch.line = line;
            branch.members = members;
            break;
        }
        branch.radius = wider;
    }
}

std::uint32_t add_branch(const Centerline& branch, InitialTree& tree, std::vector<std::uint32_t>& node,
                         std::uint32_t owner) {
    const std::uint32_t first = tree.size();
    const double radius = std::min(branch.radius, tree.radius[owner]);
    std::uint32_t last = owner;
    for (std::size_t k = 1; k < branch.line.size(); ++k) last = tree.add(last, branch.line[k], radius);
    for (const BranchPoint& m : branch.members)
        node[m.point] = first + std::min(static_cast<std::uint32_t>(m.t), tree.size() - first - 1);
    return last;
}

}  // namespace coppice::extract_internal
