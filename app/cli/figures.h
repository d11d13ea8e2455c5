#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "coppice/pipeline/quantity.h"  // grouped(), for texts beside figures

namespace coppice::cli {

struct Figure;

/// In place of a figure that depends on what was not measured: null in JSON.
struct NotChecked {
    std::string what;  ///< what was not measured, for people
};

/// What a command reports, in the order in which it was said: names with numbers, texts, lists or figures of
/// their own.
class Figures {
  public:
    /// The figure of a name, added where there is none.
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

/// Anything with visit_figures.
template <class Report>
Figures figures_of(const Report& report) {
    Figures out;
    visit_figures(report, [&](std::string_view name, const auto& value) {
        if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(value)>>) {
            out[name] = value;
        } else {
            out[name] = figures_of(value);
        }
    });
    return out;
}

/// As JSON: groups are objects. Text that is not UTF-8 has the replacement character instead.
std::string figures_json(const Figures& figures);

/// The same for people: a line per figure with the names in one column; a group of figures fills one line.
std::string figures_text(const Figures& figures);

/// A text as a cell of CSV: in quotes where it would break the row (RFC 4180).
std::string csv_cell(std::string text);

}  // namespace coppice::cli
