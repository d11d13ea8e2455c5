#pragma once

#include <cstdint>
#include <optional>

#include "coppice/base/context.h"
#include "coppice/measure/axes.h"
#include "coppice/measure/volume_report.h"
#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice {

/// What a surface has of the skeleton that it was made of.
struct SurfaceVerdict {
    std::optional<VolumeReport> volume;  ///< not searched for what is missing; none for an open base
    AxesReport axes;                     ///< whether branches are whole and tips are reached
    std::uint64_t crossings = 0;         ///< pairs of quads that are known to cross

    /// The surface encloses what the skeleton means, by VolumeReport::kMaxDeviation.
    bool holds_volume() const { return !volume || volume->agrees(); }
    /// Nothing is wrong.
    bool is_good() const { return holds_volume() && axes.is_perfect() && crossings == 0; }
};

/// Judges a surface by its skeleton: volume against the union of the rounded cones, by some 2^15 points,
/// severed branches, short tips, and crossings that remeshing left. `ends` has to be what the surface was
/// made with. None for cylinders, which run through each other, and for trees that were bent apart. About a
/// fifth of the time that making the surface takes.
std::optional<SurfaceVerdict> judge_surface(const MeshResult& result, const Skeleton& skeleton,
                                            const ControlOptions& ends, const Context& ctx = {});

}  // namespace coppice
