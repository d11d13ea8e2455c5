#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "coppice/base/vec.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::pipeline_internal {

/// Moves the vertices of the cage quads that close round tips if there are no vertices between them that
/// could form a round shape: into the plane one radius beyond the last node, at such a distance from the axis
/// that the frustum of the last segment has the volume of segment and half ball. `has_blunt_tip`: per tube,
/// by its tip; `position` returns the position of a vertex of the cage. O(cage).
void shape_blunt_tips(const ControlMesh& control, const Skeleton& tubes,
                      const std::function<bool(NodeId)>& has_blunt_tip,
                      const std::function<Vec3&(std::uint32_t)>& position);

}  // namespace coppice::pipeline_internal
