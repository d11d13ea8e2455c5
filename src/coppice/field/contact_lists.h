#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/field/candidate_lists.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// The tubes that a surface is made of: one per region of the field, in depth-first order of the tree they
/// form.
struct TubeTree {
    std::span<const NodeId> parent;  ///< per tube; none for the first of a tree
    std::span<const NodeId> tube;    ///< per skeleton node: the tube that wraps its segment
};

/// Splits what may meet in a region. A tube grows together with its ancestors, descendants and siblings:
/// these stay in `own`. Every other segment whose rounded cone, a little enlarged, reaches the region's box
/// is a rival, connected or not: the two surfaces press against each other instead of passing through each
/// other. Of more than 48 rivals the nearest are kept: time and memory stay linear where hundreds of branches
/// overlap.
struct ContactLists {
    CandidateLists own;
    CandidateLists rivals;
};

/// O((regions + candidates) log n). Deterministic for any number of threads.
ContactLists find_contacts(const Skeleton& skeleton, const CandidateLists& candidates,
                           std::span<const FieldRegion> regions, const TubeTree& tubes,
                           const Context& ctx = {});

}  // namespace coppice
