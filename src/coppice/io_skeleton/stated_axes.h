#pragma once

#include <cstdint>
#include <vector>

#include "coppice/io_skeleton/reader.h"
#include "coppice/skeleton/architecture.h"

namespace coppice {

/// Order and axis of each node, as required by branch_orders() and list_branches().
struct NodeAxes {
    std::vector<std::uint32_t> order;  ///< from 0
    std::vector<std::uint32_t> axis;   ///< a number that changes at the beginning of an axis
};

/// Returns the axes that a skeleton file states: orders by its attribute `order`, relative to the minimum,
/// and axes by its attribute `axis`. If these are not integers, orders reach the number of nodes, or there is
/// no `order`, returns the axes by the radii of branches (see axis_orders()); without `axis`, an axis begins
/// where the order differs from that of the parent. O(n).
NodeAxes find_axes(const SkeletonFile& file);

}  // namespace coppice
