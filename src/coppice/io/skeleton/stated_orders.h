#pragma once

#include <vector>

#include "coppice/io/skeleton/reader.h"
#include "coppice/skeleton/architecture.h"

namespace coppice {

/// What there is of each order of branches in a skeleton file: of the orders in its attribute `order`,
/// counted from the least, whose axes are numbered by its attribute `axis`. Where these are no whole numbers,
/// or orders as many as nodes, or there is no `order`, of those that the thickness of branches tells (see
/// axis_orders()); without `axis` an axis begins where the order differs from that of the parent. O(n).
std::vector<BranchOrder> branch_orders(const SkeletonFile& file);

}  // namespace coppice
