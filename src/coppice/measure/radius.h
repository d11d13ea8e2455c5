#pragma once

#include <cstdint>

#include "coppice/base/context.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/statistics.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// How truly a surface keeps the radii of its skeleton. Deviations are rho - 1, where rho is the least
/// distance to a segment over the segment's radius there.
struct RadiusReport {
    Statistics all;  ///< deviation of every used vertex
    /// Of the vertices beside a segment, further than two radii from its ends where it ends in a branch node,
    /// root or tip.
    Statistics regular;
    /// Deviation of points spread evenly over the area of the faces, which chords lower where vertices lie on
    /// the radius. As many as vertices, at least 10,000.
    Statistics areas;
    /// Of every tip that vertices belong to: how far they reach beyond it along the last segment, in radii of
    /// the tip. A round tip reads 1.
    Statistics tip_reach;
    std::uint64_t tips = 0;                                                      ///< that vertices belong to
    friend bool operator==(const RadiusReport&, const RadiusReport&) = default;  ///< member by member
};

/// `capsules` must be those of `skeleton`, in the mesh's frame. O(n log m), n vertices and m nodes.
RadiusReport radius_deviation(const PolygonMesh& mesh, const Skeleton& skeleton, const CapsuleTree& capsules,
                              const Context& ctx = {});

/// Per vertex the distance to the nearest segment over its radius there, minus one: negative inside. NaN
/// where the skeleton has no segment. The skeleton may have another origin. O(n log m).
std::vector<float> vertex_deviations(const PolygonMesh& mesh, const Skeleton& skeleton,
                                     const Context& ctx = {});

/// Whether a surface covers all of its skeleton. Looks at the middle of each free segment: one that no other
/// segment comes nearer to than 1.3 radii.
struct CoverageReport {
    Statistics middle_to_surface;  ///< distance from the middle to the surface over the segment's mean
                                   ///< radius, minus 1
    std::uint64_t judged = 0;      ///< free segments
    std::uint64_t missing = 0;     ///< free segments with a distance above 1.8 radii
    std::uint64_t pinched = 0;     ///< free segments with a distance below 0.3 radii
    friend bool operator==(const CoverageReport&, const CoverageReport&) = default;  ///< member by member
};

/// An empty surface misses every free segment and has no distances. O(m log n).
CoverageReport coverage(const SurfaceTree& surface, const CapsuleTree& capsules, const Context& ctx = {});

}  // namespace coppice
