#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/foliage/branchlet.h"
#include "coppice/foliage/leaf_shape.h"
#include "coppice/foliage/organ_shape.h"
#include "coppice/foliage/organ_species.h"
#include "coppice/foliage/placement.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// The leaves, flowers and fruit of a tree as files and pictures contain them.
struct TreeFoliage {
    /// Of leaves, or of branchlets' leaves and twigs, then of the parts of flowers and fruit, with unique
    /// names.
    std::vector<Prototype> prototypes;
    Foliage foliage;               ///< places and figures; twigs are white
    std::uint64_t branchlets = 0;  ///< number of branchlets
};

/// Flowers and fruit, and factors of their numbers.
struct FoliageOrgans {
    std::span<const Organ> organs;  ///< see find_organs()
    OrganOptions options;           ///< factors
};

/// Makes `models` different leaves and places them as place_leaves() does. With branchlets, which have a
/// length, branchlets are placed so instead: `rules.max_radius`, `min_order`, `shoot_length` and `size` are
/// those of branches and branchlets, all other rules those of the leaves on branchlets. Flowers and fruit of
/// the season are placed on the branchlets, or else on the shoots, as clusters of `models` shapes that begin
/// on the bark and turn up or down; clusters that would pass through wood are left out. Throws as
/// place_leaves(), make_leaves() and make_branchlets(), and InvalidInput for more than 20 million clusters.
TreeFoliage make_foliage(const Skeleton& skeleton, const LeafShape& shape, const LeafRules& rules,
                         const BranchletOptions& branchlets, int models, const FoliageOrgans& organs = {},
                         const Context& ctx = {});

}  // namespace coppice
