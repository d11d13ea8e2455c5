#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/skeleton/raw.h"

namespace coppice {

/// Parsers of the format families: they return raw nodes or cylinders without repair. All throw InvalidInput
/// "source:line: ..." if the text is not of the format, and Cancelled, are not recursive, and use memory
/// proportional to the text.

/// Additional numbers of nodes, or vertices, of the file.
struct RawAttribute {
    std::string name;            ///< see is_attribute_name()
    std::vector<double> values;  ///< one for each, in their order
};

struct RawSkeleton {
    std::vector<RawNode> nodes;
    std::vector<RawAttribute> attributes;
    std::vector<std::string> notes;  ///< see SkeletonFile::notes
};

/// Parses SWC. The types of the nodes are an attribute unless all are 0.
RawSkeleton parse_swc(std::string_view text, const std::string& source, const Context& ctx = {});
inline constexpr std::string_view kSwcType = "type";
/// Attribute with the ids of the nodes in SWC, and the maximum id that it represents exactly.
inline constexpr std::string_view kSwcId = "id";
inline constexpr std::uint32_t kMaxSwcId = std::uint32_t{1} << 24;

/// Attributes with the order and the number of the axis of a node, and the number of its tree.
inline constexpr std::string_view kOrderOfNode = "order";
inline constexpr std::string_view kAxisOfNode = "axis";
inline constexpr std::string_view kTreeOfNode = "tree";

struct RawCylinders {
    std::vector<RawCylinder> cylinders;
    std::vector<RawAttribute> attributes;  ///< by cylinder
    std::vector<std::string> notes;        ///< see SkeletonFile::notes
    std::size_t models = 1;                ///< number of models in the file
};

/// Parses tables with a header that names the columns, or without one in the order of TreeQSM; skips other
/// lines. Each table is a model: `model` selects one from 1, and 0 the only one. Throws InvalidInput with the
/// number of models if `model` does not select one.
RawCylinders parse_cylinders(std::string_view text, const std::string& source, int model = 0,
                             const Context& ctx = {});
/// Parses the structs of a TreeQSM .mat file likewise.
RawCylinders parse_mat(std::string_view bytes, const std::string& source, int model, const Context& ctx = {});
bool is_cylinder_header(std::string_view line);
/// Returns whether the line is the first one of a table that parse_cylinders() finds after other content.
bool begins_cylinders(std::string_view line);

/// Parses the table of cylinders in the JSON of treegraph; returns nullopt if the text is not such a file.
std::optional<RawCylinders> parse_treegraph(std::string_view text, const std::string& source,
                                            const Context& ctx = {});

std::vector<RawNode> parse_raycloud(std::string_view text, const std::string& source,
                                    const Context& ctx = {});
bool is_raycloud_header(std::string_view line);

/// Sorts the nodes by their attribute `node` if it numbers them from 0, each once, and removes the attribute;
/// otherwise keeps the order. O(n).
void put_in_written_order(RawSkeleton& raw);

/// Parses JSON. Ids of the nodes are their indices.
RawSkeleton parse_skeleton_json(std::string_view text, const std::string& source, const Context& ctx = {});

/// Parses RSML: axes that branch off their parents at any position, also between points; see
/// docs/user/formats.md. Ids of the nodes are their indices.
RawSkeleton parse_rsml(std::string_view text, const std::string& source, const Context& ctx = {});

/// Parses MTG: entities at several scales, positioned by coordinates or otherwise by lengths; see
/// docs/user/formats.md.
RawSkeleton parse_mtg(std::string_view text, const std::string& source, const Context& ctx = {});

/// Vertices joined by edges, as in graph formats.
struct EdgeGraph {
    std::vector<Vec3d> position;
    std::vector<double> radius;  ///< one for each vertex, or empty
    std::vector<std::array<std::uint32_t, 2>> edges;
    std::vector<RawAttribute> attributes;
    bool directed = false;  ///< whether edges run from parent to child
    bool weld = false;      ///< whether vertices at the same position are merged, with the larger radius
    /// whether vertices without edges are ignored; an edge to itself keeps a vertex
    bool drop_isolated = false;
};

EdgeGraph parse_gel(std::string_view text, const std::string& source, const Context& ctx = {});
EdgeGraph parse_obj_lines(std::string_view text, const std::string& source, const Context& ctx = {});
EdgeGraph parse_edge_ply(std::string_view file, const std::string& source, const Context& ctx = {});

/// Comment in graph formats written by Coppice: edges run from parent to child.
inline constexpr std::string_view kDirectedMark = "coppice skeleton: edges run from parent to child";

struct Forest {
    std::vector<RawNode> nodes;
    std::uint32_t loops_cut = 0;  ///< number of edges omitted because they closed a loop
};

/// Assigns a parent to every node. If directed edges form a forest, they are followed; otherwise each
/// connected component is rooted at its thickest end, or at its lowest end without radii, and searched
/// breadth-first, so that loops are cut far from the root. Throws InvalidInput for positions that are not
/// finite. O(n log n).
Forest make_forest(const EdgeGraph& graph, const std::string& source);

}  // namespace coppice
