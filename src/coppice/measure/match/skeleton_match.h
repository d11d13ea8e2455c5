#pragma once

#include <algorithm>
#include <cstdint>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/mesh/statistics.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// How near is near. Every radius is the reference's at the place in question, so that a wrong radius of what
/// is judged never makes it look better.
struct CompareOptions {
    float step = 0.25f;    ///< [radius] distance of the samples along an axis
    float within = 1;      ///< [radius] from an axis: what lies nearer is covered
    float tip_reach = 2;   ///< [radius] between tips that match
    float fork_reach = 2;  ///< [radius] between junctions that match
};

template <class Self, class Visitor>
requires SameOptions<Self, CompareOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"step", "distance of the samples along an axis", Unit::radius, 0.01, 100}, o.step);
    visit(common_field("within", "Maximum distance from an axis at which it counts as covered", Unit::radius,
                       1e-3, 100),
          o.within);
    visit(common_field("tip_reach", "Maximum distance between tips that match", Unit::radius, 1e-3, 100),
          o.tip_reach);
    visit(Field{"fork_reach", "greatest distance of junctions that match", Unit::radius, 1e-3, 100},
          o.fork_reach);
}

/// One quantity of both skeletons.
struct Quantity {
    double reference = 0;  ///< of the reference
    double found = 0;      ///< of what was found
    /// 0 where the reference has none
    double ratio() const { return reference > 0 ? found / reference : 0; }
    friend bool operator==(const Quantity&, const Quantity&) = default;  ///< member by member
};

/// Nodes of one kind, paired one to one, the nearest first.
struct NodeMatches {
    std::uint64_t reference = 0;  ///< nodes of the reference
    std::uint64_t found = 0;      ///< nodes of what was found
    std::uint64_t matched = 0;    ///< pairs
    double percent() const {      ///< of the reference's; 100 where it has none
        return reference > 0 ? 100.0 * static_cast<double>(matched) / static_cast<double>(reference) : 100;
    }
    /// nodes of the reference without a partner
    std::uint64_t missed() const { return reference - matched; }
    std::uint64_t spurious() const { return found - matched; }  ///< nodes found without a partner
    friend bool operator==(const NodeMatches&, const NodeMatches&) = default;  ///< member by member
};

/// A skeleton that was found, held against the reference. Shares are 0 where there is no length to share.
struct SkeletonMatch {
    Quantity length;               ///< [m]
    Quantity volume;               ///< [m^3] of the segments; what overlaps counts twice
    double covered_percent = 0;    ///< of the reference's length: an axis found lies within one radius
    double true_percent = 0;       ///< of the length found: inside the reference, within one of its radii
    double off_axis = 0;           ///< [radius] mean along what was found: least rho (see CapsuleTree)
    Statistics reference_nodes_m;  ///< [m] from every node of the reference to the nearest axis found
    Statistics reference_nodes_r;  ///< [radius] the same in radii of the node
    Statistics found_nodes_m;      ///< [m] from every node found to the nearest axis of the reference
    Statistics found_nodes_r;      ///< the least rho of every node found
    /// Ends other than roots. They match with any end, so that it does not matter which one the root is: what
    /// was found counts where it matches, or is a tip that matches nothing.
    NodeMatches tips;
    double tips_reached = 0;  ///< per cent of the reference's tips that an axis found passes within tip_reach
    NodeMatches junctions;    ///< nodes with three neighbours or more
    /// |radius found / radius of the reference - 1| at the samples of the reference that are covered: against
    /// the covering segment that is nearest, where turning by a right angle counts like one radius of way.
    Statistics radius_error;
    double radius_bias = 0;  ///< mean of the same with its sign
    friend bool operator==(const SkeletonMatch&, const SkeletonMatch&) = default;  ///< member by member
};

/// Holds `found` against `reference`. Both are brought into one frame; neither how densely nodes lie nor
/// where the roots are matters to the shares and matches. Trees of a single node have no axis: they count as
/// nodes and are otherwise not seen. A skeleton of n segments is sampled at 64 n + 65,536 places at most; the
/// longest segments, in radii, more coarsely where it takes that. O(n log n) [n nodes and samples]; the same
/// bits for any number of threads. Throws InvalidInput for an option out of its range, Cancelled.
SkeletonMatch compare(const Skeleton& reference, const Skeleton& found, const CompareOptions& options = {},
                      const Context& ctx = {});

/// The power of ten, from 100 on or up to 1/100, by which `found` is larger than `reference` where both
/// hardly match, as centimetres and metres differ; 1 where the units seem to agree. `match` is that of the
/// two.
double unit_ratio(const SkeletonMatch& match, const Skeleton& reference, const Skeleton& found);

/// Calls visit(name, number) for every figure, in order.
template <class Visitor>
void visit_figures(const Quantity& q, Visitor&& visit) {
    visit("reference", q.reference);
    visit("found", q.found);
    visit("ratio", q.ratio());
}

/// Calls visit(name, number) for every figure, in order.
template <class Visitor>
void visit_figures(const NodeMatches& m, Visitor&& visit) {
    visit("percent", m.percent());
    visit("reference", m.reference);
    visit("found", m.found);
    visit("matched", m.matched);
    visit("missed", m.missed());
    visit("spurious", m.spurious());
}

/// Calls visit(name, figure) for every figure, in order; most are structs with figures of their own.
template <class Visitor>
void visit_figures(const SkeletonMatch& m, Visitor&& visit) {
    visit("length_m", m.length);
    visit("volume_m3", m.volume);
    visit("covered_percent", m.covered_percent);
    visit("true_percent", m.true_percent);
    visit("off_axis_r", m.off_axis);
    visit("tips", m.tips);
    visit("tips_reached_percent", m.tips_reached);
    visit("junctions", m.junctions);
    visit("radius_error", m.radius_error);
    visit("radius_bias", m.radius_bias);
    visit("reference_nodes_m", m.reference_nodes_m);
    visit("reference_nodes_r", m.reference_nodes_r);
    visit("found_nodes_m", m.found_nodes_m);
    visit("found_nodes_r", m.found_nodes_r);
}

}  // namespace coppice
