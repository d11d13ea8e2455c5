#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/measure/cone_union.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Adjacent segments that a surface does not contain completely.
struct MissingLump {
    NodeId node;                 ///< child node of the segment with the largest missing volume
    Vec3d place;                 ///< [m] position of that node, with the skeleton's origin
    double volume = 0;           ///< [m^3] missing volume of all of them
    std::uint32_t segments = 0;  ///< number of segments
    friend bool operator==(const MissingLump&, const MissingLump&) = default;  ///< member by member
};

/// Comparison of the volume of a surface with the solid defined by its skeleton.
struct VolumeReport {
    /// [radii] maximum distance of points outside the surface that do not count as missing.
    static constexpr double kMissingMargin = 0.5;
    static constexpr double kMaxMissing = 0.01;  ///< maximum share of the union that is missing
    /// Maximum deviation of the ratio from 1, beyond the error.
    static constexpr double kMaxDeviation = 0.02;
    static constexpr std::size_t kMaxLumps = 5;  ///< maximum number of lumps that are listed

    double mesh = 0;     ///< [m^3] signed volume of the surface
    double cones = 0;    ///< [m^3] of the union of the rounded cones
    double error = 0;    ///< [m^3] of `cones`, two standard errors
    double missing = 0;  ///< [m^3] of the union that is outside the surface, by more than kMissingMargin
    std::vector<MissingLump> lumps;  ///< the largest, by decreasing volume

    double ratio() const { return cones > 0 ? mesh / cones : 0; }                     ///< mesh over cones
    double missing_percent() const { return cones > 0 ? 100 * missing / cones : 0; }  ///< of the union
    bool complete() const { return missing <= kMaxMissing * cones; }  ///< almost nothing is missing
    /// Returns whether the volumes of surface and union agree within kMaxDeviation.
    bool agrees() const { return std::abs(mesh - cones) <= kMaxDeviation * cones + error; }
    friend bool operator==(const VolumeReport&, const VolumeReport&) = default;  ///< member by member
};

/// Compares the volume of a surface with the union of its skeleton's rounded cones, and finds missing volume:
/// points of the union that are outside the surface by more than half the radius of their segment. `solid`
/// must be the union of the skeleton, in the mesh's frame, `mesh_volume` the volume of the surface, and
/// `is_deep` the result of judge_axes(): segments with deep axes need no search. An empty surface misses
/// everything. O(s log n) for the s points of the union, each about a microsecond.
VolumeReport volume_report(const SurfaceTree& surface, double mesh_volume, const Skeleton& skeleton,
                           const ConeUnion& solid, std::span<const std::uint8_t> is_deep,
                           const Context& ctx = {});

/// Calls visit(name, value) for every member, in order.
template <class Visitor>
void visit_figures(const MissingLump& l, Visitor&& visit) {
    visit("node", l.node.index());
    visit("x", l.place.x);
    visit("y", l.place.y);
    visit("z", l.place.z);
    visit("volume", l.volume);
    visit("segments", l.segments);
}

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const VolumeReport& r, Visitor&& visit) {
    visit("cones", r.cones);
    visit("error", r.error);
    visit("ratio", r.ratio());
    visit("missing", r.missing);
    visit("missing_percent", r.missing_percent());
}

}  // namespace coppice
