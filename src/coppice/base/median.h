#pragma once

#include <algorithm>
#include <iterator>
#include <ranges>
#include <vector>

#include "coppice/base/error.h"

namespace coppice {

/// Returns the median of at least one value: of an even number the upper one of the two middle values.
/// Reorders the values. O(n).
template <std::ranges::random_access_range Range>
std::ranges::range_value_t<Range> median_in_place(Range&& values) {
    COPPICE_ASSERT(!std::ranges::empty(values));
    const auto middle = std::ranges::begin(values) + std::ranges::ssize(values) / 2;
    std::ranges::nth_element(values, middle);
    return *middle;
}

/// The same without reordering the values.
template <std::ranges::forward_range Range>
std::ranges::range_value_t<Range> median(const Range& values) {
    return median_in_place(std::vector(std::ranges::begin(values), std::ranges::end(values)));
}

}  // namespace coppice
