#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/edit/animate/pose.h"
#include "coppice/pipeline/deform/skinned_mesh.h"

namespace coppice {

/// A frame of an animation.
struct ValidFrame {
    Buffer<Vec3> positions;           ///< [m] by vertex
    Pose pose;                        ///< the displayed pose: the requested one, except for frozen branches
    std::uint32_t frozen_nodes = 0;   ///< nodes that keep their position relative to their parents
    bool whole_tree_frozen = false;   ///< the whole tree did not move because holding branches did not help
    std::uint64_t folded = 0;         ///< faces that would have folded
    std::uint64_t crossings = 0;      ///< pairs of faces that would have crossed
    std::uint32_t rounds = 1;         ///< number of times that the surface was deformed
    std::uint64_t not_converged = 0;  ///< vertices that did not reach the field

    bool is_frozen() const { return frozen_nodes > 0; }  ///< not the requested pose
};

/// The frames of an animation in order, each without faults: no faces fold or cross that do not at rest.
/// Where a pose would cause folds or crossings, the branches involved are frozen: they keep their relative
/// positions of the previous frame, which has no faults, while all others move on; for crossings, all
/// branches between the two. If that does not help, the tree stays as it was.
class ValidFrames {
  public:
    /// Begins at rest. The mesh must outlive this object.
    explicit ValidFrames(SkinnedMesh& mesh);

    /// Returns the next frame; the first one is reached from rest in steps that are not returned. O(n log n)
    /// for each round.
    ValidFrame next(const Pose& wanted, const Context& ctx = {});

  private:
    ValidFrame step(const Pose& wanted, const Context& ctx);

    SkinnedMesh& mesh_;
    Pose last_;
    Buffer<Vec3> positions_;                 // of the last pose
    bool is_at_rest_ = true;                 // no frame has been computed
    std::vector<std::uint32_t> last_stiff_;  // vertices that were not projected in it
};

}  // namespace coppice
