#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "coppice/foliage/leaf_shape.h"
#include "coppice/foliage/placement.h"

namespace coppice {

/// The leaves of a species.
struct LeafSpecies {
    std::string_view name;   ///< "oak"
    std::string_view title;  ///< "pedunculate oak, Quercus robur"
    LeafShape shape;         ///< a leaf of middle size
    LeafRules rules;         ///< its place on shoots, and the colours of the seasons
};

/// Returns all species: first broad leaves, then conifers. Sizes of leaves and petioles, arrangements,
/// distances of nodes and inclinations are within the ranges of floras; see docs/decisions/0038-foliage.md.
std::span<const LeafSpecies> leaf_species();

/// Returns the leaves of a species by its name; nullopt for other names.
std::optional<LeafSpecies> find_leaf_species(std::string_view name);

}  // namespace coppice
