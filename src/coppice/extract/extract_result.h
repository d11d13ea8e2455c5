#pragma once

#include <cstdint>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Measure of how well the input data support a node of an extracted skeleton.
struct NodeConfidence {
    std::uint32_t samples = 0;  ///< number of samples of the segment that ends at this node
    float residual = 0;         ///< [radius] mean distance of the samples from its surface; 0 without samples
    float radius_low = 0;       ///< [m] lower bound of the 90 % confidence interval of the radius
    float radius_high = 0;      ///< [m] upper bound of that interval; both bounds are 0 for meshes
    float evidence = 1;         ///< weight of the points in the radius, against the prior of trees; in [0, 1]
    friend bool operator==(const NodeConfidence&, const NodeConfidence&) = default;  ///< compares all members
};

/// Counts of the features found during the extraction of a skeleton from a surface or a point cloud.
struct ExtractReport {
    std::uint64_t samples = 0;        ///< number of vertices or points that the skeleton was fitted to
    std::uint32_t components = 0;     ///< number of connected components of the input that were kept
    std::uint32_t trees = 0;          ///< number of roots of the skeleton
    std::uint32_t joined = 0;         ///< number of components that were attached to another one
    std::uint32_t loops = 0;          ///< number of closed loops, each of which was cut at its thinnest place
    std::uint32_t pruned_twigs = 0;   ///< number of removed ends that were too short for a branch
    std::uint32_t repaired_tips = 0;  ///< number of ends moved to the end of the surface minus one radius
    float residual = 0;               ///< [radius] mean distance from the surface over all samples
    double inferred = 0;  ///< [m] length where the prior has more weight in the radius than the measurement
    double limited = 0;  ///< [m] length where the radius was reduced to the maximum that the stem can support
    friend bool operator==(const ExtractReport&, const ExtractReport&) = default;  ///< compares all members
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
    visit("inferred_m", r.inferred);
    visit("limited_m", r.limited);
}

/// Skeleton extracted from a surface or a point cloud.
struct ExtractResult {
    Skeleton skeleton;                       ///< in the coordinate frame of the input
    std::vector<NodeConfidence> confidence;  ///< one per node
    ExtractReport report;                    ///< counts of the extraction
};

}  // namespace coppice
