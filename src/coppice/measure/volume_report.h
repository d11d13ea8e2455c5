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

/// Segments next to each other of which a surface leaves something out.
struct MissingLump {
    NodeId node;                 ///< that names the segment of which most is missing
    Vec3d place;                 ///< [m] of that node, with the skeleton's origin
    double volume = 0;           ///< [m^3] missing, of all of them
    std::uint32_t segments = 0;  ///< how many
    friend bool operator==(const MissingLump&, const MissingLump&) = default;  ///< member by member
};

/// What a surface encloses beside the solid that its skeleton means.
struct VolumeReport {
    static constexpr double kMissingMargin = 0.5;  ///< [radii] what lies nearer to the surface is not missing
    static constexpr double kMostMissing = 0.01;   ///< of the union
    static constexpr double kMaxDeviation = 0.02;  ///< of the ratio from 1, beyond the error
    static constexpr std::size_t kMostLumps = 5;   ///< that are named

    double mesh = 0;     ///< [m^3] enclosed by the surface, counted with sign
    double cones = 0;    ///< [m^3] of the union of the rounded cones
    double error = 0;    ///< [m^3] of `cones`, two standard errors
    double missing = 0;  ///< [m^3] of the union that lies outside the surface, by over kMissingMargin
    std::vector<MissingLump> lumps;  ///< the largest, by volume

    double ratio() const { return cones > 0 ? mesh / cones : 0; }                     ///< mesh over cones
    double missing_percent() const { return cones > 0 ? 100 * missing / cones : 0; }  ///< of the union
    bool complete() const { return missing <= kMostMissing * cones; }  ///< hardly anything is missing
    /// Whether the surface encloses as much as the union does, by kMaxDeviation.
    bool agrees() const { return std::abs(mesh - cones) <= kMaxDeviation * cones + error; }
    friend bool operator==(const VolumeReport&, const VolumeReport&) = default;  ///< member by member
};

/// Holds the volume of a surface against that of the union of its skeleton's rounded cones, and looks for
/// what is missing: points of the union that lie outside the surface by more than half the radius of their
/// segment. `solid` has to be that of the skeleton, in the mesh's frame, `mesh_volume` the surface's, and
/// `is_deep` as judge_axes() found it: segments whose axes are deep enough need no search. An empty surface
/// misses everything. O(s log n) for the s points that the union takes, each about a microsecond.
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
