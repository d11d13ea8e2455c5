#include <algorithm>
#include <cmath>

#include "coppice/base/id.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/base/parallel.h"
#include "coppice/ramification/branches_internal.h"

namespace coppice::ramification_internal {
namespace {

/// Returns the continuation of a node that is not a root: the child with the maximum sum of the cosine of the
/// bend and the radius relative to the thickest child.
NodeId straight_on(const Skeleton& s, NodeId n) {
    const auto children = s.children(n);
    if (children.empty()) return NodeId::none();
    if (s.is_root(n)) return s.leader(n);
    const auto way = [&](NodeId c) {
        return normalized(Vec3d(s.position(c)) - Vec3d(s.position(s.parent(c))), Vec3d{});
    };
    const Vec3d in = way(n);
    const double thickest = double{s.radius(s.leader(n))};
    const auto score = [&](NodeId c) { return dot(in, way(c)) + s.radius(c) / thickest; };
    return *std::ranges::max_element(children, {}, score);
}

}  // namespace

std::uint32_t Path::segment_at(double t) const {
    const auto after = std::upper_bound(arcs_.begin() + 1, arcs_.end() - 1, t);
    return static_cast<std::uint32_t>(after - arcs_.begin()) - 1;
}

Vec3d Path::position(double t) const {
    const std::uint32_t i = segment_at(t);
    return lerp(points_[i], points_[i + 1], (t - arcs_[i]) / (arcs_[i + 1] - arcs_[i]));
}

double Path::radius(double t) const {
    const std::uint32_t i = segment_at(t);
    const double part = std::clamp((t - arcs_[i]) / (arcs_[i + 1] - arcs_[i]), 0.0, 1.0);
    return radii_[i] + part * (radii_[i + 1] - radii_[i]);
}

Vec3d Path::direction(double t, double within) const {
    const std::uint32_t i = segment_at(t);
    return normalized(position(t + within) - position(t - within), normalized(points_[i + 1] - points_[i]));
}

Path::Near Path::nearest_in(std::uint32_t segment, Vec3d p) const {
    const Vec3d a = points_[segment], d = points_[segment + 1] - a;
    const double part = closest_parameter(p, a, d);
    const double r = radii_[segment] + part * (radii_[segment + 1] - radii_[segment]);
    return {std::lerp(arcs_[segment], arcs_[segment + 1], part), distance(p, a + d * part) - r};
}

Path::Near Path::nearest(std::uint32_t& segment, Vec3d p) const {
    Near best = nearest_in(segment, p);
    for (const int step : {1, -1}) {
        for (;;) {
            const std::uint32_t next = segment + static_cast<std::uint32_t>(step);
            if (next >= segment_count()) break;
            const Near there = nearest_in(next, p);
            if (there.outside >= best.outside) break;
            best = there;
            segment = next;
        }
    }
    return best;
}

Branches::Branches(const Skeleton& s) : branch_of_(s.size()), arc_of_(s.size()) {
    std::vector<NodeId> next(s.size());
    for (const NodeId n : nodes(s)) next[n.index()] = straight_on(s, n);
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n) || next[s.parent(n).index()] != n) add_branch(s, n, next);
    }
    first_lateral_.assign(count() + 1, 0);
    for (const Branch& b : branches_) {
        if (b.parent != kNoIndex) ++first_lateral_[b.parent];
    }
    lateral_.resize(exclusive_scan(std::span(first_lateral_)));
    std::vector<std::uint32_t> place(first_lateral_);
    for (std::uint32_t b = 0; b < count(); ++b) {
        if (branches_[b].parent != kNoIndex) lateral_[place[branches_[b].parent]++] = b;
    }
}

void Branches::add_point(Vec3d p, double r, NodeId node) {
    Branch& b = branches_.back();
    const double step = b.point_count == 0 ? 0 : distance(points_.back(), p);
    if (b.point_count > 0 && step < 1e-6 * r) return;
    arcs_.push_back(b.point_count == 0 ? 0 : arcs_.back() + step);
    points_.push_back(p);
    radii_.push_back(r);
    nodes_.push_back(node);
    ++b.point_count;
}

void Branches::add_branch(const Skeleton& s, NodeId head, std::span<const NodeId> next) {
    const std::uint32_t b = count();
    branches_.push_back({.first_point = static_cast<std::uint32_t>(points_.size())});
    head_.push_back(head);
    if (!s.is_root(head)) {
        const NodeId from = s.parent(head);
        branches_[b].parent = branch_of_[from.index()];
        branches_[b].joint = arc_of_[from.index()];
        const double own = std::min(double{s.radius(from)}, double{s.radius(head)});
        add_point(Vec3d(s.position(from)), own, head);
    }
    for (NodeId n = head; n; n = next[n.index()]) {
        add_point(Vec3d(s.position(n)), double{s.radius(n)}, n);
        branch_of_[n.index()] = b;
        arc_of_[n.index()] = arcs_.back();
    }
    if (branches_[b].point_count == 1) {
        // No length: add a point slightly above to define a direction.
        const Vec3d p = points_.back();
        const double r = radii_.back();
        add_point(p + Vec3d{0, 0, 0.01 * r}, r, nodes_.back());
    }
}

}  // namespace coppice::ramification_internal
