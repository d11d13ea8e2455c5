#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/number_set.h"
#include "coppice/pipeline/repair/patch_internal.h"
#include "coppice/pipeline/repair/removed_rows_internal.h"

namespace coppice::pipeline_internal {

/// The repair patch that replaces one group.
struct RepairPatch {
    PatchSurface surface;
    PatchQuads quads;
    bool is_current = false;  ///< whether `quads` have the required repair levels
};

/// The repair patches of all groups.
class RepairPatches {
  public:
    /// The arguments must outlive this object. O(n).
    RepairPatches(const QuadBuild& build, const TubeRows& tube_rows, const QuadMesh& mesh,
                  const Context& ctx);

    /// Creates a repair patch for every group of removed rows, at the repair level of each row. Removes
    /// further rows until each group has a valid patch, and excludes groups without one. Existing results for
    /// a group are reused as far as they reach.
    void make(RemovedRows& removed, std::span<const RepairLevel> repair_level);

    /// Returns whether one patch can contain this number of segments.
    bool can_hold(std::span<const Segment> segments) const;

    std::size_t size() const { return repair_patches_.size(); }             ///< number of patches
    RepairPatch& operator[](std::size_t i) { return *repair_patches_[i]; }  ///< one of the patches
    const RepairPatch& operator[](std::size_t i) const {
        return *repair_patches_[i];
    }  ///< one of the patches

  private:
    void follow(std::vector<RowGroup> groups);
    std::shared_ptr<const Marched> made_for(const RowGroup& group) const;
    bool grow_to_fit(RemovedRows& removed, int attempt) const;

    const QuadMesh& mesh_;
    const MeshOptions options_;
    const Context& ctx_;
    PatchSkeletons skeletons_;
    std::vector<std::unique_ptr<RepairPatch>> repair_patches_;
    std::vector<std::uint32_t> owner_;        // per row: the patch that replaces it
    std::shared_ptr<const Marched> largest_;  // level set of the most segments so far
};

/// Inserts the repair patches into the mesh: kept quads and vertices first, in their order. Returns the
/// removed vertices. O(n).
NumberSet put_into(QuadMesh& mesh, const TubeRows& tube_rows, const RemovedRows& removed,
                   const RepairPatches& repair_patches, const Context& ctx);

/// Returns the resulting number of bodies of the mesh. O(rows + patches).
std::uint32_t count_bodies(const TubeRows& tube_rows, const RemovedRows& removed,
                           const RepairPatches& repair_patches);

}  // namespace coppice::pipeline_internal
