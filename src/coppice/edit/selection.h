#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/edit/editable_tree.h"
#include "coppice/implicit/solid/solid.h"

namespace coppice {

/// What a selection asks of a node.
enum class SelectionKind {
    all,       ///< nothing
    roots,     ///< no parent
    tips,      ///< no children
    forks,     ///< two children or more
    id,        ///< one of these ids
    subtree,   ///< one of these, or hanging on one
    axis,      ///< on the axis of one of these: where a branch forks, its axis goes on with the leader
    path,      ///< on the way from the root to one of these
    children,  ///< child of one of these
    tree,      ///< of the same tree as one of these
    order,     ///< order from a to b: a root's axis has 0, what leaves an axis one more
    radius,    ///< [m] radius from a to b
    height,    ///< [m] z from a to b, in world space
    box,       ///< within a box in world space: x, y, z of one corner and of the other
    solid,     ///< within the solid of that name
    near,      ///< the node nearest to x, y, z in world space
    at,        ///< the node that is like what the numbers say, as bind_anchor finds it
    both,      ///< in both parts
    either,    ///< in one of the parts
    without,   ///< not in the part
};

/// A question that nodes are chosen by, as people type it: "subtree(12) & radius(0, 0.01) & !solid(crown)".
struct Selection {
    SelectionKind kind = SelectionKind::all;  ///< what is asked
    std::vector<StableId> ids;                ///< of id to tree; at least one where there are no parts
    std::vector<double> numbers;              ///< of order to at
    std::string name;                         ///< of solid
    std::vector<Selection> parts;             ///< of both and either two, of without one, of subtree to tree
                                              ///< one or, with ids, none

    friend bool operator==(const Selection&, const Selection&) = default;  ///< as they are written
};

/// Reads a selection: a number or NAME(...), joined by & or `and`, | or `or`, ! or `not`, with parentheses; &
/// binds closer than |. Ids are joined by commas, 5-9 stands for five of them; in subtree() to tree() a
/// selection may stand instead. Ranges are a,b or one number alone for `order`; an end may be left out.
/// Throws InvalidInput naming what is not understood. At most 64 parentheses deep.
///
/// at(x,y,z,order,radius[,along,length[,within[,id]]]) is a node by where it lies in world space [m], the
/// order and radius [m] of its axis, the share of the axis before it, the length of the axis [m], the
/// distance within which it has to lie [m] (at most 3 % of the extent of the tree, and that unless said
/// otherwise), and its id, which decides only between nodes that are else the same.
Selection parse_selection(std::string_view text);

/// The text that reads as the same selection.
std::string to_text(const Selection& selection);

/// Calls visit(id) for every id that a selection names; visit may change it.
void for_each_id(Selection& selection, const std::function<void(StableId&)>& visit);

/// The solids that selections may name; none where there is none of the name.
using SolidLookup = std::function<const Solid*(const std::string&)>;

/// The nodes that a selection holds, perhaps none. Throws InvalidInput for ids that are not there, for solids
/// that are not, and where at() has no node that is like enough, or two: it names the nearest. By id,
/// subtree, axis and path it costs what it finds, else O(n).
NodeSet selected(const EditableTree& tree, const Selection& selection, const SolidLookup& solids = {});

/// The one node that a selection holds. Throws InvalidInput where it holds none or several.
StableId selected_node(const EditableTree& tree, const Selection& selection, const SolidLookup& solids = {});

/// Throws InvalidInput where there is no such node.
void check_node(const EditableTree& tree, StableId n);

/// The nodes of the axis that a node is on, from the first behind its host to its tip. O(axis).
std::vector<StableId> axis_of(const EditableTree& tree, StableId n);

/// How many axes the way from the root to a node leaves. O(depth).
int order_of(const EditableTree& tree, StableId n);

/// The node nearest to a place; there must be one. O(n).
StableId nearest_node(const EditableTree& tree, Vec3d world);

}  // namespace coppice
