#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/skeleton/raw.h"

namespace coppice {

/// Gives cylinders without parents the ones whose places fit. `tree` numbers the tree of each, or is empty
/// for one tree; nothing joins two trees. Links are taken from the shortest on, so long as no circle closes:
/// from the start of a cylinder to the end of another or the side of it, and a cylinder counts as farther
/// from one that is thinner, by as much as it is thinner. What is farther from another than both are long,
/// and their radii, stays a root. O(n log n). Throws Cancelled.
void join_by_place(std::vector<RawCylinder>& cylinders, std::span<const std::uint32_t> tree,
                   const Context& ctx);

/// For cylinders whose ids are the nodes that they end in, and whose parents those that they begin in. Turns
/// all of them around where they run from their nodes to those of their parents; and where all roots begin
/// in one node, the thickest of them becomes the parent of the others. O(n log n).
void direct_from_base(std::vector<RawCylinder>& cylinders);

/// Makes ids that are unique within each tree unique among all; `tree` numbers the tree of each. Throws
/// InvalidInput for an id that a tree has twice. O(n log n).
void number_across_trees(std::vector<RawCylinder>& cylinders, std::span<const std::uint32_t> tree,
                         const std::string& source);

/// Numbers the cylinders of each tree from 1, or all of them where a parent is greater than its tree allows.
/// O(n).
void count_within_trees(std::vector<RawCylinder>& cylinders, std::span<const std::uint32_t> tree);

}  // namespace coppice
