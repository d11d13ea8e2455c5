#pragma once

#include <cstdint>
#include <string>

#include "coppice/pipeline/mesh_options.h"
#include "coppice/pipeline/mesh_result.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Minimum number of faces that can be requested.
inline constexpr std::uint64_t kMinFaces = 100;

/// Maximum number of faces that can be requested.
inline constexpr std::uint64_t kMaxFaces = 100'000'000;

/// Maximum number of refined faces per requested face, before thin branches get fewer.
inline constexpr double kMaxRefinedFaces = 8;

/// The requested number of faces of a surface.
struct FaceNumber {
    int faces = 0;  ///< kMinFaces or more; 0 = no request
};

/// Lists the members for front ends.
void list_fields(FaceNumber& o, FieldList& list);

/// A skeleton and options for a surface with approximately the requested number of faces.
struct FaceBudget {
    Skeleton skeleton;          ///< the included part of the given skeleton
    MeshOptions options;        ///< the given options with other levels, sides and stations
    std::uint64_t faces = 0;    ///< planned number of faces of the surface
    std::uint32_t axes = 0;     ///< number of axes of the given skeleton
    std::uint32_t dropped = 0;  ///< number of these axes that are left out with everything that they carry
    double dropped_silhouette = 0;  ///< share of the silhouette of all segments that these axes had
};

/// Chooses options with which a surface of quads has approximately this number of faces.
///
/// If `tube_sides` is automatic or by_radius, all branches keep their rings, and the distance of the sides of
/// sections from their circles (MeshOptions::chord_error) is chosen; the thickest axis has eight sides or
/// more. Bends, branch nodes and remeshed regions have more faces than planned: up to two or three times as
/// many.
///
/// If that still has too many faces, or does not come close, or `tube_sides` is equal, all branches have the
/// same number of sides. The levels are those at which the cage has nearly the requested number of faces with
/// the rings of the given options. Then the spacing of rings is changed, which moves the surface by up to a
/// fifth of the local radius (ResampleOptions::tolerance). If that is not enough even with the sides of the
/// cage, axes are left out in ascending order of silhouette: the sum of length times width of an axis and
/// everything that it carries. The axes that begin at roots always stay; their surface may still have more
/// faces than requested. Unless `tube_sides` is equal, surfaces with the sides of the cage have one level,
/// are repaired, and are then thinned out. Regions that are remeshed because quads cross have more faces than
/// planned, many more if rings are closer than five radii.
///
/// `options` are those for the given skeleton; their levels are ignored. Throws InvalidInput naming `faces`
/// if it is not from kMinFaces to kMaxFaces, `method` if it is not quads or bmesh, and `chord_error` if it is
/// set. Builds up to about twenty cages, which needs about as long as the surface at two levels.
FaceBudget plan_faces(const Skeleton& skeleton, const MeshOptions& options, std::uint64_t faces,
                      const Context& ctx = {});

/// A surface with approximately the requested number of faces, and its plan.
struct BudgetedMesh {
    FaceBudget budget;  ///< the plan that came closest
    MeshResult result;  ///< its surface; the stages include the time of all plans and of the other attempts
};

/// Builds the surface of plan_faces(). If it has another number of faces, plans again, up to six times for
/// each kind of plan and number of levels; if no choice of axes comes close, the largest one with fewer faces
/// gets more sides or rings. Keeps the result closest to `faces`. Throws as plan_faces() and
/// mesh_skeleton().
BudgetedMesh mesh_with_faces(const Skeleton& skeleton, const PointSet& constraints,
                             const MeshOptions& options, std::uint64_t faces, const Context& ctx = {});

/// Returns a text of the choices: "level 2, sides by radius, 31 of 31 axes, without 0.0 % of the silhouette".
std::string to_text(const FaceBudget& budget);

/// Returns a sentence if the number of faces differs by more than 5 % from the requested one; otherwise an
/// empty string.
std::string text_of_missed_faces(const BudgetedMesh& made, std::uint64_t faces);

}  // namespace coppice
