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

/// One parser per format family: text in, raw nodes or cylinders out, nothing repaired yet. All throw
/// InvalidInput "source:line: ..." where the text is not of the format, and Cancelled, never recurse, and
/// take memory in proportion to the text.

/// Numbers of nodes, or vertices, that the file has besides.
struct RawAttribute {
    std::string name;            ///< see is_attribute_name()
    std::vector<double> values;  ///< one for each, in their order
};

struct RawSkeleton {
    std::vector<RawNode> nodes;
    std::vector<RawAttribute> attributes;
    std::vector<std::string> notes;  ///< see SkeletonFile::notes
};

/// The types of the nodes are an attribute where one is not 0.
RawSkeleton parse_swc(std::string_view text, const std::string& source, const Context& ctx = {});
inline constexpr std::string_view kSwcType = "type";
/// Attribute with the ids of the nodes in SWC, and the largest one that it holds exactly.
inline constexpr std::string_view kSwcId = "id";
inline constexpr std::uint32_t kMaxSwcId = std::uint32_t{1} << 24;

/// Attributes with the order of the axis that a node lies on, the number of that axis, and that of the tree.
inline constexpr std::string_view kOrderOfNode = "order";
inline constexpr std::string_view kAxisOfNode = "axis";
inline constexpr std::string_view kTreeOfNode = "tree";

struct RawCylinders {
    std::vector<RawCylinder> cylinders;
    std::vector<RawAttribute> attributes;  ///< numbers of cylinders
    std::vector<std::string> notes;        ///< see SkeletonFile::notes
    std::size_t models = 1;                ///< how many the file holds
};

/// Tables with headers naming their columns, or without in TreeQSM's order; other lines are passed over. Each
/// table is a model: number `model`, from 1, is read, and 0 takes the only one. Throws InvalidInput saying
/// how many there are when `model` names none of them.
RawCylinders parse_cylinders(std::string_view text, const std::string& source, int model = 0,
                             const Context& ctx = {});
/// The same of the structs in a TreeQSM .mat file.
RawCylinders parse_mat(std::string_view bytes, const std::string& source, int model, const Context& ctx = {});
bool is_cylinder_header(std::string_view line);
/// Whether it is the first line of a table that parse_cylinders() finds behind others.
bool begins_cylinders(std::string_view line);

/// The table of cylinders in the JSON of treegraph; none where the text is no such file.
std::optional<RawCylinders> parse_treegraph(std::string_view text, const std::string& source,
                                            const Context& ctx = {});

std::vector<RawNode> parse_raycloud(std::string_view text, const std::string& source,
                                    const Context& ctx = {});
bool is_raycloud_header(std::string_view line);

/// Sorts the nodes of a file that numbers them from 0 by an attribute `node`, each once; other files stay as
/// they are. That attribute is taken out. O(n).
void put_in_written_order(RawSkeleton& raw);

/// Ids of the nodes are their indices.
RawSkeleton parse_skeleton_json(std::string_view text, const std::string& source, const Context& ctx = {});

/// Axes that leave their bearers at places of it, between its points too; see docs/user/formats.md. Ids of
/// the nodes are their indices.
RawSkeleton parse_rsml(std::string_view text, const std::string& source, const Context& ctx = {});

/// Entities at several scales, by their coordinates or else by their lengths; see docs/user/formats.md.
RawSkeleton parse_mtg(std::string_view text, const std::string& source, const Context& ctx = {});

/// Vertices joined by edges, as graph formats have them.
struct EdgeGraph {
    std::vector<Vec3d> position;
    std::vector<double> radius;  ///< one for each vertex, or none at all
    std::vector<std::array<std::uint32_t, 2>> edges;
    std::vector<RawAttribute> attributes;
    bool directed = false;       ///< edges are meant to run from parent to child
    bool weld = false;           ///< vertices at the same position are one, of the greater radius
    bool drop_isolated = false;  ///< vertices that no edge names do not count; an edge to itself names one
};

EdgeGraph parse_gel(std::string_view text, const std::string& source, const Context& ctx = {});
EdgeGraph parse_obj_lines(std::string_view text, const std::string& source, const Context& ctx = {});
EdgeGraph parse_edge_ply(std::string_view file, const std::string& source, const Context& ctx = {});

/// Comment by which the writers of graph formats say that edges run from parent to child.
inline constexpr std::string_view kDirectedMark = "coppice skeleton: edges run from parent to child";

struct Forest {
    std::vector<RawNode> nodes;
    std::uint32_t loops_cut = 0;  ///< edges left out because they closed a loop
};

/// Gives every node a parent. Where directed edges form a forest, they are followed; otherwise each connected
/// part is rooted at its thickest end, or its lowest when there are no radii, and searched by breadth, so
/// that a loop is cut far from the root. Throws InvalidInput for positions that are not finite. O(n log n).
Forest forest_of(const EdgeGraph& graph, const std::string& source);

}  // namespace coppice
