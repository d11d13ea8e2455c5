#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/base/kernel/host_device.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Returns the vertices of all quads, or triangles, in order: those at which the half-edges begin.
inline std::span<const std::uint32_t> all_corners(std::span<const Quad> quads) {
    return {reinterpret_cast<const std::uint32_t*>(quads.data()), 4 * quads.size()};
}
/// @cond Doxygen cannot distinguish this overload
inline std::span<const std::uint32_t> all_corners(std::span<const Triangle> triangles) {
    return {reinterpret_cast<const std::uint32_t*>(triangles.data()), 3 * triangles.size()};
}
/// @endcond

/// Returns the next half-edge of the same face, for faces of N corners.
template <std::uint32_t N>
COPPICE_HOST_DEVICE constexpr std::uint32_t next_half_edge(std::uint32_t h) {
    return h % N + 1 < N ? h + 1 : h + 1 - N;
}
/// Returns the previous half-edge of the same face, for faces of N corners.
template <std::uint32_t N>
COPPICE_HOST_DEVICE constexpr std::uint32_t previous_half_edge(std::uint32_t h) {
    return h % N > 0 ? h - 1 : h + N - 1;
}

/// Half-edges of the faces of a mesh. Half-edge h is from corner h to the next corner of the same face, where
/// the corners of all faces are numbered consecutively: h = 4 f + s is side s of quad f.
///
/// The forward direction of an edge is from its lower to its higher vertex. Edges are numbered by their lower
/// vertex, then by their higher one. There are three kinds of edges:
/// * border edges with one half-edge;
/// * regular edges with two half-edges of opposite directions, which are twins;
/// * irregular edges: two half-edges of the same direction are an orientation conflict, more than two
///   half-edges are a non-manifold edge. Their half-edges have no twins.
class HalfEdges {
  public:
    HalfEdges() = default;  ///< without faces
    /// Builds the half-edges of faces with vertices below `vertex_count`; they must outlive this object.
    /// O(n), also with vertices of many faces (n log n in their valence); the result does not depend on the
    /// number of threads. At most 2^31 corners.
    /// @{
    HalfEdges(std::span<const Quad> quads, std::uint32_t vertex_count, const Context& ctx = {});
    HalfEdges(std::span<const Triangle> triangles, std::uint32_t vertex_count, const Context& ctx = {});
    explicit HalfEdges(const PolygonMesh& mesh, const Context& ctx = {});
    /// @}
    HalfEdges(HalfEdges&&) = default;             ///< can be moved, but not copied
    HalfEdges& operator=(HalfEdges&&) = default;  ///< can be moved, but not copied

    std::uint32_t size() const { return static_cast<std::uint32_t>(corners_.size()); }      ///< of half-edges
    std::uint32_t edge_count() const { return static_cast<std::uint32_t>(pairs_.size()); }  ///< of all kinds
    std::uint32_t face_count() const { return face_count_; }                                ///< of faces
    std::uint32_t vertex_count() const { return vertex_count_; }  ///< including those without faces

    /// Returns the vertex at which a half-edge begins.
    std::uint32_t origin(std::uint32_t h) const { return corners_[h]; }
    /// Returns the vertex at which a half-edge ends.
    std::uint32_t target(std::uint32_t h) const { return corners_[next(h)]; }
    /// Returns the face of a half-edge.
    std::uint32_t face(std::uint32_t h) const { return arity_ != 0 ? h / arity_ : faces_[h]; }
    /// Returns the first half-edge of a face; size() for face_count().
    std::uint32_t first(std::uint32_t f) const { return arity_ != 0 ? arity_ * f : first_[f]; }
    /// Returns the next half-edge of the same face.
    std::uint32_t next(std::uint32_t h) const {
        const std::uint32_t f = face(h);
        return h + 1 < first(f + 1) ? h + 1 : first(f);
    }
    /// Returns the opposite half-edge of a regular edge; kNoIndex at borders and at irregular edges.
    std::uint32_t twin(std::uint32_t h) const { return pairs_[sides_[h] >> 1][~sides_[h] & 1]; }
    /// Returns the edge of a half-edge.
    std::uint32_t edge(std::uint32_t h) const { return sides_[h] >> 1; }
    /// Returns whether a half-edge is from the higher to the lower vertex of its edge.
    bool is_backward(std::uint32_t h) const { return (sides_[h] & 1) != 0; }

    /// Returns the half-edges of an edge: of a regular one the forward, then the backward one; of an
    /// irregular one all, ascending. O(1), O(log n) for an irregular edge.
    std::span<const std::uint32_t> halves(std::uint32_t e) const;
    /// Returns the lower and the higher vertex of an edge.
    std::array<std::uint32_t, 2> ends(std::uint32_t e) const;
    /// Returns the edge between two vertices; kNoIndex if there is none. O(log n).
    std::uint32_t find(std::uint32_t a, std::uint32_t b) const;
    /// Returns the half-edges of all irregular edges, in the order of the edges; empty for an oriented
    /// manifold.
    std::span<const std::uint32_t> irregular() const { return irregular_; }

    /// Returns per half-edge 2 edge + (1 if it is backward).
    std::span<const std::uint32_t> sides() const { return sides_; }
    /// Returns per edge the forward and the backward half-edge, or kNoIndex for a missing one; twice kNoIndex
    /// for an irregular edge.
    std::span<const std::array<std::uint32_t, 2>> pairs() const { return pairs_; }

  private:
    void build(const Context& ctx);

    std::span<const std::uint32_t> corners_;
    std::span<const std::uint32_t> first_;  // per face, if arity_ is 0
    std::uint32_t arity_ = 0;               // number of corners of every face; 0 if it is not constant
    std::uint32_t face_count_ = 0, vertex_count_ = 0;
    Buffer<std::uint32_t> faces_;  // per half-edge, if arity_ is 0
    Buffer<std::uint32_t> sides_;
    Buffer<std::array<std::uint32_t, 2>> pairs_;
    Buffer<std::uint32_t> irregular_;
};

}  // namespace coppice
