#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "coppice/base/fields.h"
#include "coppice/extract/extract_result.h"
#include "coppice/extract/mesh/mesh_clean.h"
#include "coppice/points/point_set.h"

namespace coppice {

/// How a surface becomes axes.
enum class MeshSkeletonMethod {
    rings,        ///< rings of equal distance from the root along the surface, one chain per branch
    contraction,  ///< Laplacian contraction and edge collapses [Au2008]
};

template <>
struct EnumNames<MeshSkeletonMethod> {
    static constexpr std::array<std::string_view, 2> names{"rings", "contraction"};
};

/// What the thickness of a contracted node is, of the distances of the vertices that became part of it.
enum class Thickness {
    median,  ///< does not heed the few that lie far off, at forks
    mean     ///< as [Zhu2015 3.1] has it
};

template <>
struct EnumNames<Thickness> {
    static constexpr std::array<std::string_view, 2> names{"median", "mean"};
};

/// The axis of the mesh that points up.
enum class UpAxis { x, y, z };

template <>
struct EnumNames<UpAxis> {
    static constexpr std::array<std::string_view, 3> names{"x", "y", "z"};
};

/// How a skeleton is read off a mesh.
struct FromMeshOptions {
    MeshSkeletonMethod method = MeshSkeletonMethod::rings;  ///< rings are faster
    Thickness thickness = Thickness::median;  ///< of contraction, which the fit then goes on from
    bool fit = true;                          ///< fit the segments to the vertices by least squares
    float prune = 0.3f;  ///< [radius of the fork] ends that rise less above their fork go; in [0, 10]
    float join = 1.2f;   ///< [radius] pieces whose end is nearer to another's axis are attached; 0 = none
    float tolerance = 0.02f;    ///< [radius] how far the surface may move by leaving out nodes; in [0, 1]
    bool keep_loops = false;    ///< lead an end cut off a loop on to where it was cut off
    UpAxis up = UpAxis::z;      ///< which way is up in the mesh: roots are lowest ends; nothing is turned
    CleanMeshOptions clean;     ///< how the mesh is cleaned first
    std::optional<Vec3d> root;  ///< [m] world: the end nearest to it is a root; else roots are lowest ends
};

template <class Self, class Visitor>
requires SameOptions<Self, FromMeshOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"method", "how the skeleton is read off a mesh"}, o.method);
    visit(Field{"thickness",
                "contraction: the radius of a node, from the distances of the vertices that became part of "
                "it; the fit goes on from there"},
          o.thickness);
    visit(Field{"fit", "fit the segments to the vertices by least squares"}, o.fit);
    visit(common_field("prune", "Minimum height of a branch above its fork; shorter ends are removed",
                       Unit::radius, 0, 10),
          o.prune);
    visit(Field{"join", "pieces whose end is nearer to another's axis are attached to it; 0 = none",
                Unit::radius, 0, 10},
          o.join);
    visit(Field{"tolerance", "how far the surface may move by leaving out nodes", Unit::radius, 0, 1},
          o.tolerance);
    visit(Field{"keep_loops", "lead an end cut off a loop on to where it was cut off"}, o.keep_loops);
    visit(Field{"up", "axis that points up in the mesh: roots are the lowest ends"}, o.up);
    visit(common_field("wood",
                       "Read only faces whose group or material has this text in its name; may be repeated"),
          o.clean.wood);
    visit(Field{"cards", "leave out flat pieces, as leaves are drawn"}, o.clean.cards);
    visit(Field{"weld", "share of the mesh's size to which places are told apart", Unit::none, 0, 0.01},
          o.clean.weld);
    visit(Field{"root", "the root is where the tree is nearest to this place; else it is the lowest end",
                Unit::metre},
          o.root);
}

/// A skeleton, and what had to be repaired in the mesh.
struct FromMeshResult : ExtractResult {
    MeshRepairs repairs;               ///< of the mesh
    PointSet vertices;                 ///< of the mesh once cleaned, in the frame of the input
    std::vector<std::uint32_t> nodes;  ///< per vertex: the node that it is mapped to [Zhu2015, figure 1 (b)]
    std::vector<std::pair<std::string_view, double>> stages;  ///< name, seconds
};

/// Reads a skeleton with radii off the surface of a tree, or of anything else that branches.
///
/// The mesh is cleaned (`clean_mesh`). `rings` takes distances along the surface from the lowest vertex of
/// every piece, and follows them down from each farthest place: rings 0.4 radii apart, up to where the
/// surface belongs to another branch. Each branch begins where its axis meets the one it leaves.
/// `contraction` shrinks the surface to its axis by implicit smoothing and collapses edges until no triangles
/// are left; the radius is that of the vertices that became a node (`thickness`).
///
/// Then, with either: ways round are cut where they are thinnest, stubs pruned, ends moved to where the
/// surface ends, less their radius (flat ends: to the face), and all segments fitted to the vertices by least
/// squares, with nodes that nothing needs left out between. Pieces whose ends lie within another one, as
/// tubes that overlap, are joined. The result is a forest: several trees give several roots.
///
/// Throws InvalidInput: what `clean_mesh` throws, or when no piece is long enough to have an axis;
/// and Cancelled. Deterministic for any number of threads. O(n log n); about 250 bytes per vertex.
FromMeshResult extract_from_mesh(const PolygonMesh& mesh, const FromMeshOptions& options = {},
                                 const Context& ctx = {});

}  // namespace coppice
