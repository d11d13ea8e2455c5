#pragma once

#include <span>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/pipeline/drag/branch_drag.h"
#include "coppice/pipeline/drag/drag_part.h"
#include "coppice/pipeline/drag/quad_model.h"
#include "coppice/subdivision/project.h"

namespace coppice {

/// The surface of a branch that is dragged, frame after frame, on the CPU: the cage of the part that changes
/// is refined, moved onto the field of the posed skeleton, and given normals. At angle 0 it is the model's
/// surface at rest to the bit, and whatever the part, the same as if the whole had been made. Bits do not
/// depend on threads.
///
/// Where more than a thousand segments lie within two diagonals of a region's box, what presses on it from
/// without may be chosen among others.
class DraggedSurface {
  public:
    /// Begins at rest. Both must outlive this. O(n).
    DraggedSurface(const QuadModel& model, const DragPart& part, const Context& ctx = {});

    /// Makes the surface of a pose. O(skeleton) with a small constant for the field, else O(part).
    ProjectReport make(const DragPose& pose, const Context& ctx = {});

    std::span<const Vec3> positions() const { return positions_; }  ///< [m] in drawing order: see DragPart
    std::span<const Vec3> normals() const { return normals_; }      ///< unit, likewise

  private:
    ProjectReport project_part(const DragPose& pose, Buffer<Vec3>& positions, const Context& ctx) const;

    const QuadModel* model_;
    const DragPart* part_;
    Buffer<Vec3> positions_, normals_;
};

}  // namespace coppice
