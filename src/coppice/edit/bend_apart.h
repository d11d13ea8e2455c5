#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/edit/editable_tree.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// How trees that run through each other are bent apart.
struct BendApartOptions {
    float gap = 0.2f;  ///< [sum of radii] room left between barks; in [0, 10]
    int rounds = 60;   ///< times at most that contacts are looked for; in [1, 10000]
};

template <class Self, class Visitor>
requires SameOptions<Self, BendApartOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"gap", "room left between the barks of two trees, in sums of their radii", Unit::none, 0, 10},
          o.gap);
    visit(Field{"rounds", "times at most that contacts are looked for", Unit::none, 1, 10'000}, o.rounds);
}

/// What bending apart did.
struct BendApartReport {
    std::uint32_t before = 0;  ///< pairs of segments of two trees whose wood overlapped
    std::uint32_t after = 0;   ///< pairs whose wood still does: roots stand within it, or there is no room
    std::uint32_t moved = 0;   ///< nodes that moved
    float farthest = 0;        ///< [m] the longest way that one moved
    int rounds = 0;            ///< times that contacts were looked for
};

/// A forest whose trees stand clear of each other.
struct BendApartResult {
    Skeleton skeleton;       ///< the same nodes, parents, radii and ids
    BendApartReport report;  ///< what was done
};

/// Bends the branches of different trees apart where their wood overlaps, so that each tree keeps all of its
/// wood and none of the others'. Roots stay. Of two branches that meet the one that gives way more easily
/// moves more: as axes bend under a load, by length over the square of the radius, summed from the root; a
/// trunk hardly moves for a twig. The way to the place of contact bends evenly by the same measure, and what
/// hangs on it beyond goes along and keeps its shape. No node moves by more than half its way from the root,
/// so that some wood may overlap in the end, as where a root stands in another trunk.
///
/// Contacts within a tree are left alone, and trees that lie apart do not move. Deterministic
/// for any number of threads. O(n log n) a round, and as much as there is that overlaps. Throws InvalidInput
/// where an option is out of range; Cancelled.
BendApartResult bend_apart(const Skeleton& forest, const BendApartOptions& options = {},
                           const Context& ctx = {});

/// The same as an edit, of which only branches give way that hang on the selected nodes. Throws InvalidInput
/// also where nothing is selected.
EditChange bend_apart(EditableTree& tree, const NodeSet& nodes, const BendApartOptions& options = {},
                      const Context& ctx = {});

}  // namespace coppice
