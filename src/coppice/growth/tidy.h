#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/growth/guard.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Options of the smoothing and contraction of a grown tree.
struct TidyOptions {
    int relax_passes = 1;   ///< number of times that nodes move towards their parents; in [0, 100]
    float relax = 0.5f;     ///< fraction of the distance to the parent per pass; in [0, 1]
    int smooth_passes = 2;  ///< number of times that nodes move towards the middle of their neighbours along
                            ///< the axis; in [0, 1000]
    float smooth = 0.5f;    ///< fraction of the distance to that middle per pass; in [0, 1]
    float shortest = 0.5f;  ///< [mean length of a segment] minimum length; shorter segments are contracted; 0
                            ///< = never; in [0, 2]
    float within = 1;  ///< [radius] minimum distance to the parent; nearer nodes are contracted, because they
                       ///< are inside the parent's branch; 0 = never; in [0, 2]
};

/// Lists the members for front ends.
void list_fields(TidyOptions& o, FieldList& list);

/// A smoother tree, with statistics.
struct TidyResult {
    Skeleton skeleton;               ///< the new one
    std::uint32_t contracted = 0;    ///< number of nodes that were merged with an ancestor
    std::uint32_t held = 0;          ///< number of times that a node was not moved because of the guard
    std::vector<NodeId> new_of_old;  ///< for every node of the input the node that represents it
};

/// Prepares a grown skeleton for a surface: first nodes move towards their parents, which makes branching
/// angles more acute [Runions2007]; then axes, which follow the leaders, are smoothed; then tiny segments are
/// removed, as are nodes inside the branch of their parent. Roots are not moved; the tip of an axis may lose
/// its last steps, and a lateral that ends inside its parent's branch is removed completely. Radii are kept,
/// so they should be final before: they determine leaders and the interior of branches.
///
/// With a guard no segment that was clear of the solid enters it: nodes with such segments are not moved. All
/// other preparation is left to `prepare`.
///
/// The result does not depend on the number of threads (bit-identical). Throws InvalidInput if an option is
/// out of range; Cancelled. O(n passes).
TidyResult tidy(const Skeleton& skeleton, const TidyOptions& options = {}, const Guard* guard = nullptr,
                const Context& ctx = {});

}  // namespace coppice
