#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/pipeline/knots/knots_internal.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/remesh/quadrangulate.h"

namespace coppice::pipeline_internal {

/// How carefully a slice is remeshed: each step gives up some beauty for the certainty that nothing crosses.
enum class Care : std::uint8_t {
    none,   ///< quads of pairs of triangles, smoothed on the surface
    still,  ///< vertices stay where the tetrahedra had them
    flat,   ///< and each quad lies in the plane of a triangle
};

inline constexpr std::uint32_t kNoSeam = 0xffffffffu;  ///< no seam

/// A place on the axis of a segment.
struct AxisPoint {
    NodeId segment;  ///< or none
    float t = 0;     ///< parameter
};

/// The level set about some segments of the field's skeleton.
struct Marched {
    std::vector<NodeId> segments;  ///< ascending
    TriMesh mesh;
    std::vector<AxisPoint> foot;  ///< per vertex: the nearest, in radii
    bool is_impossible = false;   ///< tetrahedra find no surface, or it would be too large
};

/// The surface that fills the place of a group, joined to the rings at its seams by bands of triangles.
/// Vertices are those of the rings, seam by seam, and then others.
struct KnotSurface {
    KnotGroup group;                         ///< what it replaces
    KnotSkeleton knot;                       ///< what it wraps
    std::shared_ptr<const Marched> marched;  ///< what it is cut from
    Buffer<Vec3> positions;                  ///< [m]
    std::vector<NodeId> near;         ///< per vertex: a node of knot.skeleton, whose segment is near; or none
    std::uint32_t ring_vertices = 0;  ///< number of vertices of the rings
    std::vector<Triangle> triangles;  ///< all around what goes
    std::vector<std::uint32_t> seam;  ///< per triangle: the seam whose band it is of, or kNoSeam
    std::vector<Slice> slice;         ///< per triangle: the one it is near, or none
    std::vector<std::uint32_t> failed;  ///< seams that could not be joined: the surface is no use
    std::vector<Slice> beyond;          ///< slices beyond the seams that it runs into: likewise
    bool is_impossible = false;         ///< however much is taken
    /// Whether it can be used.
    bool is_whole() const { return failed.empty() && beyond.empty() && !is_impossible; }
};

/// Whether tetrahedra about some segments are tried: not where they would make much more quads than the mesh
/// has, and a million. O(n).
bool can_march(std::span<const Segment> segments, const QuadMesh& mesh, const MeshOptions& options);

/// The surface for a group: cuts it from what was marched through tetrahedra before, if anything, or anew
/// where that does not reach far enough beyond the group, and joins it to `mesh`, if can_march()
/// says so.
KnotSurface knot_surface(KnotGroup group, std::shared_ptr<const Marched> marched,
                         const KnotSkeletons& skeletons, const QuadMesh& mesh, const MeshOptions& options,
                         const Context& ctx);

/// Quads in place of a group.
struct KnotQuads {
    Buffer<Vec3> positions;            ///< [m] those of the rings first, as in KnotSurface
    QuadPatch patch;                   ///< made of the triangles of the surface
    Buffer<Vec3> unsmoothed;           ///< [m] the positions as they were at first
    std::vector<std::uint8_t> is_new;  ///< per quad: whether it has not been looked at yet
};

/// Makes quads of a surface, as carefully as is asked for per slice; those near no slice take the last value.
/// Quads that are there are changed where more care is asked for.
void make_quads(KnotQuads& quads, const KnotSurface& surface, std::span<const Care> care,
                const MeshOptions& options, const Context& ctx);

}  // namespace coppice::pipeline_internal
