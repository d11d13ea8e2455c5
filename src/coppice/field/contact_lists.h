#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/node_join.h"
#include "coppice/field/candidate_lists.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// The tubes that a surface is made of, one per region of the field.
struct TubeTree {
    const Skeleton& tree;  ///< a tube is named by its child node; depth-first order
    std::span<const NodeId>
        tube;  ///< per skeleton node: the tube that wraps its segment; none: not in the field
    std::span<const NodeJoin> joins = {};  ///< tubes that end in nodes of other branches
};

/// Splits what may meet in a region. A tube grows together with its ancestors, descendants and siblings as
/// far as their segments are connected to it through others that touch the region's box: these are its
/// `own`. Through a join it grows together with what it would there as a lateral. Every other segment whose
/// rounded cone, a little enlarged, reaches the box is a rival, connected or not: the two surfaces form a
/// contact instead of passing through each other. Of more than 48 rivals the nearest are kept: time and
/// memory stay linear where hundreds of branches overlap.
struct ContactLists {
    CandidateLists own;     ///< segments that a region's tube grows together with
    CandidateLists rivals;  ///< segments that it is in contact with
};

/// Depth-first order makes a subtree a range of tubes: by tube, one past the last of its subtree.
std::vector<std::uint32_t> subtree_ends(std::span<const NodeId> parent);

/// `supports` has one entry per node of the skeleton. O((regions + lists) log n). Deterministic for any
/// number of threads.
ContactLists find_contacts(const Skeleton& skeleton, std::span<const SegmentSupport> supports,
                           std::span<const FieldRegion> regions, const TubeTree& tubes,
                           const Context& ctx = {});

}  // namespace coppice
