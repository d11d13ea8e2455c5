#include "coppice/io_skeleton/stated_axes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "coppice/io_skeleton/parsers_internal.h"

namespace coppice {

namespace {

/// Returns the numbers relative to their minimum; nullopt if they are not integers, or too large to be exact.
std::vector<std::uint32_t> compute_ranks(std::span<const float> values) {
    constexpr float kMaxExact = 1 << 24;
    const auto is_exact = [](float v) { return std::abs(v) <= kMaxExact && v == std::trunc(v); };
    if (values.empty() || !std::ranges::all_of(values, is_exact)) return {};
    const float least = std::ranges::min(values);
    std::vector<std::uint32_t> out;
    out.reserve(values.size());
    for (const float v : values) out.push_back(static_cast<std::uint32_t>(v - least));
    return out;
}

}  // namespace

NodeAxes find_axes(const SkeletonFile& file) {
    NodeAxes out{compute_ranks(file.attribute(kOrderOfNode)), compute_ranks(file.attribute(kAxisOfNode))};
    if (out.order.empty() || std::ranges::max(out.order) >= file.skeleton.size()) {
        out.order = axis_orders(file.skeleton);
        out.axis = out.order;
    }
    if (out.axis.empty()) out.axis = out.order;
    return out;
}

}  // namespace coppice
