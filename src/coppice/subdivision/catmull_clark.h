#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/mesh/mesh.h"
#include "coppice/subdivision/cage_topology.h"

namespace coppice {

/// Catmull-Clark refinement of one cage by a fixed number of levels [Catmull1978], reused for any number of
/// attributes.
///
/// After k levels every cage quad is a grid of n x n quads, n = 2^k, and all indices are closed forms:
///
/// * vertices: those of the cage; n - 1 inside each cage edge, from its lower to its higher vertex; (n - 1)^2
/// inside each cage quad, row by row: corner 0 at (0, 0), corner 1 at (n, 0), corner 3 at (0, n);
/// * quads: n^2 per cage quad, row by row, starting at the same corner as the cage quad.
///
/// Only cage vertices can be irregular: all other vertices are a product of the cubic B-spline rules along
/// two directions.
///
/// Boundary edges follow the cubic B-spline rule, including corners of a single quad (OpenSubdiv's
/// VTX_BOUNDARY_EDGE_ONLY). A vertex without quads keeps its position. Any valence is allowed.
class PatchRefinement {
  public:
    static constexpr int kMaxLevels = 6;  ///< quads become 4096 times as many

    PatchRefinement() = default;  ///< of a cage without quads

    /// Throws InvalidInput for a cage that is not manifold (see build_cage_topology), for levels below 0 or
    /// above kMaxLevels, and, before any memory of that size is allocated, if more than 2^31 vertices or
    /// quads would result. O(cage).
    PatchRefinement(std::span<const Quad> quads, std::uint32_t vertex_count, int levels,
                    const Context& ctx = {});

    const CageTopology& cage() const { return cage_; }            ///< edges and fans of the cage
    int levels() const { return levels_; }                        ///< number of refinements
    std::uint32_t vertex_count() const { return vertex_count_; }  ///< of refined ones
    std::uint32_t quad_count() const { return cage_.face_count() << (2 * levels_); }  ///< of refined ones

    /// Returns the refined quads, in the order above. O(quads).
    Buffer<Quad> quads(const Context& ctx = {}) const;

    /// Returns the cage's points after `levels` exact Catmull-Clark steps: one value per refined vertex from
    /// one per cage vertex. The result does not depend on the number of threads.
    Buffer<Vec3> refine(std::span<const Vec3> cage_points, const Context& ctx = {}) const;

    /// Returns the maximum number of vertices that one cage quad can own.
    std::uint32_t max_owned() const { return ((1u << levels_) + 1) * ((1u << levels_) + 1); }

    /// Writes the refined vertices that one cage quad owns: its inside, and the edges and corners that no
    /// earlier quad has. Over all quads every vertex that has a quad appears once. Returns their number;
    /// `out` has space for max_owned().
    std::uint32_t owned_vertices(std::uint32_t cage_quad, std::span<std::uint32_t> out) const;

    /// Returns per refined vertex the cage quad that owns it; kNoIndex without quads.
    Buffer<std::uint32_t> owners() const;

  private:
    CageTopology cage_;
    int levels_ = 0;
    std::uint32_t vertex_count_ = 0;
};

}  // namespace coppice
