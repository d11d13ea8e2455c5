#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/io/skeleton/mtg/document_internal.h"
#include "coppice/io/text_internal.h"

namespace coppice::mtg {

/// What stands before the code of the plants.
struct Header {
    std::map<std::string, std::uint16_t, std::less<>> scale;  ///< of the symbols of classes
    std::vector<Column> columns;                              ///< in the order of the file
    std::vector<std::uint32_t> cells;                         ///< of a row, for each column
    std::uint32_t code_cells = 1;                             ///< so many begin a row, before the features
    bool has_tabs = true;                                     ///< rows are cut at tabs, and not at blanks
    bool is_form_b = false;
};

/// The line without a comment: "#" and what follows, up to the next tab.
std::string without_comments(std::string_view line);

/// Reads up to the line that names the columns, ENTITY-CODE or TOPO.
Header parse_header(LineReader& lines, const std::string& source);

}  // namespace coppice::mtg
