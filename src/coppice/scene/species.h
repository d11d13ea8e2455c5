#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace coppice {

/// A scene that makes a finished tree: its surface with bark and leaves. It begins with a comment that names
/// the species, and has the variables `age` in years and `season`.
struct TreeSpecies {
    std::string_view name;   ///< "oak"
    std::string_view title;  ///< the first comment: "Pedunculate oak, Quercus robur"
    std::string_view scene;  ///< the text, with all comments
};

/// Returns the species of the folder species/ in alphabetical order.
std::span<const TreeSpecies> tree_species();

/// Returns the species of a name; nullopt for other names.
std::optional<TreeSpecies> find_tree_species(std::string_view name);

}  // namespace coppice
