#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/subdivision/kernel/cage_view.h"

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

    /// Throws InvalidInput naming the quad or the edge if an index is out of range, a quad repeats a vertex,
    /// an edge has more than two faces, or its two faces do not have opposite directions along it. Vertices
    /// without faces are allowed. Throws InvalidInput also for levels below 0 or above kMaxLevels, and,
    /// before any memory of that size is allocated, if more than 2^31 vertices or quads would result.
    /// O(cage).
    PatchRefinement(std::span<const Quad> quads, std::uint32_t vertex_count, int levels,
                    const Context& ctx = {});

    CageView cage() const;                                        ///< edges and fans of the cage
    int levels() const { return levels_; }                        ///< number of refinements
    std::uint32_t vertex_count() const { return vertex_count_; }  ///< of refined ones
    /// Returns the number of refined quads.
    std::uint32_t quad_count() const { return static_cast<std::uint32_t>(quads_.size()) << (2 * levels_); }

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
    int levels_ = 0;
    std::uint32_t vertex_count_ = 0;
    Buffer<Quad> quads_;                              // of the cage, as all members from here on
    Buffer<std::uint32_t> side_;                      // see HalfEdges::sides
    Buffer<std::array<std::uint32_t, 2>> edge_half_;  // see HalfEdges::pairs
    CompressedRows<std::uint32_t> fans_;              // the half-edges that begin at each vertex, ascending
    Buffer<std::uint8_t> on_boundary_;                // per vertex; empty if no edge is on a boundary
};

}  // namespace coppice
