#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/node_join.h"
#include "coppice/field/candidate_lists.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// The tubes of a surface, one per region of the field.
struct TubeTree {
    const Skeleton& tree;          ///< a tube is identified by its child node; depth-first order
    std::span<const NodeId> tube;  ///< per skeleton node: the tube that contains its segment; an invalid id
                                   ///< if it is not in the field
    std::span<const NodeJoin> joins = {};  ///< tubes that end at nodes of other branches
};

/// Classifies the segments near a region. A tube blends with its ancestors, descendants and siblings if their
/// segments are connected to it through other segments that touch the region's box: these are its `own`. At a
/// join it blends with the same tubes as a lateral there. Every other segment with a slightly enlarged
/// rounded cone that touches the box is a competing segment (`competitors`), connected or not: the two
/// surfaces form a contact instead of passing through each other. At most 48 competing segments are kept, the
/// nearest ones, so that time and memory are linear where hundreds of branches overlap.
struct ContactLists {
    CandidateLists own;          ///< segments that blend with the region's tube
    CandidateLists competitors;  ///< segments in contact with the region's tube
};

/// Returns, by tube, the index after the last tube of its subtree. Depth-first order makes a subtree a range
/// of tubes.
std::vector<std::uint32_t> subtree_ends(std::span<const NodeId> parent);

/// Finds the lists of all regions. `supports` has one entry per node of the skeleton. O((regions + lists) log
/// n). The result does not depend on the number of threads.
ContactLists find_contacts(const Skeleton& skeleton, std::span<const SegmentSupport> supports,
                           std::span<const FieldRegion> regions, const TubeTree& tubes,
                           const Context& ctx = {});

}  // namespace coppice
