#include "csv_file.h"

#include <fmt/format.h>

#include <cmath>

namespace coppice::cli {
namespace {

struct Cell {
    std::string operator()(const NotChecked&) const { return {}; }
    std::string operator()(bool yes) const { return yes ? "true" : "false"; }
    std::string operator()(std::uint64_t count) const { return fmt::format("{}", count); }
    std::string operator()(std::int64_t count) const { return fmt::format("{}", count); }
    std::string operator()(double number) const {
        return fmt::format("{:.{}g}", number, std::abs(number) >= 1000 ? 10 : 7);
    }
    std::string operator()(const std::string& text) const { return csv_cell(text); }
    std::string operator()(const Figure::List&) const { return {}; }
    std::string operator()(const Figures&) const { return {}; }
};

}  // namespace

std::string csv_cell_of(const Figure& figure) { return std::visit(Cell(), figure.value); }

void CsvFile::add(const Figures& row) {
    std::string names, cells;
    for (const auto& [name, figure] : row.entries()) {
        const char* separator = cells.empty() && names.empty() ? "" : ",";
        names += fmt::format("{}{}", separator, name);
        cells += fmt::format("{}{}", separator, csv_cell_of(figure));
    }
    if (rows_++ == 0) file_.write(fmt::format("{}\n", names));
    file_.write(fmt::format("{}\n", cells));
}

}  // namespace coppice::cli
