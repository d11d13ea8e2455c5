#include "csv_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <concepts>
#include <string_view>
#include <vector>

namespace coppice::cli {
namespace {

struct Cell {
    std::string operator()(const NotChecked&) const { return {}; }
    std::string operator()(bool yes) const { return yes ? "true" : "false"; }
    std::string operator()(double number) const {
        return fmt::format("{:.{}g}", number, std::abs(number) >= 1000 ? 10 : 7);
    }
    std::string operator()(const std::string& text) const { return csv_cell(text); }
    template <std::integral Count>
    std::string operator()(Count count) const {
        return fmt::format("{}", count);
    }
    // Rows have no nested figures.
    std::string operator()(const Figure::List&) const { return {}; }
    std::string operator()(const Figures&) const { return {}; }
};

}  // namespace

std::string to_csv_cell(const Figure& figure) { return std::visit(Cell(), figure.value); }

void CsvFile::add(const Figures& row) {
    std::vector<std::string_view> names;
    std::vector<std::string> cells;
    for (const auto& [name, figure] : row.entries()) {
        names.emplace_back(name);
        cells.push_back(to_csv_cell(figure));
    }
    if (rows_++ == 0) file_.write(fmt::format("{}\n", fmt::join(names, ",")));
    file_.write(fmt::format("{}\n", fmt::join(cells, ",")));
}

}  // namespace coppice::cli
