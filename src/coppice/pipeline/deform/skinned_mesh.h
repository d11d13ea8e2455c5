#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/edit/animate/pose.h"
#include "coppice/measure/intersections.h"
#include "coppice/pipeline/mesh_options.h"
#include "coppice/pipeline/mesh_result.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/subdivision/project.h"

namespace coppice {

/// The surface of a skeleton in another pose.
struct SkinnedFrame {
    Buffer<Vec3> positions;             ///< [m] by vertex of the rest pose's mesh
    std::vector<std::uint32_t> folded;  ///< faces with a scaled Jacobian not above 0 that was above 0 at rest
    std::vector<FacePair> crossings;    ///< pairs of faces that cross, and did not at rest
    ProjectReport projected;            ///< distances of the vertices from the iso value of the field

    bool is_sound() const { return folded.empty() && crossings.empty(); }  ///< not worse than at rest
};

/// One surface of quads for all poses of a skeleton: built once, at rest, including remeshed
/// self-intersections, and deformed by the segments [Zhu2015], section 6. Its faces never change.
///
/// Every vertex has an anchor on the axes and moves with up to four segments: the anchor with their motions,
/// and the vector from there to the vertex with their rotations, blended over joints along the axis and where
/// a lateral leaves its parent branch. Then the vertices move along these vectors onto the field of the posed
/// skeleton. Vertices that were not on the field at rest, are on flat ends, in remeshed self-intersections,
/// or where folds were smoothed, move with the segments only.
///
/// About 60 bytes per vertex in addition to the surface itself.
class SkinnedMesh {
  public:
    /// Throws the exceptions of mesh_skeleton(), and InvalidInput naming `method` or `weights` if they are
    /// not quads and local.
    SkinnedMesh(const Skeleton& skeleton, const MeshOptions& options = {}, const Context& ctx = {});
    ~SkinnedMesh();                                  ///< frees its memory
    SkinnedMesh(SkinnedMesh&&) noexcept;             ///< leaves the source empty
    SkinnedMesh& operator=(SkinnedMesh&&) noexcept;  ///< leaves the source empty

    const MeshResult& made() const;    ///< the surface at rest, and its reports
    const Skeleton& skeleton() const;  ///< at rest

    /// Returns the surface in a pose of the skeleton; for the rest pose it is bit-identical to the surface at
    /// rest. The vertices of `stiff`, ascending, are not projected onto the field. The result does not depend
    /// on the number of threads. O(n log n).
    SkinnedFrame deform(const Pose& pose, std::span<const std::uint32_t> stiff = {}, const Context& ctx = {});

    /// Returns the vertices of the faces with faults in a frame, and of all adjacent faces, ascending.
    std::vector<std::uint32_t> at_fault(const SkinnedFrame& frame) const;

    /// Marks the nodes of the skeleton with segments that move a face; for a remeshed face, all nodes that
    /// move its repair patch, which is one body.
    void mark_movers(std::uint32_t face, std::span<std::uint8_t> is_mover) const;
    /// Returns the node of the skeleton with the segment that moves a face most.
    NodeId mover(std::uint32_t face) const;

  private:
    class Body;
    std::unique_ptr<Body> body_;
};

}  // namespace coppice
