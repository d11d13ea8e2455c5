#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Evens out the vertices of a surface without moving the surface: each vertex goes part of the way to the
/// mean of its neighbours, in its tangent plane only. Vertices on a boundary stay. Built once per mesh,
/// stepped any number of times.
class TangentialRelaxation {
  public:
    /// Keeps a view of the quads: they must be a manifold surface, and outlive this. O(n).
    TangentialRelaxation(std::span<const Quad> quads, std::uint32_t vertex_count);

    /// One Jacobi step with a weight in [0, 1]; 0.3 is usual. The same bits for any number of threads.
    Buffer<Vec3> step(std::span<const Vec3> positions, float weight, const Context& ctx = {}) const;

  private:
    Vec3 relaxed(std::uint32_t vertex, std::span<const Vec3> positions, float weight) const;

    std::span<const Quad> quads_;
    CompressedRows<std::uint32_t> fans_;  // the half-edges that each vertex starts
};

}  // namespace coppice
