#pragma once

#include <string>
#include <string_view>

#include "coppice/options/figures.h"
#include "coppice/options/quantity.h"  // grouped(), for texts printed next to figures

namespace coppice::cli {

/// Formats figures as JSON. Invalid UTF-8 is replaced by the replacement character.
std::string figures_json(const Json& figures);

/// Formats figures for people: one line per figure, with the names in one column; a nested object is one
/// line. `unknown` is the text of null.
std::string figures_text(const Json& figures, std::string_view unknown = "unknown");

/// Returns a known value, or else null: an empty cell of a table.
inline Json known(const Json& value, bool is_known) { return is_known ? value : Json(); }

}  // namespace coppice::cli
