#include "figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace coppice::cli {
namespace {

using Json = nlohmann::ordered_json;

/// Converts a figure to JSON.
struct ToJson {
    template <class Plain>
    Json operator()(const Plain& value) const {
        return value;
    }
    Json operator()(const NotChecked&) const { return nullptr; }
    Json operator()(const Figure::List& list) const {
        Json out = Json::array();
        for (const Figure& figure : list) out.push_back(std::visit(*this, figure.value));
        return out;
    }
    Json operator()(const Figures& figures) const {
        Json out = Json::object();
        for (const auto& [name, figure] : figures.entries()) out[name] = std::visit(*this, figure.value);
        return out;
    }
};

/// Formats a value within a line.
struct Text {
    std::string operator()(const NotChecked& unknown) const {
        return fmt::format("unknown: {} not checked", unknown.subject);
    }
    std::string operator()(bool value) const { return value ? "yes" : "no"; }
    std::string operator()(std::uint64_t number) const { return grouped(number); }
    std::string operator()(std::int64_t number) const {
        const std::uint64_t size =
            number < 0 ? -static_cast<std::uint64_t>(number) : static_cast<std::uint64_t>(number);
        return fmt::format("{}{}", number < 0 ? "-" : "", grouped(size));
    }
    std::string operator()(double number) const {
        // Map coordinates need more digits before the decimal point than six significant digits provide.
        const double size = std::abs(number);
        return size >= 1e5 && size < 1e9 ? fmt::format("{:.2f}", number) : fmt::format("{:.6g}", number);
    }
    std::string operator()(const std::string& text) const { return text; }
    std::string operator()(const Figure::List& list) const {
        std::string text;
        for (const Figure& figure : list)
            text += fmt::format("{}{}", text.empty() ? "" : "  ", std::visit(*this, figure.value));
        return text;
    }
    std::string operator()(const Figures& figures) const {
        std::string text;
        for (const auto& [name, figure] : figures.entries())
            text += fmt::format("{}{} {}", text.empty() ? "" : "  ", name, std::visit(*this, figure.value));
        return text;
    }
};

}  // namespace

Figure& Figures::operator[](std::string_view name) {
    for (auto& [known, figure] : figures_)
        if (known == name) return figure;
    return figures_.emplace_back(name, Figure()).second;
}

void Figures::append(const Figures& others) {
    for (const auto& [name, figure] : others.entries()) (*this)[name] = figure;
}

std::string figures_json(const Figures& figures) {
    return ToJson()(figures).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string figures_text(const Figures& figures) {
    std::size_t width = 0;
    for (const auto& [name, figure] : figures.entries()) width = std::max(width, name.size());
    std::string text;
    for (const auto& [name, figure] : figures.entries())
        text += fmt::format("{:<{}}  {}\n", name, width, std::visit(Text(), figure.value));
    return text;
}

std::string csv_cell(std::string text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) text.insert(at, 1, '"');
    return fmt::format("\"{}\"", text);
}

}  // namespace coppice::cli
