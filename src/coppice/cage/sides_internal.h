#pragma once

#include <vector>

#include "coppice/mesh/control_mesh.h"

namespace coppice::cage_internal {

/// Kind of a cage quad: a section of a tube, with edges 0 and 2 around it, or a face with all edges around
/// tubes.
enum class QuadKind : std::uint8_t { tube, face };

/// Doubles the number of quads around every branch: edges around branches are halved, tube quads become two,
/// faces four. New vertices keep the distance from their anchors. Edges along branches are not divided. O(n
/// log n).
void double_sides(ControlMesh& mesh, std::vector<QuadKind>& kind);

}  // namespace coppice::cage_internal
