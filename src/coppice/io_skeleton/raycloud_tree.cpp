#include <algorithm>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "coppice/io/text.h"
#include "coppice/io_skeleton/parsers_internal.h"

namespace coppice {

namespace {

/// Content of the header line: attributes of the tree, then groups of attributes of its segments.
struct Layout {
    std::size_t tree_columns = 0;
    std::size_t group_columns = 0;
    std::optional<std::size_t> parent;  ///< column in a group
};

std::optional<Layout> read_layout(std::string_view line) {
    std::vector<std::string_view> names;
    split_at(line, ',', names);
    for (std::size_t i = 0; i + 3 < names.size(); ++i) {
        if (names[i] != "x" || names[i + 1] != "y" || names[i + 2] != "z" || names[i + 3] != "radius")
            continue;
        Layout layout{i, names.size() - i, std::nullopt};
        for (std::size_t k = 4; k < layout.group_columns; ++k) {
            if (names[i + k] == "parent_id") layout.parent = k;
        }
        return layout;
    }
    return std::nullopt;
}

class TreeLine {
  public:
    TreeLine(const std::vector<std::string_view>& cells, const Layout& layout, const std::string& source,
             std::uint32_t line)
        : cells_(cells), layout_(layout), source_(source), line_(line) {
        if (cells.size() < layout.tree_columns + layout.group_columns ||
            (cells.size() - layout.tree_columns) % layout.group_columns != 0) {
            fail_at(source, line,
                    fmt::format("{} values do not form a tree: expected {} and then {} for each segment",
                                cells.size(), layout.tree_columns, layout.group_columns));
        }
        segments_ = (cells.size() - layout.tree_columns) / layout.group_columns;
        if (segments_ > 1 && !layout.parent) {
            fail_at(source, line, "a tree with several segments needs a column parent_id in the header");
        }
    }

    void append_to(std::vector<RawNode>& nodes) const {
        const std::size_t first = nodes.size();
        for (std::size_t s = 0; s < segments_; ++s) {
            const std::int64_t up = layout_.parent ? parent(s) : -1;
            nodes.push_back({static_cast<std::int64_t>(nodes.size()),
                             up < 0 ? -1 : static_cast<std::int64_t>(first) + up,
                             {number(s, 0), number(s, 1), number(s, 2)},
                             number(s, 3),
                             line_});
        }
        if (segments_ > 1) take_radius_of_children(nodes, first);
    }

  private:
    /// The first segment only marks the base: it has no volume, and its radius is ignored.
    static void take_radius_of_children(std::vector<RawNode>& nodes, std::size_t root) {
        double radius = 0;
        for (std::size_t i = root + 1; i < nodes.size(); ++i) {
            if (nodes[i].parent == nodes[root].id) radius = std::max(radius, nodes[i].radius);
        }
        if (radius > 0) nodes[root].radius = radius;
    }

    std::string_view cell(std::size_t segment, std::size_t column) const {
        return cells_[layout_.tree_columns + segment * layout_.group_columns + column];
    }

    double number(std::size_t segment, std::size_t column) const {
        const std::optional<double> value = parse_number(cell(segment, column));
        if (!value) {
            constexpr std::string_view kNames[] = {"x", "y", "z", "radius"};
            fail_at(source_, line_,
                    fmt::format("{} is not a number; it should be the {} of segment {}",
                                in_quotes(cell(segment, column)), kNames[column], segment));
        }
        return *value;
    }

    std::int64_t parent(std::size_t segment) const {
        const std::string_view text = cell(segment, *layout_.parent);
        const std::optional<std::int64_t> value = parse_integer(text);
        if (!value || *value >= static_cast<std::int64_t>(segments_)) {
            fail_at(source_, line_,
                    fmt::format("{} is not the number of a segment of this tree; it should be the parent "
                                "of segment {}",
                                in_quotes(text), segment));
        }
        return *value;
    }

    const std::vector<std::string_view>& cells_;
    const Layout& layout_;
    const std::string& source_;
    std::uint32_t line_;
    std::size_t segments_ = 0;
};

}  // namespace

bool is_raycloud_header(std::string_view line) { return read_layout(line).has_value(); }

std::vector<RawNode> parse_raycloud(std::string_view text, const std::string& source, const Context& ctx) {
    std::vector<RawNode> nodes;
    std::vector<std::string_view> cells;
    std::optional<Layout> layout;
    LineReader lines(text, ctx);
    while (lines.next()) {
        const std::string_view line = trimmed(lines.line());
        if (line.empty() || line[0] == '#') continue;
        if (!layout) {
            layout = read_layout(line);
            if (!layout)
                fail_at(source, lines.number(),
                        "expected a header with 'x,y,z,radius', as written by raycloudtools");
            continue;
        }
        split_at(line, ',', cells);
        TreeLine(cells, *layout, source, lines.number()).append_to(nodes);
    }
    return nodes;
}

}  // namespace coppice
