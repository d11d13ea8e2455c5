#pragma once

#include <cstdint>
#include <numbers>

#include "coppice/pipeline/quads/quad_build.h"
#include "drag/branch_drag.h"
#include "drag/drag_part.h"

namespace coppice::test {

inline constexpr double kMax = 20 * std::numbers::pi / 180;  // [rad]

/// A branch of a tree, and the part that it can change.
struct Dragged {
    QuadBuild build;
    bench::BranchDrag drag;
    bench::DragPart part;

    explicit Dragged(const Skeleton& tree, const MeshOptions& options = {}, std::uint32_t segments = 40)
        : build(build_quads(tree, options)),
          drag(build, bench::branch_of_about(build.skeleton, segments), {0.3, 1, 0.2}),
          part(bench::drag_part(build, drag, kMax)) {}

    bench::DragPose at(double angle) const {
        bench::DragPose pose = drag.rest();
        drag.turn(angle, pose);
        return pose;
    }
};

}  // namespace coppice::test
