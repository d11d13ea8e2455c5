#include "csv_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
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
