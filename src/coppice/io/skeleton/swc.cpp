#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "coppice/io/skeleton/parsers_internal.h"
#include "coppice/io/text_internal.h"

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

}  // namespace

RawSkeleton parse_swc(std::string_view text, const std::string& source, const Context& ctx) {
    std::vector<RawNode> nodes;
    RawAttribute types{std::string(kSwcType), {}};
    std::vector<std::string_view> cells;
    LineReader lines(text, ctx);
    while (lines.next()) {
        const std::string_view line = lines.line();
        split_at_blanks(line.substr(0, line.find('#')), cells, true);
        if (cells.empty()) continue;
        if (cells.size() < kColumns.size()) {
            fail_at(source, lines.number(),
                    fmt::format("{} values where a node of SWC has 7: id type x y z radius parent",
                                cells.size()));
        }
        const SwcLine row(cells, source, lines.number());
        nodes.push_back({row.integer(0),
                         row.integer(6),
                         {row.number(2), row.number(3), row.number(4)},
                         row.number(5),
                         lines.number()});
        types.values.push_back(parse_number(cells[1]).value_or(0));
    }
    make_roots_of_zero(nodes);
    if (std::ranges::all_of(types.values, [](double type) { return type == 0; }))
        return {std::move(nodes), {}};
    return {std::move(nodes), {std::move(types)}};
}

}  // namespace coppice
