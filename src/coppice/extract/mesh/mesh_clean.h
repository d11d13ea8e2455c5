#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Counts of the repairs of a mesh before the extraction of a skeleton.
struct MeshRepairs {
    std::uint32_t other_material = 0;      ///< number of faces removed because their group is not wood
    std::uint32_t welded = 0;              ///< number of vertices merged with one at the same position
    std::uint32_t degenerate = 0;          ///< number of triangles with two equal corners
    std::uint32_t duplicates = 0;          ///< number of triangles with the same three corners as another one
    std::uint32_t open_edges = 0;          ///< number of edges of one triangle; they remain
    std::uint32_t non_manifold_edges = 0;  ///< number of edges of more than two triangles; they are separated
    std::uint32_t flipped = 0;             ///< number of triangles that faced inward
    std::uint32_t cards = 0;               ///< number of flat components, considered as leaves
    std::uint32_t card_faces = 0;          ///< number of triangles of the flat components
    friend bool operator==(const MeshRepairs&, const MeshRepairs&) = default;  ///< compares all members
};

/// Calls visit(name, number) for every member, in order.
template <class Visitor>
void visit_figures(const MeshRepairs& r, Visitor&& visit) {
    visit("other_material", r.other_material);
    visit("welded", r.welded);
    visit("degenerate", r.degenerate);
    visit("duplicates", r.duplicates);
    visit("open_edges", r.open_edges);
    visit("non_manifold_edges", r.non_manifold_edges);
    visit("flipped", r.flipped);
    visit("cards", r.cards);
    visit("card_faces", r.card_faces);
}

/// Options of `clean_mesh`.
struct CleanMeshOptions {
    float weld = 1e-6f;  ///< [size of the mesh] maximum distance of vertices that are merged; in [0, 0.01]
    bool cards = true;   ///< remove flat components, which are usually leaves
    /// Names of groups or materials of wood; a face is kept if the name of its group contains one of them,
    /// regardless of case. Empty = every face is kept.
    std::vector<std::string> wood;
};

/// Cleaned mesh and counts of its repairs.
struct CleanMeshResult {
    TriMesh mesh;  ///< every vertex is used; adjacent triangles are oriented consistently, components face
                   ///< outward
    MeshRepairs repairs;  ///< counts of the repairs
};

/// Converts a mesh as read from a file into triangles that surface algorithms can traverse: removes faces of
/// other materials, welds split vertices, removes degenerate and duplicate triangles and flat components, and
/// flips inward faces. Open ends stay open; edges of more than two triangles also stay and are counted in the
/// repairs. A component is flat if four fifths of its area have one normal direction or the opposite one.
///
/// Throws InvalidInput if an index is out of range, a coordinate is not finite (`validate`), no face has the
/// specified material (the message lists the existing ones), or no face remains. O(n log n).
CleanMeshResult clean_mesh(const PolygonMesh& mesh, const CleanMeshOptions& options = {},
                           const Context& ctx = {});

}  // namespace coppice
