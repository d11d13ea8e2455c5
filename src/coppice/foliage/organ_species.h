#pragma once

#include <array>
#include <span>
#include <string_view>

#include "coppice/base/option_fields.h"
#include "coppice/foliage/organ_shape.h"

namespace coppice {

/// A kind of clusters of flowers or fruit of a species, and their places on shoots or branchlets.
struct Organ {
    std::string_view name;    ///< "apple_blossom"; letters and underscores
    bool is_fruit = false;    ///< fruit and cones, or else flowers and catkins
    OrganShape shape;         ///< a cluster of middle size
    float shoot_length = 10;  ///< [m] length of the end of an axis that bears clusters
    float internode = 0.05f;  ///< [m] distance of the places along a shoot; the first one is at the tip
    float angle = 0.8f;       ///< [rad] between the cluster and the shoot
    float spread = 0.3f;      ///< [rad] standard deviation of this angle
    /// 1: the cluster hangs straight down; -1: it rises; 0: it has the direction of its place; in [-1, 1].
    float hang = 0;
    float min_height = 0;       ///< lowest clusters per height of the tree; in [0, 1]
    float size_spread = 0.12f;  ///< maximum relative deviation of sizes
    /// share of the places with a cluster, by Season: bud, young, summer, autumn, winter; in [0, 1]
    std::array<float, 5> shares{};
};

/// Factors of the numbers of flowers and fruit.
struct OrganOptions {
    float flower_density = 1;  ///< factor of the number of flowers of the species; in [0, 100]
    float fruit_density = 1;   ///< the same for fruit and cones; in [0, 100]
};

/// Lists the members for front ends.
void list_fields(OrganOptions& o, FieldList& list);

/// Returns the flowers and fruit of a species by the name of its leaves; none for fern and other names.
/// Sizes, numbers and seasons have their sources in docs/user/leaves.md.
std::span<const Organ> find_organs(std::string_view species);

}  // namespace coppice
