#pragma once

#include <algorithm>
#include <cstdint>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/mesh/statistics.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Distances of compare(). All radii are the local radii of the reference, so that a wrong radius of the
/// evaluated skeleton never improves its result.
struct CompareOptions {
    float step = 0.25f;    ///< [radius] distance of the samples along an axis
    float within = 1;      ///< [radius] maximum distance to an axis that covers a point
    float tip_reach = 2;   ///< [radius] maximum distance between tips that match
    float fork_reach = 2;  ///< [radius] maximum distance between junctions that match
};

/// Lists the members for front ends.
void list_fields(CompareOptions& o, FieldList& list);

/// One quantity of both skeletons.
struct Quantity {
    double reference = 0;  ///< of the reference
    double found = 0;      ///< of the evaluated skeleton
    /// 0 if the value of the reference is 0
    double ratio() const { return reference > 0 ? found / reference : 0; }
    friend bool operator==(const Quantity&, const Quantity&) = default;  ///< member by member
};

/// Nodes of one kind, paired one to one, the nearest first.
struct NodeMatches {
    std::uint64_t reference = 0;  ///< number of nodes of the reference
    std::uint64_t found = 0;      ///< number of nodes of the evaluated skeleton
    std::uint64_t matched = 0;    ///< number of pairs
    double percent() const {      ///< of the reference's nodes; 100 if it has no such nodes
        return reference > 0 ? 100.0 * static_cast<double>(matched) / static_cast<double>(reference) : 100;
    }
    /// nodes of the reference without a partner
    std::uint64_t missed() const { return reference - matched; }
    std::uint64_t spurious() const { return found - matched; }  ///< nodes found without a partner
    friend bool operator==(const NodeMatches&, const NodeMatches&) = default;  ///< member by member
};

/// Comparison of an evaluated skeleton with the reference. Shares are 0 if the total length is 0.
struct SkeletonMatch {
    Quantity length;  ///< [m]
    Quantity volume;  ///< [m^3] of the segments; overlaps are counted twice
    /// Of the reference's length: an axis of the evaluated skeleton is within one radius.
    double covered_percent = 0;
    double true_percent = 0;  ///< of the evaluated length: inside the reference, within one of its radii
    double off_axis = 0;  ///< [radius] mean of the smallest rho (see CapsuleTree) along the evaluated axes
    Statistics reference_nodes_m;  ///< [m] from every node of the reference to the nearest evaluated axis
    Statistics reference_nodes_r;  ///< [radius] the same in radii of the node
    Statistics found_nodes_m;      ///< [m] from every evaluated node to the nearest axis of the reference
    Statistics found_nodes_r;      ///< the smallest rho of every evaluated node
    /// Ends other than roots. They match any end, so that the choice of the root does not matter: an
    /// evaluated end is counted if it is matched, or if it is an unmatched tip.
    NodeMatches tips;
    double tips_reached = 0;  ///< share [%] of the reference's tips within tip_reach of an evaluated axis
    NodeMatches junctions;    ///< nodes with at least three neighbours
    /// |evaluated radius / radius of the reference - 1| at the samples of the reference that are covered:
    /// relative to the nearest covering segment, where a turn by a right angle counts as one radius of
    /// distance.
    Statistics radius_error;
    double radius_bias = 0;  ///< signed mean of the same
    friend bool operator==(const SkeletonMatch&, const SkeletonMatch&) = default;  ///< member by member
};

/// Compares `found` with `reference`. Both are transformed to one frame; shares and matches depend neither on
/// the density of the nodes nor on the positions of the roots. Trees of a single node have no axis: they
/// count as nodes and are otherwise ignored. A skeleton of n segments is sampled at 64 n + 65,536 points at
/// most; if necessary, the longest segments, in radii, are sampled more coarsely. O(n log n) [n nodes and
/// samples]. The result does not depend on the number of threads. Throws InvalidInput for an option out of
/// range, Cancelled.
SkeletonMatch compare(const Skeleton& reference, const Skeleton& found, const CompareOptions& options = {},
                      const Context& ctx = {});

/// Returns the power of ten, at least 100 or at most 1/100, by which `found` is larger than `reference` if
/// both hardly match, as with centimetres and metres; 1 if the units seem to agree. `match` must be the
/// comparison of the two.
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

/// Calls visit(name, figure) for every figure, in order; most are structs with their own figures.
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
