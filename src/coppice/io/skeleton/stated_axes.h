#pragma once

#include <cstdint>
#include <vector>

#include "coppice/io/skeleton/reader.h"
#include "coppice/skeleton/architecture.h"

namespace coppice {

/// The order and the axis of each node, as branch_orders() and list_branches() take them.
struct NodeAxes {
    std::vector<std::uint32_t> order;  ///< from 0
    std::vector<std::uint32_t> axis;   ///< a number that differs where an axis begins
};

/// The axes that a skeleton file states: orders by its attribute `order`, counted from the least, axes
/// numbered by its attribute `axis`. Where these are no whole numbers, or orders as many as nodes, or there
/// is no `order`, the axes that the thickness of branches tells (see axis_orders()); without `axis` an axis
/// begins where the order differs from that of the parent. O(n).
NodeAxes axes_of(const SkeletonFile& file);

}  // namespace coppice
