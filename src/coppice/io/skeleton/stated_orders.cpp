#include "coppice/io/skeleton/stated_orders.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "coppice/io/skeleton/parsers_internal.h"

namespace coppice {

namespace {

/// Counted from the least of them; none where they are not whole, or too great to be exact.
std::vector<std::uint32_t> ranks_of(std::span<const float> values) {
    constexpr float kMostExact = 1 << 24;
    const auto is_exact = [](float v) { return std::abs(v) <= kMostExact && v == std::trunc(v); };
    if (values.empty() || !std::ranges::all_of(values, is_exact)) return {};
    const float least = std::ranges::min(values);
    std::vector<std::uint32_t> out;
    out.reserve(values.size());
    for (const float v : values) out.push_back(static_cast<std::uint32_t>(v - least));
    return out;
}

}  // namespace

std::vector<BranchOrder> branch_orders(const SkeletonFile& file) {
    const Skeleton& s = file.skeleton;
    const std::vector<std::uint32_t> order = ranks_of(file.attribute(kOrderOfNode));
    if (order.empty() || std::ranges::max(order) >= s.size()) return branch_orders(s);
    const std::vector<std::uint32_t> axis = ranks_of(file.attribute(kAxisOfNode));
    return branch_orders(s, order, axis.empty() ? order : axis);
}

}  // namespace coppice
