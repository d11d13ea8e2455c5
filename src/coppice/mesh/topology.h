#pragma once

#include <cstdint>

#include "coppice/base/context.h"
#include "coppice/mesh/half_edges.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Connectivity of the faces of a mesh. Vertices are identified by their index, not by their position.
struct TopologyReport {
    std::uint64_t vertices = 0;               ///< number of vertices used by faces
    std::uint64_t faces = 0;                  ///< number of faces with any number of corners
    std::uint64_t quads = 0;                  ///< number of faces with four corners
    std::uint64_t edges = 0;                  ///< number of pairs of consecutive vertices of a face
    std::uint64_t open_edges = 0;             ///< number of edges of one face
    std::uint64_t non_manifold_edges = 0;     ///< number of edges of more than two faces
    std::uint64_t misoriented_edges = 0;      ///< number of edges with the same direction in both faces
    std::uint64_t non_manifold_vertices = 0;  ///< number of vertices with more than one fan of faces
    std::uint64_t irregular_vertices = 0;     ///< number of vertices without exactly four faces
    std::uint64_t components = 0;             ///< number of components connected by edges
    std::int64_t euler = 0;                   ///< vertices - edges + faces; 2 for a sphere, 0 for a torus

    /// Returns whether the mesh is closed, manifold and oriented; false for an empty mesh.
    bool watertight() const {
        return faces > 0 && open_edges == 0 && non_manifold_edges == 0 && misoriented_edges == 0 &&
               non_manifold_vertices == 0;
    }
    double quads_percent() const { return percent(quads, faces); }  ///< percentage of the faces
    double irregular_percent() const {
        return percent(irregular_vertices, vertices);
    }  ///< percentage of the vertices
    friend bool operator==(const TopologyReport&, const TopologyReport&) = default;  ///< compares all members

  private:
    static double percent(std::uint64_t part, std::uint64_t whole) {
        return whole == 0 ? 0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
    }
};

/// Throws InvalidInput for the first vertex that is not finite, or the first face with fewer than three
/// corners or with a corner that does not exist. O(n).
void validate(const PolygonMesh& mesh);

/// Analyses a valid mesh. O(n); the result does not depend on the number of threads.
/// @{
TopologyReport topology(const HalfEdges& mesh, const Context& ctx = {});
TopologyReport topology(const PolygonMesh& mesh, const Context& ctx = {});
TopologyReport topology(const QuadMesh& mesh, const Context& ctx = {});
/// @}

}  // namespace coppice
