#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/edit/editable_tree.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Options of bend_apart.
struct BendApartOptions {
    float gap = 0.2f;  ///< [sum of radii] minimum gap between the surfaces of two branches; in [0, 10]
    int rounds = 60;   ///< maximum number of rounds that find and resolve contacts; in [1, 10000]
};

/// Lists the members for front ends.
void list_fields(BendApartOptions& o, FieldList& list);

/// Counts of overlaps and moved nodes.
struct BendApartReport {
    std::uint32_t before = 0;  ///< pairs of overlapping segments of different trees in the input
    std::uint32_t after = 0;   ///< pairs that still overlap: a root is inside a branch, or there is no room
    std::uint32_t moved = 0;   ///< nodes that moved
    float farthest = 0;        ///< [m] maximum displacement of a node
    int rounds = 0;            ///< number of rounds
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const BendApartReport& r, Visitor&& visit) {
    visit("overlaps_before", r.before);
    visit("overlaps_after", r.after);
    visit("nodes_moved", r.moved);
    visit("farthest", r.farthest);
    visit("rounds", r.rounds);
}

/// A forest with separated trees.
struct BendApartResult {
    Skeleton skeleton;       ///< same nodes, parents, radii and ids as the input
    BendApartReport report;  ///< counts of overlaps and moved nodes
};

/// Bends overlapping branches of different trees apart. Roots do not move. Of two branches in contact, the
/// more compliant one moves more: the compliance of an axis is the sum of length over squared radius from the
/// root, so that a trunk hardly moves for a twig. The path from the root to the contact bends evenly by the
/// same measure, and all branches beyond it follow and keep their shape. No node moves by more than half its
/// path length from the root, so that some overlaps may remain, for example where a root is inside another
/// trunk.
///
/// Contacts within a tree are ignored, and trees without contacts do not move. The result does not depend on
/// the number of threads. O(n log n) per round, plus the number of overlaps. Throws InvalidInput if an option
/// is out of range; Cancelled.
BendApartResult bend_apart(const Skeleton& forest, const BendApartOptions& options = {},
                           const Context& ctx = {});

/// The same as an edit that moves only the selected nodes and their descendants. Also throws InvalidInput if
/// the selection is empty.
EditChange bend_apart(EditableTree& tree, const NodeSet& nodes, const BendApartOptions& options = {},
                      const Context& ctx = {});

}  // namespace coppice
