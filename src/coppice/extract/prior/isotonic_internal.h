#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace coppice::extract_internal {

/// The values nearest to `value`, by least squares with these weights > 0, that do not grow from a parent to
/// its children. Parents precede their children; roots have kNoParent of `DraftTree`. Blocks of nodes that
/// would grow share their mean, joined from the tips down [Pardalos1999]. O(n log n).
std::vector<double> isotonic_on_tree(std::span<const std::uint32_t> parent, std::span<const double> value,
                                     std::span<const double> weight);

}  // namespace coppice::extract_internal
