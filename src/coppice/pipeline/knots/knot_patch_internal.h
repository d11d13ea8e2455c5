#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/pipeline/knots/knots_internal.h"
#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice::pipeline_internal {

/// How carefully a slice is remeshed: each step gives up some beauty for the certainty that nothing crosses.
enum class Care : std::uint8_t {
    none,   ///< quads of pairs of triangles, smoothed on the surface
    still,  ///< vertices stay where the tetrahedra had them
    flat,   ///< and each quad lies in the plane of a triangle
};

inline constexpr std::uint32_t kNoSeam = 0xffffffffu;  ///< no seam

/// The surface that fills the place of a group, joined to the rings at its seams by bands of triangles.
/// Vertices are those of the rings, seam by seam, and then others.
struct KnotSurface {
    KnotGroup group;                    ///< what it replaces
    KnotSkeleton knot;                  ///< what it wraps
    CapsuleTree capsules;               ///< of knot.skeleton
    Buffer<Vec3> positions;             ///< [m]
    std::uint32_t ring_vertices = 0;    ///< number of vertices of the rings
    std::vector<Triangle> triangles;    ///< all around what goes
    std::vector<std::uint32_t> seam;    ///< per triangle: the seam whose band it is of, or kNoSeam
    std::vector<Slice> slice;           ///< per triangle: the one it is near, or none
    std::vector<std::uint32_t> failed;  ///< seams that could not be joined: the surface is no use
    std::vector<Slice> beyond;          ///< slices beyond the seams that it runs into: likewise
    bool is_impossible = false;  ///< tetrahedra find no surface, however much is taken, or too large a one
    /// Whether it can be used.
    bool is_whole() const { return failed.empty() && beyond.empty() && !is_impossible; }
};

/// Marches through tetrahedra about the group, and joins what it finds to `mesh`. Does not try what would
/// take much more quads than that has, and a million.
KnotSurface knot_surface(KnotGroup group, const KnotSkeletons& skeletons, const QuadMesh& mesh,
                         const MeshOptions& options, const Context& ctx);

/// Quads in place of a group.
struct KnotQuads {
    Buffer<Vec3> positions;               ///< [m] those of the rings first, as in KnotSurface
    std::vector<Quad> quads;              ///< all of the place
    std::vector<std::uint32_t> triangle;  ///< per quad: a triangle of the surface that it is from
};

/// Makes quads of it, as carefully as is asked for per slice; those near no slice take the last value.
KnotQuads knot_quads(const KnotSurface& surface, std::span<const Care> care, const MeshOptions& options,
                     const Context& ctx);

}  // namespace coppice::pipeline_internal
