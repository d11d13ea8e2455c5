#include <algorithm>
#include <array>
#include <optional>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/io/text.h"
#include "coppice/io_skeleton/parsers_internal.h"

namespace coppice {

namespace {

constexpr std::array<std::string_view, 7> kColumns{"id", "type", "x", "y", "z", "radius", "parent"};

class SwcLine {
  public:
    SwcLine(const std::vector<std::string_view>& cells, const std::string& source, std::uint32_t line)
        : cells_(cells), source_(source), line_(line) {}

    double number(std::size_t column) const {
        const std::optional<double> value = parse_number(cells_[column]);
        if (!value) fail("number", column);
        return *value;
    }

    std::int64_t integer(std::size_t column) const {
        const std::optional<std::int64_t> value = parse_integer(cells_[column]);
        if (!value) fail("whole number", column);
        return *value;
    }

  private:
    [[noreturn]] void fail(std::string_view kind, std::size_t column) const {
        fail_at(source_, line_,
                fmt::format("{} is not a {}; column {} should be the {}", in_quotes(cells_[column]), kind,
                            column + 1, kColumns[column]));
    }

    const std::vector<std::string_view>& cells_;
    const std::string& source_;
    std::uint32_t line_;
};

/// Some programs write 0 for "no parent".
void make_roots_of_zero(std::vector<RawNode>& nodes) {
    for (const RawNode& node : nodes) {
        if (node.id == 0) return;
    }
    for (RawNode& node : nodes) {
        if (node.parent == 0) node.parent = -1;
    }
}

/// Throws InvalidInput for a row that is not a node of SWC; `columns` is the number of values of the first
/// row. More than seven are allowed, because some programs append columns.
void check_row(std::string_view row, std::size_t values, std::size_t columns, const std::string& source,
               std::uint32_t line) {
    constexpr std::size_t kNeeded = kColumns.size();
    if (has_decimal_commas(row, kNeeded) || (values > kNeeded && has_only_commas(row)))
        fail_at(source, line, kDecimalCommas);
    if (values < kNeeded) {
        fail_at(source, line,
                fmt::format("{} values, but a node of SWC has 7: id type x y z radius parent", values));
    }
    if (values != columns) {
        fail_at(source, line,
                fmt::format("{} values, but the first row has {}; write notes after a #", values, columns));
    }
}

/// Checks a file with more columns than SWC has, as some programs append them. Throws InvalidInput if most
/// parents are missing, because then the columns have another meaning.
void check_parents(const std::vector<RawNode>& nodes, std::size_t columns, const std::string& source) {
    std::unordered_set<std::int64_t> ids;
    for (const RawNode& node : nodes) ids.insert(node.id);
    const auto missing = std::ranges::count_if(
        nodes, [&](const RawNode& node) { return node.parent > 0 && !ids.contains(node.parent); });
    if (2 * static_cast<std::size_t>(missing) <= nodes.size()) return;
    throw InvalidInput(
        fmt::format("{}: the rows have {} values, and the seventh, the parent, refers to no node in {} of {} "
                    "rows; the first seven columns of SWC are id type x y z radius parent",
                    source, columns, missing, nodes.size()));
}

}  // namespace

RawSkeleton parse_swc(std::string_view text, const std::string& source, const Context& ctx) {
    std::vector<RawNode> nodes;
    RawAttribute types{std::string(kSwcType), {}};
    std::vector<std::string_view> cells;
    std::size_t columns = 0;
    LineReader lines(text, ctx);
    while (lines.next()) {
        const std::string_view text_of_row = lines.line().substr(0, lines.line().find('#'));
        split_at_blanks(text_of_row, cells, true);
        if (cells.empty()) continue;
        if (nodes.empty()) columns = cells.size();
        check_row(text_of_row, cells.size(), columns, source, lines.number());
        const SwcLine row(cells, source, lines.number());
        nodes.push_back({row.integer(0),
                         row.integer(6),
                         {row.number(2), row.number(3), row.number(4)},
                         row.number(5),
                         lines.number()});
        types.values.push_back(parse_number(cells[1]).value_or(0));
    }
    if (columns > kColumns.size()) check_parents(nodes, columns, source);
    make_roots_of_zero(nodes);
    if (std::ranges::all_of(types.values, [](double type) { return type == 0; }))
        return {std::move(nodes), {}};
    return {std::move(nodes), {std::move(types)}};
}

}  // namespace coppice
