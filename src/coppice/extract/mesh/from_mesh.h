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

/// Lists the members for front ends.
void list_fields(FromMeshOptions& o, FieldList& list);

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
