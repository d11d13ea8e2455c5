#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/field/convolution_field.h"
#include "coppice/field/skeleton_segments.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "drag/branch_drag.h"
#include "drag/drag_job.h"
#include "drag/drag_part.h"

namespace coppice::bench {

/// The data that a GPU needs of a dragged branch: once all constant data, and for each frame the moved
/// elements.
class DragFeed {
  public:
    /// The arguments must outlive this object. O(n).
    DragFeed(const QuadBuild& build, const BranchDrag& drag, const DragPart& part, const Context& ctx = {});
    DragFeed(const DragFeed&) = delete;             ///< its job refers to it
    DragFeed& operator=(const DragFeed&) = delete;  ///< its job refers to it

    /// Valid during the lifetime of this object. The field's contact has to be above 0.
    DragJob job() const;
    /// Returns the moved elements of a pose; valid until the next call. O(branch).
    DragMoves moves(const DragPose& pose);

  private:
    void find_vertices();
    void find_quads();

    const QuadBuild* build_;
    const BranchDrag* drag_;
    const DragPart* part_;
    ControlMesh control_;     // the part at rest
    ConvolutionField field_;  // at rest
    SkeletonSegments segments_;
    Buffer<Vec3> drawn_;
    std::vector<std::uint32_t> vertices_;  // rotating vertices of the part's cage
    Buffer<std::uint32_t> fan_quads_;      // the part's fans, by the quads below
    std::vector<Quad> quads_about_;

    // Data of a frame.
    std::vector<MovedNode> moved_nodes_;
    std::vector<Vec3> moved_tubes_;
    std::vector<MovedVertex> moved_vertices_;
    std::vector<ClipPlane> clips_;
};

}  // namespace coppice::bench
