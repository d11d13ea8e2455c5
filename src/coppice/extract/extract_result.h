#pragma once

#include <cstdint>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// How well a node of an extracted skeleton is supported by what was measured.
struct NodeConfidence {
    std::uint32_t samples = 0;  ///< vertices or points whose nearest segment ends at this node
    float residual = 0;         ///< [radius] their mean distance from that segment's surface; 0 without any
    float radius_low = 0;       ///< [m] with `radius_high`: the true radius lies between in nine of ten cases
    float radius_high = 0;      ///< [m] 0 for meshes, which are not asked
    float evidence = 1;  ///< share of the points, against what trees are like, in the radius; in [0, 1]
    friend bool operator==(const NodeConfidence&, const NodeConfidence&) = default;  ///< member by member
};

/// What was found on the way from a surface or a cloud to a skeleton, counted.
struct ExtractReport {
    std::uint64_t samples = 0;       ///< vertices or points that the skeleton was fitted to
    std::uint32_t components = 0;    ///< connected pieces of the input that were kept
    std::uint32_t trees = 0;         ///< roots of the skeleton
    std::uint32_t joined = 0;        ///< pieces that were attached to another one
    std::uint32_t loops = 0;         ///< closed ways round, each cut where it is thinnest
    std::uint32_t pruned_twigs = 0;  ///< ends too short to be a branch
    std::uint32_t repaired_tips =
        0;                ///< ends moved along their axis to where the surface ends, less a radius
    float residual = 0;   ///< [radius] mean over all samples of the distance from the surface
    double presumed = 0;  ///< [m] of the length, where the radius is more what trees are like than measured
    double limited = 0;   ///< [m] of the length, where the radius was lowered to what the stem can bear
    friend bool operator==(const ExtractReport&, const ExtractReport&) = default;  ///< member by member
};

/// Calls visit(name, number) for every member, in order.
template <class Visitor>
void visit_figures(const ExtractReport& r, Visitor&& visit) {
    visit("samples", r.samples);
    visit("components", r.components);
    visit("trees", r.trees);
    visit("joined", r.joined);
    visit("loops", r.loops);
    visit("pruned_twigs", r.pruned_twigs);
    visit("repaired_tips", r.repaired_tips);
    visit("residual", r.residual);
    visit("presumed_m", r.presumed);
    visit("limited_m", r.limited);
}

/// A skeleton read off a surface or a cloud of points.
struct ExtractResult {
    Skeleton skeleton;                       ///< in the frame of the input
    std::vector<NodeConfidence> confidence;  ///< one per node
    ExtractReport report;                    ///< what was found
};

}  // namespace coppice
