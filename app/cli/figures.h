#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "coppice/options/quantity.h"  // grouped(), for texts printed next to figures

namespace coppice::cli {

struct Figure;

/// Replaces a figure that depends on a measurement that was skipped: null in JSON.
struct NotChecked {
    std::string subject;  ///< name of the measurement, for people
};

/// The figures that a command reports, in order of insertion: names with numbers, texts, lists or nested
/// figures.
class Figures {
  public:
    /// Returns the figure of this name; creates it if it does not exist.
    Figure& operator[](std::string_view name);
    void append(const Figures& others);

    using Entries = std::vector<std::pair<std::string, Figure>>;
    const Entries& entries() const { return figures_; }

  private:
    Entries figures_;
};

struct Figure {
    using List = std::vector<Figure>;

    Figure() = default;
    Figure(NotChecked unknown) : value(std::move(unknown)) {}
    Figure(bool yes) : value(yes) {}
    template <std::unsigned_integral Number>
    Figure(Number number) : value(std::uint64_t{number}) {}
    template <std::signed_integral Number>
    Figure(Number number) : value(std::int64_t{number}) {}
    template <std::floating_point Number>
    Figure(Number number) : value(double{number}) {}
    Figure(std::string text) : value(std::move(text)) {}
    Figure(const char* text) : value(std::string(text)) {}
    Figure(List list) : value(std::move(list)) {}
    Figure(Figures figures) : value(std::move(figures)) {}

    std::variant<bool, std::uint64_t, std::int64_t, double, std::string, List, Figures, NotChecked> value;
};

/// Inserts a struct that has visit_figures.
template <class Report>
Figures compute_figures(const Report& report) {
    Figures out;
    visit_figures(report, [&](std::string_view name, const auto& value) {
        if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(value)>>) {
            out[name] = value;
        } else {
            out[name] = compute_figures(value);
        }
    });
    return out;
}

/// Converts the figures to JSON: groups become objects. Invalid UTF-8 is replaced by the replacement
/// character.
std::string figures_json(const Figures& figures);

/// Formats the figures for people: one line per figure, with the names in one column; a nested group is one
/// line.
std::string figures_text(const Figures& figures);

/// Formats a text as a CSV cell, quoted where required (RFC 4180).
std::string csv_cell(std::string text);

}  // namespace coppice::cli
