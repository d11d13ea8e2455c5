#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/foliage/branchlet.h"
#include "coppice/foliage/leaf_shape.h"
#include "coppice/foliage/placement.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Index of the material of leaves, Prototype::material.
inline constexpr std::uint32_t kLeafMaterial = 0;
/// Index of the material of the twigs of branchlets.
inline constexpr std::uint32_t kTwigMaterial = 1;

/// The leaves of a tree as files and pictures contain them.
struct TreeFoliage {
    std::vector<Prototype> prototypes;  ///< of leaves, or of branchlets' leaves and twigs, with unique names
    Foliage foliage;                    ///< places and figures; twigs are white
    std::uint64_t branchlets = 0;       ///< number of branchlets
};

/// Makes `models` different leaves and places them as place_leaves() does. With branchlets, which have a
/// length, branchlets are placed so instead: `rules.max_radius`, `min_order`, `shoot_length` and `size` are
/// those of branches and branchlets, all other rules those of the leaves on branchlets. Throws as
/// place_leaves(), make_leaves() and make_branchlets().
TreeFoliage make_foliage(const Skeleton& skeleton, const LeafShape& shape, const LeafRules& rules,
                         const BranchletOptions& branchlets, int models, const Context& ctx = {});

}  // namespace coppice
