#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "coppice/options/json.h"

namespace coppice {

/// Returns the figures of a report as an object. The report describes itself by visit_figures(report, visit),
/// which calls visit(name, value) for every figure in order. Values are numbers, booleans, texts, reports and
/// lists of reports.
template <class Report>
Json compute_figures(const Report& report) {
    Json out = Json::object();
    visit_figures(report, [&](std::string_view name, const auto& value) {
        Json& figure = out[std::string(name)];
        if constexpr (requires { visit_figures(value, [](const auto&, const auto&) {}); }) {
            figure = compute_figures(value);
        } else if constexpr (requires { visit_figures(value.front(), [](const auto&, const auto&) {}); }) {
            figure = Json::array();
            for (const auto& part : value) figure.push_back(compute_figures(part));
        } else {
            figure = value;
        }
    });
    return out;
}

}  // namespace coppice
