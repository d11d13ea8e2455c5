#pragma once

#include <span>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/subdivision/project.h"
#include "drag/branch_drag.h"
#include "drag/drag_part.h"

namespace coppice::bench {

/// Computes the surface of a dragged branch, frame after frame, on the CPU: the cage of the part that changes
/// is refined, moved onto the field of the posed skeleton, and given normals. At angle 0 it is bit-identical
/// to the build's surface at rest, and for any part, it is the same as that of the whole. The result does not
/// depend on the number of threads.
///
/// If more than a thousand segments are within two diagonals of a region's box, the selection of the segments
/// that press on it from outside may differ.
class DraggedSurface {
  public:
    /// Begins at rest. Both must outlive this object. O(n).
    DraggedSurface(const QuadBuild& build, const DragPart& part, const Context& ctx = {});

    /// Computes the surface of a pose. O(skeleton) with a small constant for the field, otherwise O(part).
    ProjectReport make(const DragPose& pose, const Context& ctx = {});

    std::span<const Vec3> positions() const { return positions_; }  ///< [m] in drawing order: see DragPart
    std::span<const Vec3> normals() const { return normals_; }      ///< unit, in the same order

  private:
    ProjectReport project_part(const DragPose& pose, Buffer<Vec3>& positions, const Context& ctx) const;

    const QuadBuild* build_;
    const DragPart* part_;
    Buffer<Vec3> positions_, normals_;
};

}  // namespace coppice::bench
