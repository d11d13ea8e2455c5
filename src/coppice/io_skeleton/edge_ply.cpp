#include <cmath>
#include <initializer_list>

#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/io/ply_header.h"
#include "coppice/io_skeleton/node_attribute.h"
#include "coppice/io_skeleton/parsers_internal.h"

namespace coppice {

namespace {

class EdgePlyParser {
  public:
    EdgePlyParser(std::string_view file, const std::string& source, const Context& ctx)
        : source_(source), header_(parse_ply_header(file, source)), rows_(file, header_, source, ctx) {}

    EdgeGraph parse() {
        bool has_edges = false;
        for (const PlyElement& element : header_.elements) {
            rows_.begin_element(element);
            if (element.name == "vertex") {
                read_vertices(element);
            } else if (element.name == "edge") {
                has_edges = true;
                read_edges(element);
            } else {
                rows_.skip_element();
            }
        }
        if (!has_edges) {
            throw InvalidInput(fmt::format(
                "{}: the PLY file has no element 'edge', so it contains a mesh or points, not a skeleton",
                source_));
        }
        check_indices();
        for (const std::string& comment : header_.comments) {
            if (comment == kDirectedMark) own_ = true;
        }
        graph_.weld = !own_;
        graph_.directed = own_ || !graph_.radius.empty();
        return std::move(graph_);
    }

  private:
    std::size_t required(const PlyElement& element, std::string_view name) const {
        const auto place = element.find({name});
        if (!place || element.properties[*place].is_list()) {
            throw InvalidInput(fmt::format("{}: the vertices have no number '{}'", source_, name));
        }
        return *place;
    }

    void read_vertices(const PlyElement& element) {
        const std::size_t x = required(element, "x"), y = required(element, "y"), z = required(element, "z");
        const auto found = element.find({"radius", "Radius", "r"});
        const bool has_radii = found && !element.properties[*found].is_list();
        const std::size_t radius = found.value_or(0);
        std::vector<std::size_t> columns;  // properties of the attributes
        for (std::size_t k = 0; k < element.properties.size(); ++k) {
            const PlyProperty& property = element.properties[k];
            if (property.is_list() || !is_attribute_name(property.name)) continue;
            columns.push_back(k);
            graph_.attributes.push_back({property.name, {}});
        }
        if (element.count > kMaxVertices) {
            throw Unsupported(
                fmt::format("{}: {} vertices are more than a skeleton can have", source_, element.count));
        }
        graph_.position.reserve(element.count);
        PlyRow row;
        for (std::uint64_t i = 0; i < element.count; ++i) {
            rows_.read(row);
            graph_.position.push_back({row.scalar(x), row.scalar(y), row.scalar(z)});
            if (has_radii) graph_.radius.push_back(row.scalar(radius));
            for (std::size_t k = 0; k < columns.size(); ++k)
                graph_.attributes[k].values.push_back(row.scalar(columns[k]));
        }
        if (graph_.radius.size() != graph_.position.size()) graph_.radius.clear();
    }

    /// Reads an edge: the vertices are a list, which may be a whole polyline, or two numbers.
    void read_edges(const PlyElement& element) {
        const auto list = element.find({"vertex_indices", "vertex_index"});
        const auto from = element.find({"vertex1"}), to = element.find({"vertex2"});
        const bool has_list = list && element.properties[*list].is_list();
        const bool has_ends =
            from && to && !element.properties[*from].is_list() && !element.properties[*to].is_list();
        if (!has_list && !has_ends) {
            throw InvalidInput(fmt::format(
                "{}: the edges have neither a list 'vertex_indices' nor 'vertex1' and 'vertex2'", source_));
        }
        PlyRow row;
        for (std::uint64_t i = 0; i < element.count; ++i) {
            rows_.read(row);
            if (!has_list) {
                graph_.edges.push_back({index(row.scalar(*from)), index(row.scalar(*to))});
                continue;
            }
            const auto ends = row.list(*list);
            for (std::size_t k = 1; k < ends.size(); ++k)
                graph_.edges.push_back({index(ends[k - 1]), index(ends[k])});
        }
    }

    std::uint32_t index(double value) const {
        if (!(value >= 0) || value >= kMaxVertices || value != std::trunc(value)) {
            throw InvalidInput(
                fmt::format("{}: an edge refers to vertex {}, which cannot exist", source_, value));
        }
        return static_cast<std::uint32_t>(value);
    }

    /// The edges may precede the vertices, so indices are checked at the end.
    void check_indices() const {
        for (const auto& edge : graph_.edges) {
            for (const std::uint32_t v : edge) {
                if (v >= graph_.position.size()) {
                    throw InvalidInput(
                        fmt::format("{}: an edge refers to vertex {}, but there are only {}, numbered from 0",
                                    source_, v, graph_.position.size()));
                }
            }
        }
    }

    static constexpr std::uint32_t kMaxVertices = 0xfffffff0u;

    const std::string& source_;
    PlyHeader header_;
    PlyRows rows_;
    EdgeGraph graph_;
    bool own_ = false;
};

}  // namespace

EdgeGraph parse_edge_ply(std::string_view file, const std::string& source, const Context& ctx) {
    return EdgePlyParser(file, source, ctx).parse();
}

}  // namespace coppice
