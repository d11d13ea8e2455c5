#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/pipeline/mesh_options.h"
#include "coppice/pipeline/remesh/quadrangulate_internal.h"
#include "coppice/pipeline/repair/removed_rows_internal.h"

namespace coppice::pipeline_internal {

/// Repair level of a tube row: each level gives up some quality for the guarantee that quads do not
/// intersect.
enum class RepairLevel : std::uint8_t {
    none,   ///< quads made from pairs of triangles, smoothed on the surface
    still,  ///< vertices keep their positions from the tetrahedra
    flat,   ///< in addition, each quad is in the plane of a triangle
};

/// A position on the axis of a segment.
struct AxisPoint {
    NodeId segment;    ///< segment, or none
    float t = 0;       ///< parameter
    float radius = 0;  ///< [m] radius there
};

/// The level set around some segments of the field's skeleton.
struct Marched {
    std::vector<NodeId> segments;  ///< ascending
    TriMesh mesh;
    std::vector<AxisPoint> closest_axis_point;  ///< per vertex: the closest axis point, by distance in radii
    bool is_impossible = false;                 ///< tetrahedra find no surface, or it would be too large
    /// Returns whether it contains all of some segments, which are ascending.
    bool contains(std::span<const NodeId> some) const;
};

/// The surface that replaces a group of rows, joined to its cut rings by bands of triangles. The vertices of
/// the rings come first, ring by ring, then the others.
struct PatchSurface {
    RowGroup group;                          ///< the replaced rows
    PatchSkeleton patch_skeleton;            ///< the wrapped part of the skeleton
    std::shared_ptr<const Marched> marched;  ///< the level set from which it is cut
    Buffer<Vec3> positions;                  ///< [m]
    std::vector<NodeId> near;  ///< per vertex: a node of the patch skeleton with a close segment; or none
    std::uint32_t ring_vertices = 0;  ///< number of vertices of the rings
    std::vector<Triangle> triangles;  ///< triangles in place of the removed quads
    std::vector<std::uint32_t>
        cut_ring;                   ///< per triangle: the cut ring of the band that contains it, or kNoIndex
    std::vector<TubeRow> tube_row;  ///< per triangle: the closest row, or none
    std::vector<std::uint32_t> failed;  ///< cut rings that could not be joined; the surface is then invalid
    std::vector<TubeRow>
        beyond;  ///< rows beyond the cut rings that it intersects; the surface is then invalid
    bool is_impossible = false;  ///< fails for any size of the group
    /// Returns whether the surface is valid.
    bool is_whole() const { return failed.empty() && beyond.empty() && !is_impossible; }
};

/// Returns whether tetrahedra around some segments are tried: not if they would create many more quads than
/// the mesh has, and more than a million. O(n).
bool can_march(std::span<const Segment> segments, const QuadMesh& mesh, const MeshOptions& options);

/// Creates the surface for a group and joins it to `mesh`. It is cut from `marched`, if given and large
/// enough for the group; otherwise from a new level set, if can_march() allows it.
PatchSurface patch_surface(RowGroup group, std::shared_ptr<const Marched> marched,
                           const PatchSkeletons& skeletons, const QuadMesh& mesh, const MeshOptions& options,
                           const Context& ctx);

/// The quads that replace a group.
struct PatchQuads {
    Buffer<Vec3> positions;             ///< [m] vertices of the rings first, as in PatchSurface
    QuadPatch patch;                    ///< built from the triangles of the surface
    Buffer<Vec3> unsmoothed;            ///< [m] initial positions
    std::vector<std::uint32_t> pinned;  ///< vertices at the ends of round tips, ascending
    std::vector<std::uint8_t> is_new;   ///< per quad: whether it has not been checked yet
};

/// Creates quads of a surface at the repair level of each row; quads without a close row use the last value.
/// Existing quads are changed if their level is raised.
void make_quads(PatchQuads& quads, const PatchSurface& surface, std::span<const RepairLevel> repair_level,
                const MeshOptions& options, const Context& ctx);

}  // namespace coppice::pipeline_internal
