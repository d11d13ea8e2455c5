#pragma once

#include <cstdint>
#include <string>

#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice {

/// Smallest number of faces that may be asked for.
inline constexpr std::uint64_t kMinFaces = 100;

/// Largest number of faces that may be asked for.
inline constexpr std::uint64_t kMaxFaces = 100'000'000;

/// Refined faces at most for each that is asked for, before thin branches get fewer.
inline constexpr double kMaxRefinedFaces = 8;

/// How many faces a surface is to have.
struct FaceNumber {
    int faces = 0;  ///< kMinFaces or more; 0 = whatever it has
};

template <class Self, class Visitor>
requires SameOptions<Self, FaceNumber>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field("faces",
                       "Number of faces of the surface, within 5 %: chooses the levels, how far rings are "
                       "apart, and which branches are drawn; 0 = whatever it has",
                       Unit::none, 0, kMaxFaces),
          o.faces);
}

/// A skeleton and options of which a surface has about as many faces as are wanted.
struct FaceBudget {
    Skeleton skeleton;              ///< with what is drawn of the given one
    MeshOptions options;            ///< those given, with other levels, and other sides or stations
    std::uint64_t faces = 0;        ///< of the surface, as planned
    std::uint32_t axes = 0;         ///< of the given skeleton
    std::uint32_t dropped = 0;      ///< of these, left out, with all that they carry
    double dropped_silhouette = 0;  ///< share of the silhouette of all segments that they had
};

/// Chooses how a surface of quads gets about so many faces.
///
/// Where `tube_sides` is automatic or by_radius, all branches keep their rings, and the sides of sections are
/// as far from their circles (MeshOptions::chord_error) as gives so many faces; the thickest axis has eight
/// or more. Bends, branch nodes and what is remeshed have more faces than planned: once or twice as many
/// again.
///
/// Where that would be too many faces even so, or none comes near, or `tube_sides` is equal, all branches
/// have as many sides. The levels are those at which the cage has nearly as many faces as with the rings of
/// the given options. Then rings move apart or together, which moves the surface by up to a fifth of the
/// local radius (ResampleOptions::tolerance). Where that is not enough even without any level, axes go, least
/// silhouette first: the sum of length times width of an axis and all that it carries. The axes that begin at
/// roots always stay; a surface of them may still have more faces than are wanted. What is remeshed where
/// quads cross has more faces than planned, many where rings stand nearer than five radii.
///
/// `options` are those for the given skeleton; their levels are not looked at. Throws InvalidInput naming
/// `faces` when it is not from kMinFaces to kMaxFaces, `method` when it is not quads or bmesh, and
/// `chord_error` when that is given. It makes up to some twenty cages: about as long as the surface takes at
/// two levels.
FaceBudget plan_faces(const Skeleton& skeleton, const MeshOptions& options, std::uint64_t faces,
                      const Context& ctx = {});

/// A surface of about so many faces, and how that was planned.
struct BudgetedMesh {
    FaceBudget budget;  ///< the plan that came nearest
    MeshResult result;  ///< its surface; the stages have the time of all plans, and of the other tries
};

/// Makes the surface of plan_faces(). Where that has another number of faces, it plans again, up to six times
/// for each kind of plan and number of levels, and keeps what comes nearest to `faces`. Throws as
/// plan_faces() and mesh_skeleton().
BudgetedMesh mesh_with_faces(const Skeleton& skeleton, const PointSet& constraints,
                             const MeshOptions& options, std::uint64_t faces, const Context& ctx = {});

/// What was chosen: "level 2, sides by radius, 31 of 31 axes, without 0.0 % of the silhouette".
std::string text_of(const FaceBudget& budget);

/// A sentence where a surface has over 5 % more or fewer faces than wanted; else nothing.
std::string text_of_missed_faces(const BudgetedMesh& made, std::uint64_t faces);

}  // namespace coppice
