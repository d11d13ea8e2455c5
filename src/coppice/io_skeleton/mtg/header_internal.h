#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/io/text.h"
#include "coppice/io_skeleton/mtg/document_internal.h"

namespace coppice::mtg {

/// The part of the file before the code of the plants.
struct Header {
    std::map<std::string, std::uint16_t, std::less<>> scale;  ///< by the symbol of the class
    std::vector<Column> columns;                              ///< in the order of the file
    std::vector<std::uint32_t> cells;                         ///< index of the cell in a row, for each column
    std::uint32_t code_cells = 1;  ///< number of cells for the code at the beginning of a row
    bool has_tabs = true;          ///< whether cells are separated by tabs rather than blanks
    bool is_form_b = false;
};

/// Returns the line without comments, which extend from "#" to the next tab.
std::string without_comments(std::string_view line);

/// Reads the header including the line that names the columns, ENTITY-CODE or TOPO.
Header parse_header(LineReader& lines, const std::string& source);

}  // namespace coppice::mtg
