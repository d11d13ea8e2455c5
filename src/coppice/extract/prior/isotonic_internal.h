#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/id.h"

namespace coppice::extract_internal {

/// Returns the weighted least-squares fit to `value`, with weights > 0, that does not increase from a parent
/// to its children. Parents precede their children; the parent of a root is kNoIndex of `InitialTree`.
/// Blocks of nodes that violate the order get their mean; they are merged from the tips down [Pardalos1999].
/// O(n log n).
std::vector<double> isotonic_on_tree(std::span<const std::uint32_t> parent, std::span<const double> value,
                                     std::span<const double> weight);

}  // namespace coppice::extract_internal
