#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/context.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// A vertex that may move.
struct PatchVertex {
    std::uint32_t vertex;  ///< index into the positions
    std::uint32_t region;  ///< in which the field is asked there
    float radius;          ///< [m] of the branch there: no step is longer than a part of it
};

/// Evens out a patch of quads on a field's surface: in every pass each vertex goes part of the way to the
/// mean of its neighbours along edges, and then back onto value = level along the gradient, all at once.
/// `quads` are those of the patch, whose other vertices stay. Cheapest when vertices of one region follow
/// each other. Deterministic for any number of threads. O(passes n).
void smooth_patch(std::span<Vec3> positions, std::span<const Quad> quads, std::span<const PatchVertex> moving,
                  FieldRef field, int passes, const Context& ctx = {});

}  // namespace coppice
