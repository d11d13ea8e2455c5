#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// What had to be repaired in a mesh before a skeleton could be read off it, counted.
struct MeshRepairs {
    std::uint32_t other_material = 0;      ///< faces left out because their group is not wood
    std::uint32_t welded = 0;              ///< vertices at the place of another one
    std::uint32_t degenerate = 0;          ///< triangles with two corners in one place
    std::uint32_t duplicates = 0;          ///< triangles on the same three corners as another one
    std::uint32_t open_edges = 0;          ///< edges of one triangle; left as they are
    std::uint32_t non_manifold_edges = 0;  ///< edges of more than two triangles: taken apart
    std::uint32_t flipped = 0;             ///< triangles that faced inward
    std::uint32_t cards = 0;               ///< flat pieces, taken for leaves
    std::uint32_t card_faces = 0;          ///< their triangles
    friend bool operator==(const MeshRepairs&, const MeshRepairs&) = default;  ///< member by member
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

/// What of a mesh is kept.
struct CleanMeshOptions {
    float weld = 1e-6f;  ///< [size of the mesh] vertices that agree to this are one; in [0, 0.01]
    bool cards = true;   ///< leave out flat pieces, as leaves are drawn
    /// Names of groups or materials that are wood; a face counts when the name of its group contains one of
    /// them, upper or lower case. Empty = every face.
    std::vector<std::string> wood;
};

/// A mesh to walk on, and what had to be repaired.
struct CleanMeshResult {
    TriMesh mesh;         ///< every vertex is used; neighbours agree, pieces face outward
    MeshRepairs repairs;  ///< what was done
};

/// Makes triangles of a mesh as files hold it that a surface algorithm can walk on: faces of other materials
/// left out, split vertices welded, degenerate and double triangles dropped, flat pieces left out, inward
/// faces turned. Open ends stay open; edges of more than two triangles stay too, and are told in the repairs.
/// A piece is flat when four fifths of its area face one way, or the opposite one.
///
/// Throws InvalidInput: an index out of range or a coordinate that is not finite (`validate`), no face of the
/// wanted material (naming those there are), nothing left. O(n log n).
CleanMeshResult clean_mesh(const PolygonMesh& mesh, const CleanMeshOptions& options = {},
                           const Context& ctx = {});

}  // namespace coppice
