#pragma once

#include <vector>

#include "coppice/mesh/control_mesh.h"

namespace coppice::cage_internal {

/// What a cage quad is made of: a piece of a tube, whose edges 0 and 2 run around it, or a face all of whose
/// edges do.
enum class QuadKind : std::uint8_t { tube, face };

/// Doubles the number of quads around every branch: edges that run around are halved, tube quads become two,
/// faces four. New vertices keep the distance from their anchors. Edges along branches stay whole. O(n log
/// n).
void double_sides(ControlMesh& mesh, std::vector<QuadKind>& kind);

}  // namespace coppice::cage_internal
