#include "csv_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace coppice::cli {

std::string to_csv_cell(const Json& figure) {
    if (figure.is_null() || figure.is_structured()) return {};  // rows have no nested figures
    if (figure.is_number_float()) {
        const double number = figure.get<double>();
        return fmt::format("{:.{}g}", number, std::abs(number) >= 1000 ? 10 : 7);
    }
    if (!figure.is_string()) return figure.dump();
    std::string text = figure.get<std::string>();
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) text.insert(at, 1, '"');
    return fmt::format("\"{}\"", text);
}

std::string to_csv(const std::vector<Json>& rows) {
    std::vector<std::string> columns;
    std::map<std::string, std::size_t> place;
    const auto add_column = [&](const std::string& name) {
        if (place.emplace(name, columns.size()).second) columns.push_back(name);
    };
    for (const Json& row : rows)
        for (const auto& [name, figure] : row.items())
            if (name != "error") add_column(name);
    add_column("error");
    std::string out = fmt::format("{}\n", fmt::join(columns, ","));
    for (const Json& row : rows) {
        std::vector<std::string> cells(columns.size());
        for (const auto& [name, figure] : row.items()) cells[place[name]] = to_csv_cell(figure);
        out += fmt::format("{}\n", fmt::join(cells, ","));
    }
    return out;
}

void CsvFile::add(const Json& row) {
    std::vector<std::string> names, cells;
    for (const auto& [name, figure] : row.items()) {
        names.push_back(name);
        cells.push_back(to_csv_cell(figure));
    }
    if (rows_++ == 0) file_.write(fmt::format("{}\n", fmt::join(names, ",")));
    file_.write(fmt::format("{}\n", fmt::join(cells, ",")));
}

}  // namespace coppice::cli
