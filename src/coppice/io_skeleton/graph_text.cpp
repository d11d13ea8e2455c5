#include <limits>
#include <optional>

#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/io/text.h"
#include "coppice/io_skeleton/parsers_internal.h"

namespace coppice {

namespace {

Vec3d read_point(const std::vector<std::string_view>& cells, const std::string& source, std::uint32_t line) {
    Vec3d p;
    if (cells.size() < 4) fail_at(source, line, "a position needs three numbers");
    for (int i = 0; i < 3; ++i) {
        const std::string_view cell = cells[static_cast<std::size_t>(i) + 1];
        const std::optional<double> value = parse_number(cell);
        if (!value)
            fail_at(source, line,
                    fmt::format("{} is not a number; it should be a coordinate", in_quotes(cell)));
        p[i] = *value;
    }
    return p;
}

/// An edge as in the file, stored until all vertices are known.
struct PendingEdge {
    std::int64_t from, to;
    std::uint32_t line;
};

std::uint32_t checked_index(std::int64_t index, std::size_t count, const std::string& source,
                            std::uint32_t line, int first) {
    if (index < 0 || index >= static_cast<std::int64_t>(count)) {
        fail_at(source, line, fmt::format("there is no vertex {}; the file has {}", index + first, count));
    }
    return static_cast<std::uint32_t>(index);
}

void resolve(const std::vector<PendingEdge>& pending, EdgeGraph& graph, const std::string& source,
             int first) {
    graph.edges.reserve(pending.size());
    for (const PendingEdge& e : pending) {
        graph.edges.push_back({checked_index(e.from, graph.position.size(), source, e.line, first),
                               checked_index(e.to, graph.position.size(), source, e.line, first)});
    }
}

class ObjLinesParser {
  public:
    ObjLinesParser(std::string_view text, const std::string& source, const Context& ctx)
        : lines_(text, ctx), source_(source) {}

    EdgeGraph parse() {
        while (lines_.next()) {
            const std::string_view line = trimmed(lines_.line());
            if (line.empty()) continue;
            split_at_blanks(line, cells_);
            if (line[0] == '#') {
                read_comment(line);
            } else if (cells_[0] == "v") {
                graph_.position.push_back(read_point(cells_, source_, lines_.number()));
                graph_.radius.push_back(kUnknown);
            } else if (cells_[0] == "l" || cells_[0] == "p") {
                read_line();
            } else if (cells_[0] == "f") {
                has_faces_ = true;
            }
        }
        finish();
        return std::move(graph_);
    }

  private:
    static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

    void read_comment(std::string_view line) {
        if (line.find(kDirectedMark) != std::string_view::npos) graph_.directed = true;
        if (cells_.size() != 3 || cells_[1] != "radius" || graph_.radius.empty()) return;
        graph_.radius.back() = parse_number(cells_[2]).value_or(kUnknown);
        has_radii_ = true;
    }

    void read_line() {
        if (cells_.size() < 2) fail_at(source_, lines_.number(), "a line element needs vertices");
        std::int64_t previous = vertex(cells_[1]);
        if (cells_.size() == 2) pending_.push_back({previous, previous, lines_.number()});
        for (std::size_t i = 2; i < cells_.size(); ++i) {
            const std::int64_t next = vertex(cells_[i]);
            pending_.push_back({previous, next, lines_.number()});
            previous = next;
        }
    }

    /// Parses "7", "7/3" for vertex and texture, or "-1" for the last vertex.
    std::int64_t vertex(std::string_view cell) const {
        const std::optional<std::int64_t> value = parse_integer(cell.substr(0, cell.find('/')));
        if (!value || *value == 0) {
            fail_at(source_, lines_.number(),
                    fmt::format("{} is not the number of a vertex", in_quotes(cell)));
        }
        return *value > 0 ? *value - 1 : static_cast<std::int64_t>(graph_.position.size()) + *value;
    }

    void finish() {
        if (pending_.empty()) {
            throw InvalidInput(
                fmt::format("{}: there are no line elements ('l'), so this is not a skeleton{}", source_,
                            has_faces_ ? " but a mesh" : ""));
        }
        resolve(pending_, graph_, source_, 1);
        if (!has_radii_) graph_.radius.clear();
        graph_.weld = !graph_.directed;
        graph_.drop_isolated = true;
    }

    LineReader lines_;
    const std::string& source_;
    std::vector<std::string_view> cells_;
    EdgeGraph graph_;
    std::vector<PendingEdge> pending_;
    bool has_radii_ = false;
    bool has_faces_ = false;
};

}  // namespace

EdgeGraph parse_obj_lines(std::string_view text, const std::string& source, const Context& ctx) {
    return ObjLinesParser(text, source, ctx).parse();
}

EdgeGraph parse_gel(std::string_view text, const std::string& source, const Context& ctx) {
    EdgeGraph graph;
    std::vector<PendingEdge> pending;
    std::vector<std::string_view> cells;
    LineReader lines(text, ctx);
    while (lines.next()) {
        split_at_blanks(lines.line(), cells);
        if (cells.empty() || cells[0][0] == '#') continue;
        if (cells[0] == "n") {
            graph.position.push_back(read_point(cells, source, lines.number()));
        } else if (cells[0] == "c") {
            const auto from = cells.size() >= 3 ? parse_integer(cells[1]) : std::nullopt;
            const auto to = cells.size() >= 3 ? parse_integer(cells[2]) : std::nullopt;
            if (!from || !to) fail_at(source, lines.number(), "a connection needs the numbers of two nodes");
            pending.push_back({*from, *to, lines.number()});
        } else {
            fail_at(source, lines.number(),
                    fmt::format("a line of a GEL graph must begin with 'n' or 'c', not with {}",
                                in_quotes(cells[0])));
        }
    }
    resolve(pending, graph, source, 0);
    return graph;
}

}  // namespace coppice
