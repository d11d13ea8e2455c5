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

/// Method that computes the axes of a surface.
enum class MeshSkeletonMethod {
    rings,        ///< rings of equal distance from the root along the surface, one chain per branch
    contraction,  ///< Laplacian contraction and edge collapses [Au2008]
};

template <>
struct EnumNames<MeshSkeletonMethod> {
    static constexpr std::array<std::string_view, 2> names{"rings", "contraction"};
};

/// Statistic that computes the radius of a contracted node from the distances of the vertices merged into it.
enum class Thickness {
    median,  ///< ignores the few distant vertices at forks
    mean     ///< as in [Zhu2015 3.1]
};

template <>
struct EnumNames<Thickness> {
    static constexpr std::array<std::string_view, 2> names{"median", "mean"};
};

/// Axis of the mesh that points up.
enum class UpAxis { x, y, z };

template <>
struct EnumNames<UpAxis> {
    static constexpr std::array<std::string_view, 3> names{"x", "y", "z"};
};

/// Options of `extract_from_mesh`.
struct FromMeshOptions {
    MeshSkeletonMethod method = MeshSkeletonMethod::rings;  ///< method; rings is faster
    Thickness thickness = Thickness::median;  ///< radius statistic of contraction; initial value of the fit
    bool fit = true;                          ///< fit the segments to the vertices by least squares
    float prune = 0.3f;  ///< [radius of the fork] minimum height of an end above its fork; lower ends are
                         ///< removed; in [0, 10]
    float join = 1.2f;   ///< [radius] maximum distance of an end from the axis of another component for
                         ///< attaching it; 0 disables this
    float tolerance = 0.02f;    ///< [radius] maximum change of the surface by removing nodes; in [0, 1]
    bool keep_loops = false;    ///< extend an end that was cut off a loop to the place of the cut
    UpAxis up = UpAxis::z;      ///< up axis of the mesh: roots are the lowest ends; the mesh is not rotated
    CleanMeshOptions clean;     ///< options of the cleaning of the mesh
    std::optional<Vec3d> root;  ///< [m] world: the end closest to this point becomes a root; without it,
                                ///< roots are the lowest ends
};

template <class Self, class Visitor>
requires SameOptions<Self, FromMeshOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"method", "Method that computes the axes from the mesh."}, o.method);
    visit(Field{"thickness",
                "Statistic of contraction that computes the radius of a node from the distances of the "
                "vertices merged into it; initial value of the fit."},
          o.thickness);
    visit(Field{"fit", "Fit the segments to the vertices by least squares."}, o.fit);
    visit(common_field("prune", "Minimum height of a branch above its fork; shorter ends are removed.",
                       Unit::radius, 0, 10),
          o.prune);
    visit(Field{"join",
                "Maximum distance of an end from the axis of another component for attaching it; 0 disables "
                "this.",
                Unit::radius, 0, 10},
          o.join);
    visit(Field{"tolerance", "Maximum change of the surface by removing nodes.", Unit::radius, 0, 1},
          o.tolerance);
    visit(Field{"keep_loops", "Extend an end that was cut off a loop to the place of the cut."},
          o.keep_loops);
    visit(Field{"up", "Axis of the mesh that points up; roots are the lowest ends."}, o.up);
    visit(common_field(
              "wood",
              "Read only the faces of groups or materials with this text in their name; may be repeated."),
          o.clean.wood);
    visit(Field{"cards", "Remove flat components, which are usually leaves."}, o.clean.cards);
    visit(Field{"weld", "Maximum distance of vertices that are merged, as a share of the size of the mesh.",
                Unit::none, 0, 0.01},
          o.clean.weld);
    visit(Field{"root", "Point closest to the root of the tree; by default the root is the lowest end.",
                Unit::metre},
          o.root);
}

/// Skeleton and the repairs of the mesh.
struct FromMeshResult : ExtractResult {
    MeshRepairs repairs;               ///< counts of the repairs of the mesh
    PointSet vertices;                 ///< vertices of the cleaned mesh, in the coordinate frame of the input
    std::vector<std::uint32_t> nodes;  ///< per vertex: the node that it is mapped to [Zhu2015, figure 1 (b)]
    std::vector<std::pair<std::string_view, double>> stages;  ///< names and durations [s] of the stages
};

/// Extracts a skeleton with radii from the surface of a tree or of any other branching shape.
///
/// The mesh is cleaned (`clean_mesh`). The method `rings` computes distances along the surface from the
/// lowest vertex of every component and follows them down from each local maximum; it places rings at
/// intervals of 0.4 radii, up to where the surface belongs to another branch. Each branch begins where its
/// axis meets that of its parent branch. The method `contraction` shrinks the surface to its axes by implicit
/// smoothing and collapses edges until no triangles are left; the radius is computed from the vertices merged
/// into a node (`thickness`).
///
/// Both methods then cut loops at their thinnest place, prune stubs, move ends to the end of the surface
/// minus their radius (flat ends: to the face), fit all segments to the vertices by least squares and remove
/// redundant nodes. Components with an end inside another one, such as overlapping tubes, are joined. The
/// result is a forest: several trees have several roots.
///
/// Throws InvalidInput under the conditions of `clean_mesh` or if no component is long enough to have an
/// axis; throws Cancelled. The result does not depend on the number of threads. O(n log n); about 250 bytes
/// per vertex.
FromMeshResult extract_from_mesh(const PolygonMesh& mesh, const FromMeshOptions& options = {},
                                 const Context& ctx = {});

}  // namespace coppice
