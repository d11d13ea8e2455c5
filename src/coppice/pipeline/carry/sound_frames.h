#pragma once

#include <cstdint>
#include <vector>

#include "coppice/animate/pose.h"
#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/pipeline/carry/carried_mesh.h"

namespace coppice {

/// A frame of an animation.
struct SoundFrame {
    Buffer<Vec3> positions;           ///< [m] by vertex
    Pose pose;                        ///< that it shows: the one that was wanted, but for what was held
    std::uint32_t held_nodes = 0;     ///< that stand to their parents as in the frame before
    bool whole_tree_held = false;     ///< nothing moved, as holding branches did not help
    std::uint64_t folded = 0;         ///< faces that would have folded
    std::uint64_t crossings = 0;      ///< pairs of faces that would have crossed
    std::uint32_t rounds = 1;         ///< times that the surface was carried
    std::uint64_t not_converged = 0;  ///< vertices that did not reach the field

    bool is_held() const { return held_nodes > 0; }  ///< not as it was wanted
};

/// The frames of an animation in order, every one sound: no face is folded and none cross that are not so at
/// rest. Where a pose would fold or cross, the branches in question are held: they stand to each other as in
/// the frame before, which was sound, while all else moves on; what crosses, on the whole way between both.
/// Where that does not help, the tree stays as it was.
class SoundFrames {
  public:
    /// Begins at rest. The mesh must outlive this.
    explicit SoundFrames(CarriedMesh& mesh);

    /// The next frame; the first one is reached from rest in steps, which are not shown. O(n log n), for each
    /// round.
    SoundFrame next(const Pose& wanted, const Context& ctx = {});

  private:
    SoundFrame step(const Pose& wanted, const Context& ctx);

    CarriedMesh& mesh_;
    Pose last_;
    Buffer<Vec3> positions_;                 // of the last pose
    bool is_at_rest_ = true;                 // no frame has been made
    std::vector<std::uint32_t> last_stiff_;  // vertices that were only carried in it
};

}  // namespace coppice
