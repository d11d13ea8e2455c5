#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/subdivision/cage_topology.h"

namespace coppice {

/// Catmull-Clark refinement of one cage by a fixed number of levels [Catmull1978], reused for any number of
/// attributes.
///
/// After k levels every cage quad is a grid of n x n quads, n = 2^k, and all indices are closed forms:
///
/// * vertices: those of the cage; n - 1 inside each cage edge, from its lower to its higher vertex; (n - 1)^2
///   inside each cage quad, row by row: corner 0 at (0, 0), corner 1 at (n, 0), corner 3 at (0, n);
/// * quads: n^2 per cage quad, row by row, starting at the same corner as the cage quad.
///
/// Only cage vertices can be irregular: everything else is a product of the cubic B-spline rules along two
/// directions.
///
/// Boundary edges follow the cubic B-spline rule, corners of a single quad too (OpenSubdiv's
/// VTX_BOUNDARY_EDGE_ONLY). A vertex without quads stays in place. Any valence is allowed.
class PatchRefinement {
  public:
    static constexpr int kMaxLevels = 6;  ///< quads become 4096 times as many

    /// Throws InvalidInput for a cage that is not manifold (see build_cage_topology), for levels below 0 or
    /// above kMaxLevels, and, before anything of that size is allocated, when more than 2^31 vertices or
    /// quads would result. O(cage).
    PatchRefinement(std::span<const Quad> quads, std::uint32_t vertex_count, int levels,
                    const Context& ctx = {});

    const CageTopology& cage() const { return cage_; }            ///< edges and fans of the cage
    int levels() const { return levels_; }                        ///< times that it is refined
    std::uint32_t vertex_count() const { return vertex_count_; }  ///< refined ones
    std::uint32_t quad_count() const { return cage_.face_count() << (2 * levels_); }  ///< refined ones

    /// The refined quads, in the order above. O(quads).
    Buffer<Quad> quads(const Context& ctx = {}) const;

    /// The cage's points after `levels` exact Catmull-Clark steps. One value per cage vertex in, one per
    /// refined vertex out. The same bits for any number of threads.
    Buffer<Vec3> refine(std::span<const Vec3> cage_points, const Context& ctx = {}) const;

    /// Most vertices that one cage quad can own.
    std::uint32_t max_owned() const { return ((1u << levels_) + 1) * ((1u << levels_) + 1); }

    /// Writes the refined vertices that count as those of one cage quad: its inside, and the edges and
    /// corners that no earlier quad has. Over all quads every vertex that has a quad appears once. Returns
    /// how many; out holds max_owned().
    std::uint32_t owned_vertices(std::uint32_t cage_quad, std::span<std::uint32_t> out) const;

    /// Per refined vertex, the cage quad that counts it as its own; CageTopology::kNone without quads.
    Buffer<std::uint32_t> owners() const;

  private:
    CageTopology cage_;
    int levels_;
    std::uint32_t vertex_count_;
};

}  // namespace coppice
