#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/skeleton/raw.h"

namespace coppice {

/// Assigns parents by position to cylinders without parents. `tree` contains the tree number of each
/// cylinder, or is empty for a single tree; trees are not joined. Links from the start of a cylinder to the
/// end or the side of another one are added in order of increasing cost, skipping those that close a cycle;
/// the cost is the distance, multiplied by the ratio of the radii if the parent is thinner. A cylinder
/// remains a root if every distance exceeds the longer of both lengths plus both radii. O(n log n). Throws
/// Cancelled.
void join_by_place(std::vector<RawCylinder>& cylinders, std::span<const std::uint32_t> tree,
                   const Context& ctx);

/// For cylinders with their end nodes as ids and their start nodes as parents: reverses all of them if they
/// run from their node to that of their parent; if all roots begin at the same node, the thickest of them
/// becomes the parent of the others. O(n log n).
void direct_from_base(std::vector<RawCylinder>& cylinders);

/// Replaces ids that are unique within each tree by globally unique ones; `tree` contains the tree number of
/// each cylinder. Throws InvalidInput for an id that occurs twice in a tree. O(n log n).
void number_across_trees(std::vector<RawCylinder>& cylinders, std::span<const std::uint32_t> tree,
                         const std::string& source);

/// Numbers the cylinders of each tree from 1; keeps the numbers of all if a parent exceeds the size of its
/// tree. O(n).
void count_within_trees(std::vector<RawCylinder>& cylinders, std::span<const std::uint32_t> tree);

}  // namespace coppice
