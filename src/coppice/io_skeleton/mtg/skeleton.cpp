#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "coppice/base/ascii.h"
#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/io_skeleton/mtg/document_internal.h"
#include "coppice/io_skeleton/mtg/measures_internal.h"
#include "coppice/io_skeleton/node_attribute.h"
#include "coppice/io_skeleton/parsers_internal.h"
#include "coppice/io_skeleton/writers_internal.h"

namespace coppice {

namespace {

using mtg::Document;
using mtg::Measures;
using mtg::Nodes;
using mtg::Vertex;

Nodes find_nodes(const Document& document, const std::string& source, std::vector<std::string>& notes) {
    const Measures measures(document);
    Nodes found;
    if (measures.has_places()) found = nodes_of_places(document, measures);
    if (found.nodes.empty() && measures.has_lengths()) {
        found = nodes_of_lengths(document, measures);
        notes.push_back(
            "the file has lengths and no coordinates: plants were arranged by their lengths, with default "
            "angles of 45 degrees between branches and their parents and 137.5 degrees between successive "
            "branches");
    }
    if (!found.nodes.empty()) return found;
    throw InvalidInput(
        fmt::format("{}: there are no nodes: the plants have neither coordinates (columns XX, YY and ZZ) nor "
                    "lengths (Length), so that their shape is unknown",
                    source));
}

/// Returns the length of the longest path from a root.
double longest_path(const std::vector<Nodes::Node>& nodes) {
    std::vector<double> path(nodes.size(), 0);
    double longest = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const std::uint32_t parent = nodes[i].parent;
        if (parent == kNoIndex) continue;
        path[i] = path[parent] + distance(nodes[i].position, nodes[parent].position);
        longest = std::max(longest, path[i]);
    }
    return longest;
}

/// Returns the divisor of the diameters: MTG files often use a finer unit for them than for lengths, without
/// stating it. If a stem is thicker than an eighth of the longest path, the divisor is the power of ten for
/// which that path is about fifty diameters long.
double diameter_divisor(const Document& document, const std::vector<Nodes::Node>& nodes) {
    constexpr double kStoutest = 8, kUsual = 50;
    if (!Measures(document).has_diameters()) return 1;
    double largest = 0;
    for (const Nodes::Node& n : nodes) largest = std::max(largest, std::isnan(n.radius) ? 0 : 2 * n.radius);
    const double ratio = longest_path(nodes) / largest;
    if (!(ratio > 0) || ratio >= kStoutest) return 1;
    return std::pow(10, std::max(1.0, std::round(std::log10(kUsual / ratio))));
}

/// Returns the name of a column in lower case with _ for -, blanks and dots.
std::string attribute_name(const std::string& column) {
    std::string name = to_lower(column);
    std::ranges::replace_if(
        name, [](char c) { return c == '-' || c == ' ' || c == '.'; }, '_');
    return name;
}

/// Returns the numeric columns that all nodes have, except positions and thickness.
std::vector<RawAttribute> collect_attributes(const Document& document,
                                             const std::vector<Nodes::Node>& nodes) {
    constexpr std::array<std::string_view, 6> kKnown{"xx", "yy", "zz", "topdia", "diameter", "diam"};

    std::vector<std::uint32_t> node(document.vertices.size(), kNoIndex);
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        if (nodes[i].is_measured) node[nodes[i].vertex] = i;
    }
    std::vector<std::size_t> count(document.columns.size(), 0);
    for (const mtg::Value& v : document.values) {
        if (node[v.vertex] != kNoIndex) ++count[v.column];
    }
    std::vector<RawAttribute> attributes;
    std::map<std::uint32_t, std::size_t> place;  // by column
    for (std::uint32_t c = 0; c < count.size(); ++c) {
        const std::string name = attribute_name(document.columns[c].name);
        if (count[c] != nodes.size() || !is_attribute_name(name) || std::ranges::count(kKnown, name) > 0)
            continue;
        place[c] = attributes.size();
        attributes.push_back({name, std::vector<double>(nodes.size())});
    }
    for (const mtg::Value& v : document.values) {
        const auto at = place.find(v.column);
        if (at != place.end() && node[v.vertex] != kNoIndex)
            attributes[at->second].values[node[v.vertex]] = v.value;
    }
    return attributes;
}

/// Adds the number of branchings before each node, and the number of its axis, from 0.
void add_orders(const Document& document, const std::vector<Nodes::Node>& nodes, RawSkeleton& raw) {
    std::vector<double> order(document.vertices.size(), 0), axis(document.vertices.size(), 0);
    double axes = 0;
    for (std::size_t v = 1; v < document.vertices.size(); ++v) {
        const Vertex& vertex = document.vertices[v];
        const bool branches = vertex.edge == '+';
        order[v] = order[vertex.before] + (branches ? 1 : 0);
        axis[v] = branches || vertex.before == 0 ? axes++ : axis[vertex.before];
    }
    RawAttribute orders{std::string(kOrderOfNode), {}}, axis_numbers{std::string(kAxisOfNode), {}};
    for (const Nodes::Node& n : nodes) {
        orders.values.push_back(order[n.vertex]);
        axis_numbers.values.push_back(axis[n.vertex]);
    }
    raw.attributes.push_back(std::move(orders));
    raw.attributes.push_back(std::move(axis_numbers));
}

}  // namespace

RawSkeleton parse_mtg(std::string_view text, const std::string& source, const Context& ctx) {
    const Document document = mtg::parse_document(text, source, ctx);
    RawSkeleton raw;
    const std::vector<Nodes::Node> nodes = find_nodes(document, source, raw.notes).nodes;
    const double divisor = diameter_divisor(document, nodes);
    std::size_t placed = 0;
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        const Nodes::Node& n = nodes[i];
        if (!n.is_measured) ++placed;
        raw.nodes.push_back({i, n.parent == kNoIndex ? -1 : std::int64_t{n.parent}, n.position,
                             n.radius / divisor, document.vertices[n.vertex].line});
    }
    if (!text.starts_with(kMtgMark)) {
        raw.notes.emplace_back(
            "MTG specifies no unit: lengths were assumed to be in metres; set scale for another unit");
    }
    if (divisor > 1) {
        raw.notes.push_back(fmt::format(
            "the diameters would make stems thicker than an eighth of the plant: they were divided by {}",
            divisor));
    }
    if (document.is_form_b) raw.notes.emplace_back("the file states FORM-B, but was read as FORM-A");
    raw.attributes = collect_attributes(document, nodes);
    add_orders(document, nodes, raw);
    put_in_written_order(raw);
    return raw;
}

}  // namespace coppice
