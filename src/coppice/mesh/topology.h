#pragma once

#include <cstdint>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// How the faces of a mesh are connected. Vertices are told apart by their index, never by their position.
struct TopologyReport {
    std::uint64_t vertices = 0;            ///< those that faces use
    std::uint64_t faces = 0;               ///< of any number of corners
    std::uint64_t quads = 0;               ///< faces of four corners
    std::uint64_t edges = 0;               ///< pairs of vertices that follow each other in some face
    std::uint64_t open_edges = 0;          ///< edges of one face
    std::uint64_t non_manifold_edges = 0;  ///< edges of more than two faces
    std::uint64_t misoriented_edges = 0;   ///< edges that their two faces run through in the same direction
    std::uint64_t non_manifold_vertices =
        0;  ///< vertices whose faces, joined across edges, are more than one fan
    std::uint64_t irregular_vertices = 0;  ///< vertices without exactly four faces
    std::uint64_t components = 0;          ///< parts joined across edges
    std::int64_t euler = 0;                ///< vertices - edges + faces; 2 for a sphere, 0 for a torus

    /// Closed, manifold and oriented; an empty mesh is not.
    bool watertight() const {
        return faces > 0 && open_edges == 0 && non_manifold_edges == 0 && misoriented_edges == 0 &&
               non_manifold_vertices == 0;
    }
    double quads_percent() const { return percent(quads, faces); }                      ///< of the faces
    double irregular_percent() const { return percent(irregular_vertices, vertices); }  ///< of the vertices
    friend bool operator==(const TopologyReport&, const TopologyReport&) = default;     ///< member by member

  private:
    static double percent(std::uint64_t part, std::uint64_t whole) {
        return whole == 0 ? 0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
    }
};

/// Throws InvalidInput naming the first vertex that is not finite, or the first face with fewer than three
/// corners or with a corner that does not exist. O(n).
void validate(const PolygonMesh& mesh);

/// Judges a valid mesh. O(n) for bounded valence; about 60 bytes per quad of scratch.
TopologyReport topology(const PolygonMesh& mesh, const Context& ctx = {});
/// The same for quads.
TopologyReport topology(const QuadMesh& mesh, const Context& ctx = {});

}  // namespace coppice
