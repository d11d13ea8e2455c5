#pragma once

#include <cstdint>

#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice {

/// Smallest number of faces that may be asked for.
inline constexpr std::uint64_t kMinFaces = 100;

/// Largest number of faces that may be asked for.
inline constexpr std::uint64_t kMaxFaces = 100'000'000;

/// A skeleton and options of which a surface has about as many faces as are wanted.
struct FaceBudget {
    Skeleton skeleton;              ///< with what is drawn of the given one
    MeshOptions options;            ///< those given, with other levels and stations
    std::uint64_t faces = 0;        ///< of the surface, before quads that cross are remeshed
    std::uint32_t axes = 0;         ///< of the given skeleton
    std::uint32_t dropped = 0;      ///< of these, left out, with all that they carry
    double dropped_silhouette = 0;  ///< share of the silhouette of all segments that they had
};

/// Chooses for a surface of quads how often its cage is subdivided, how far apart its rings are, and which
/// branches are drawn, so that it has about so many faces.
///
/// The levels are those at which the cage has nearly as many faces as with the rings of the given options.
/// Then rings move apart or together, which moves the surface by up to a fifth of the local radius
/// (ResampleOptions::tolerance). Where that is not enough even without any level, axes go, least silhouette
/// first: the sum of length times width of an axis and all that it carries. The axes that begin at roots
/// always stay; a surface of them may still have more faces than are wanted. What is remeshed where quads
/// cross has more faces than planned, many where rings stand nearer than five radii.
///
/// `options` are those for the given skeleton; their levels are not looked at. Throws InvalidInput naming
/// `faces` when it is not from kMinFaces to kMaxFaces, and `method` when it is not quads or bmesh. It makes
/// some twenty cages: about as long as the surface takes at two levels.
FaceBudget plan_faces(const Skeleton& skeleton, const MeshOptions& options, std::uint64_t faces,
                      const Context& ctx = {});

}  // namespace coppice
