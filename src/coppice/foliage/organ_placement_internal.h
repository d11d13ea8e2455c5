#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/foliage/organ_species.h"
#include "coppice/foliage/placement.h"
#include "coppice/foliage/tree_foliage.h"
#include "coppice/mesh/instances.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::foliage_internal {

/// The branches that bear flowers and fruit: copies of models, or one copy of the tree itself.
struct OrganBranches {
    const Skeleton& tree;              ///< for the wood that clusters must not enter
    std::span<const Skeleton> models;  ///< axes, in the frames of prototypes
    const Instances& copies;           ///< places of the models, by Instances::prototypes
    float max_radius = 1;              ///< [m] of shoots of the models
    int min_order = 0;                 ///< minimum branch order of shoots of the models
};

/// Adds clusters of flowers and fruit to a tree, with their numbers. A cluster depends only on its place on
/// the branch and on the seed. The same bits for any number of threads. Throws InvalidInput for more than 20
/// million clusters; Cancelled.
void add_organs(TreeFoliage& tree, const OrganBranches& branches, std::span<const Organ> organs,
                const OrganOptions& options, const LeafRules& rules, int models, const Context& ctx);

}  // namespace coppice::foliage_internal
