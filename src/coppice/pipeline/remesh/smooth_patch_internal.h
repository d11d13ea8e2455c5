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
    std::uint32_t region;  ///< region of the field for evaluations at the vertex
    float radius;          ///< [m] of the branch at the vertex: limits the length of steps
};

/// Moves points onto value = level along the gradient of the field, at most half of a radius, all of one
/// region; `vertices` has the radius for each point. Points too far from the level do not reach it. At most
/// 64 points.
void move_to_level(std::span<Vec3> points, std::span<const PatchVertex> vertices, FieldRef field);

/// Smooths a patch of quads on a field's surface: in every pass each vertex moves a share of the distance to
/// the mean of its neighbours along edges, and then back onto value = level along the gradient, all
/// simultaneously. `quads` are those of the patch; its other vertices do not move. Fastest if vertices of one
/// region are consecutive. The result does not depend on the number of threads. O(passes n).
void smooth_patch(std::span<Vec3> positions, std::span<const Quad> quads, std::span<const PatchVertex> moving,
                  FieldRef field, int passes, const Context& ctx = {});

/// Moves vertices of a curved surface outward, so that quads with these corners enclose its volume: by a
/// third of the distance from the mean of the neighbours, along the normal, which is exact for quadrics and
/// squares. O(n).
void enclose_volume(std::span<Vec3> positions, std::span<const Quad> quads,
                    std::span<const PatchVertex> moving);

}  // namespace coppice
