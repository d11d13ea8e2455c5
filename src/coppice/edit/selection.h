#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/edit/editable_tree.h"
#include "coppice/implicit/solid/solid.h"

namespace coppice {

/// Condition of a selection on a node.
enum class SelectionKind {
    all,       ///< no condition
    roots,     ///< no parent
    tips,      ///< no children
    forks,     ///< at least two children
    id,        ///< one of these ids
    subtree,   ///< one of these nodes or a descendant of one
    axis,      ///< on the axis of one of these nodes; at a fork the axis continues with the leader
    path,      ///< on the path from the root to one of these nodes
    children,  ///< child of one of these nodes
    tree,      ///< in the same tree as one of these nodes
    order,     ///< order from a to b: 0 for the axis of a root, one more for each lateral axis
    radius,    ///< [m] radius from a to b
    height,    ///< [m] z from a to b, in world space
    box,       ///< inside a box in world space: x, y, z of two opposite corners
    solid,     ///< inside the solid of that name
    near,      ///< the node closest to x, y, z in world space
    at,        ///< the node described by the numbers, as found by bind_anchor
    both,      ///< in both operands
    either,    ///< in one of the operands
    without,   ///< not in the operand
};

/// A query that selects nodes, as users enter it: "subtree(12) & radius(0, 0.01) & !solid(crown)".
struct Selection {
    SelectionKind kind = SelectionKind::all;  ///< condition
    std::vector<StableId> ids;     ///< for kinds from id to tree; at least one if there are no parts
    std::vector<double> numbers;   ///< for kinds from order to at
    std::string name;              ///< for solid
    std::vector<Selection> parts;  ///< operands: two for both and either, one for without, one for kinds from
                                   ///< subtree to tree unless they have ids

    friend bool operator==(const Selection&, const Selection&) = default;  ///< same structure and values
};

/// Parses a selection: a number or NAME(...), joined by & or `and`, | or `or`, ! or `not`, with parentheses;
/// & has higher precedence than |. Ids are separated by commas, and 5-9 denotes five of them; the arguments
/// of subtree() to tree() may also be a selection. Ranges are a,b or a single number for `order`; an end may
/// be omitted. Throws InvalidInput naming the text that cannot be parsed. At most 64 nested parentheses.
///
/// at(x,y,z,order,radius[,along,length[,within[,id]]]) is a node described by its position in world space
/// [m], the order and radius [m] of its axis, the fraction of the axis before it, the length of the axis [m],
/// the maximum distance from the position [m] (at most 3 % of the extent of the tree, which is the default),
/// and its id, which only distinguishes nodes that are otherwise equal.
Selection parse_selection(std::string_view text);

/// Returns the text that parses to the same selection.
std::string to_text(const Selection& selection);

/// Calls visit(id) for every id in a selection; visit may change it.
void for_each_id(Selection& selection, const std::function<void(StableId&)>& visit);

/// Returns the solid of a name that a selection may use; nullptr if there is no such solid.
using SolidLookup = std::function<const Solid*(const std::string&)>;

/// Returns the nodes that match a selection; may be empty. Throws InvalidInput for unknown ids and solids,
/// and if no node or two nodes match at(), naming the closest. For id, subtree, axis and path the cost is
/// proportional to the result, otherwise O(n).
NodeSet selected(const EditableTree& tree, const Selection& selection, const SolidLookup& solids = {});

/// Returns the single node that matches a selection. Throws InvalidInput if none or several match.
StableId selected_node(const EditableTree& tree, const Selection& selection, const SolidLookup& solids = {});

/// Throws InvalidInput if the node does not exist.
void check_node(const EditableTree& tree, StableId n);

/// Returns the nodes of the axis of a node, from the first node after the joint to the tip. O(axis).
std::vector<StableId> find_axis(const EditableTree& tree, StableId n);

/// Returns the number of axes that the path from the root to a node leaves. O(depth).
int compute_order(const EditableTree& tree, StableId n);

/// Returns the node closest to a position; there must be one. O(n).
StableId nearest_node(const EditableTree& tree, Vec3d world);

}  // namespace coppice
