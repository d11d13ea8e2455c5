#include "coppice/scene/species.h"

#include <algorithm>
#include <vector>

#include "coppice/scene/species_texts_internal.h"

namespace coppice {
namespace {

/// Returns the first line without its number sign and the full stop.
std::string_view find_title(std::string_view text) {
    std::string_view line = text.substr(0, text.find('\n'));
    line.remove_prefix(std::min(line.find_first_not_of("# "), line.size()));
    if (line.ends_with('.')) line.remove_suffix(1);
    return line;
}

}  // namespace

std::span<const TreeSpecies> tree_species() {
    static const std::vector<TreeSpecies> kSpecies = [] {
        std::vector<TreeSpecies> out;
        for (const SpeciesText& file : species_texts())
            out.push_back({file.name, find_title(file.text), file.text});
        return out;
    }();
    return kSpecies;
}

std::optional<TreeSpecies> find_tree_species(std::string_view name) {
    const auto found = std::ranges::find(tree_species(), name, &TreeSpecies::name);
    if (found == tree_species().end()) return std::nullopt;
    return *found;
}

}  // namespace coppice
