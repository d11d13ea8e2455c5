#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// A surface of quads as half-edges: h = 4 f + s is from corner s of quad f to corner s + 1, so that only
/// twin, edge and first vertex are stored [Dupuy2021].
struct HalfedgeMesh {
    static constexpr std::int32_t kBoundary = -1;  ///< no twin

    std::vector<std::int32_t> twin;    ///< kBoundary at the end of the surface
    std::vector<std::int32_t> edge;    ///< per half-edge: its edge
    std::vector<std::int32_t> vertex;  ///< per half-edge: its first vertex
    std::int32_t edge_count = 0;       ///< edges of one quad or two
    std::vector<Vec3d> points;         ///< one per vertex

    /// number of quads
    std::int32_t face_count() const { return static_cast<std::int32_t>(twin.size() / 4); }
    /// number of points
    std::int32_t vertex_count() const { return static_cast<std::int32_t>(points.size()); }
};

/// Throws InvalidInput if an edge has more than two quads, or two with the same direction along it.
HalfedgeMesh build_halfedges(std::span<const Vec3> points, std::span<const Quad> quads);

/// Performs one Catmull-Clark step by the half-edge rule of [Dupuy2021]: every half-edge becomes four.
/// Simple, serial and in double precision: the reference for tests of PatchRefinement. Order of refined
/// vertices: old ones, face points, edge points.
HalfedgeMesh refine_halfedges(const HalfedgeMesh& mesh);

/// Returns the same surface with positions in single precision.
QuadMesh to_quads(const HalfedgeMesh& mesh);

}  // namespace coppice
