#pragma once

#include <string>

#include "coppice/pipeline/json.h"

namespace coppice::cli {

/// Anything with visit_figures as JSON: groups become objects.
template <class Figures>
Json figures_json(const Figures& figures) {
    Json out = Json::object();
    visit_figures(figures, [&](std::string_view name, const auto& value) {
        if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(value)>>) {
            out[std::string(name)] = value;
        } else {
            out[std::string(name)] = figures_json(value);
        }
    });
    return out;
}

/// The same for people: a line per figure with the names in one column; a group of figures fills one line.
std::string figures_text(const Json& figures);

}  // namespace coppice::cli
