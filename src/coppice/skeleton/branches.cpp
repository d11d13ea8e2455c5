#include "coppice/skeleton/branches.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/skeleton/architecture.h"
#include "coppice/skeleton/frustum.h"
#include "coppice/skeleton/measure.h"

namespace coppice {
namespace {

Vec3d place(const Skeleton& s, NodeId n) { return Vec3d(s.position(n)); }

/// Returns the direction of a lateral from its branching node; zero if all of its nodes coincide.
Vec3d direction_of_lateral(const Skeleton& s, NodeId first) {
    const NodeId from = s.parent(first);
    const double beyond = 2 * double{s.radius(from)};
    NodeId n = first;
    while (!s.is_tip(n) && distance(place(s, n), place(s, from)) < beyond) n = s.leader(n);
    return place(s, n) - place(s, from);
}

/// Returns the direction of the axis through a node, below it; above it for a root.
Vec3d direction_of_axis(const Skeleton& s, NodeId n) {
    if (!s.is_root(n)) return place(s, n) - place(s, s.parent(n));
    return s.is_tip(n) ? Vec3d{} : place(s, s.leader(n)) - place(s, n);
}

double angle_between(Vec3d a, Vec3d b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

/// Returns the branch that begins at a node, without the totals of its segments.
Branch begin_branch(const Skeleton& s, NodeId first, NodeId root) {
    Branch out{.first = first, .diameter = 2 * double{s.radius(first)}};
    const bool is_stem = s.is_root(first);
    const NodeId base = is_stem ? first : s.parent(first);
    out.height = place(s, base).z - place(s, root).z;
    const Vec3d direction = is_stem ? direction_of_axis(s, first) : direction_of_lateral(s, first);
    out.azimuth = std::atan2(direction.y, direction.x);
    out.zenith = angle_between(direction, {0, 0, 1});
    if (!is_stem) out.angle = angle_between(direction, direction_of_axis(s, base));
    return out;
}

/// SegmentRange of a segment, as parameters from the parent in [0, 1].
struct SegmentRange {
    double from = 0, to = 1;

    void cut_to(double low, double high) {
        from = std::max(from, low);
        to = std::min(to, high);
    }
    /// Restricts the part to where a value that is linear from a to b is at least `least`.
    void cut_to_min(double least, double a, double b) {
        if (a >= least && b >= least) return;
        if (a < least && b < least) return cut_to(1, 0);
        const double t = (least - a) / (b - a);
        a < least ? cut_to(t, 1) : cut_to(0, t);
    }
    bool empty() const { return !(from < to); }
};

Frustum cut_part(const Frustum& cone, const SegmentRange& part) {
    return {std::lerp(cone.radius_a, cone.radius_b, part.from),
            std::lerp(cone.radius_a, cone.radius_b, part.to), cone.length * (part.to - part.from)};
}

/// Sums the parts of segments with at least a minimum diameter.
class TimberSum {
  public:
    TimberSum(const Skeleton& s, const BranchTable& table, double top_diameter, double stump_height)
        : s_(s),
          table_(table),
          top_diameter_(top_diameter),
          stump_height_(stump_height),
          roots_(tree_roots(s)),
          trees_(s.tree_count()) {}

    std::vector<TimberVolume> run() {
        for (const NodeId n : nodes(s_)) {
            if (!s_.is_root(n)) add_wood(n);
        }
        for (const Branch& branch : table_.branches) {
            if (branch.is_stem()) add_stem(branch);
        }
        return std::move(trees_);
    }

  private:
    const Branch& find_branch(NodeId n) const { return table_.branches[table_.branch_of[n.index()]]; }

    /// Returns the part of a segment above the stump: all of it if it does not belong to the stem.
    SegmentRange above_stump(NodeId n) const {
        SegmentRange out;
        if (!find_branch(n).is_stem()) return out;
        const Segment segment = s_.segment(n);
        out.cut_to_min(place(s_, roots_[n.index()]).z + stump_height_, segment.a.z, segment.b.z);
        return out;
    }
    SegmentRange as_thick(NodeId n) const {
        SegmentRange out;
        const Frustum cone = frustum(s_.segment(n));
        out.cut_to_min(top_diameter_, 2 * cone.radius_a, 2 * cone.radius_b);
        return out;
    }

    void add_wood(NodeId n) {
        SegmentRange part = above_stump(n);
        const SegmentRange thick = as_thick(n);
        part.cut_to(thick.from, thick.to);
        if (!part.empty())
            trees_[find_branch(n).tree].volume += cut_part(frustum(s_.segment(n)), part).volume();
    }

    /// Adds the stem from the stump to the end of its last part with the minimum diameter.
    void add_stem(const Branch& stem) {
        std::vector<NodeId> axis;
        for (NodeId n = table_.next_of[stem.first.index()]; n; n = table_.next_of[n.index()])
            axis.push_back(n);
        while (!axis.empty() && as_thick(axis.back()).empty()) axis.pop_back();
        for (const NodeId n : axis) {
            SegmentRange part = above_stump(n);
            if (n == axis.back()) part.cut_to(0, as_thick(n).to);
            if (part.empty()) continue;
            const Frustum cone = cut_part(frustum(s_.segment(n)), part);
            trees_[stem.tree].stem_length += cone.length;
            trees_[stem.tree].stem_volume += cone.volume();
        }
    }

    const Skeleton& s_;
    const BranchTable& table_;
    double top_diameter_, stump_height_;
    std::vector<NodeId> roots_;
    std::vector<TimberVolume> trees_;
};

}  // namespace

BranchTable list_branches(const Skeleton& s) {
    const std::vector<std::uint32_t> order = axis_orders(s);
    return list_branches(s, order, order);
}

BranchTable list_branches(const Skeleton& s, std::span<const std::uint32_t> order,
                          std::span<const std::uint32_t> axis) {
    COPPICE_ASSERT(order.size() == s.size() && axis.size() == s.size());
    BranchTable out;
    out.branch_of.resize(s.size());
    out.position_of.resize(s.size(), 0);
    out.next_of.resize(s.size());
    const std::vector<NodeId> roots = tree_roots(s);
    std::uint32_t trees = 0;
    for (const NodeId n : nodes(s)) {
        const std::uint32_t i = n.index(), p = s.is_root(n) ? i : s.parent(n).index();
        const std::uint32_t parent = i == p ? kNoIndex : out.branch_of[p];
        std::uint32_t& index = out.branch_of[i];
        index = parent;
        if (i == p || axis[i] != axis[p] || order[i] != order[p]) {
            index = static_cast<std::uint32_t>(out.branches.size());
            out.branches.push_back(begin_branch(s, n, roots[n.index()]));
            Branch& branch = out.branches.back();
            branch.parent = parent;
            branch.tree = s.is_root(n) ? trees++ : out.branches[parent].tree;
            branch.order = order[i];
        } else if (!out.next_of[p]) {
            out.next_of[p] = n;
        }
        if (s.is_root(n)) continue;
        Branch& branch = out.branches[index];
        const Frustum cone = frustum(s.segment(n));
        out.position_of[i] = ++branch.segments;
        branch.length += cone.length;
        branch.area += cone.mantle();
        branch.volume += cone.volume();
    }
    return out;
}

std::vector<TimberVolume> timber_volumes(const Skeleton& s, const BranchTable& table, double top_diameter,
                                         double stump_height) {
    if (!(top_diameter > 0) || !std::isfinite(top_diameter))
        throw InvalidInput(fmt::format("the top diameter is {:g}; it must be above 0", top_diameter));
    if (!(stump_height >= 0) || !std::isfinite(stump_height))
        throw InvalidInput(
            fmt::format("the height of the stump is {:g}; it must be 0 or more", stump_height));
    return TimberSum(s, table, top_diameter, stump_height).run();
}

}  // namespace coppice
