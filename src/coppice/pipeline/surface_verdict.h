#pragma once

#include <cstdint>
#include <optional>

#include "coppice/base/context.h"
#include "coppice/measure/axes.h"
#include "coppice/measure/volume_report.h"
#include "coppice/pipeline/mesh_result.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Properties of the skeleton that its surface preserves.
struct SurfaceVerdict {
    std::optional<VolumeReport> volume;  ///< without a search for missing parts; nullopt for an open base
    AxesReport axes;                     ///< whether branches are complete and tips are reached
    std::uint64_t crossings = 0;         ///< pairs of quads that cross; 0 for triangles

    /// Returns whether the surface encloses the specified volume, by VolumeReport::kMaxDeviation.
    bool holds_volume() const { return !volume || volume->agrees(); }
    /// Returns whether no defect was found.
    bool is_good() const { return holds_volume() && axes.is_perfect() && crossings == 0; }
};

/// Compares a surface with its skeleton: volume with the union of the rounded cones, by about 2^15 points,
/// severed branches, short tips, and remaining crossings. `ends` has to be the options of the surface.
/// Returns nullopt for cylinders, which intersect each other, and for trees that were bent apart. Needs about
/// a fifth of the time of building the surface, or as long if crossings were not searched before.
std::optional<SurfaceVerdict> judge_surface(const MeshResult& result, const Skeleton& skeleton,
                                            const ControlOptions& ends, const Context& ctx = {});

}  // namespace coppice
