#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Smooths the distribution of the vertices of a surface without moving the surface: each vertex moves a
/// share of the distance to the mean of its neighbours, in its tangent plane only. Vertices on a boundary do
/// not move. Built once per mesh, for any number of steps.
class TangentialRelaxation {
  public:
    /// Keeps a view of the quads, which must be a manifold surface and outlive this object. O(n).
    TangentialRelaxation(std::span<const Quad> quads, std::uint32_t vertex_count);

    /// Performs one Jacobi step with a weight in [0, 1], usually 0.3. The result does not depend on the
    /// number of threads.
    Buffer<Vec3> step(std::span<const Vec3> positions, float weight, const Context& ctx = {}) const;

  private:
    Vec3 relaxed(std::uint32_t vertex, std::span<const Vec3> positions, float weight) const;

    std::span<const Quad> quads_;
    CompressedRows<std::uint32_t> fans_;  // the half-edges that begin at each vertex
};

}  // namespace coppice
