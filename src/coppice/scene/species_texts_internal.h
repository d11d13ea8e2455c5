#pragma once

#include <span>
#include <string_view>

namespace coppice {

/// A file of the folder species/, which the build embeds.
struct SpeciesText {
    std::string_view name;  ///< without the extension
    std::string_view text;  ///< content
};

/// Returns the files in alphabetical order.
std::span<const SpeciesText> species_texts();

}  // namespace coppice
