#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <memory>
#include <ranges>
#include <type_traits>
#include <utility>
#include <vector>

#include "coppice/base/error.h"

namespace coppice {

/// Moves the numbers for which `goes_first` is true to the front; returns the end of them. Has no branches,
/// which random numbers would make unpredictable.
template <class T, class Predicate>
T* partition_numbers(T* first, T* last, const Predicate& goes_first) {
    T* middle = first;
    for (T* i = first; i != last; ++i) {
        const T value = std::exchange(*i, *middle);
        *middle = value;
        middle += goes_first(value);
    }
    return middle;
}

/// Has the result of `std::nth_element` for numbers, in half of the time. O(n).
template <class T>
void select_number(T* first, T* nth, T* last) {
    constexpr int kMaxRounds = 40;  // with unlucky pivots, the rest is left to the standard library
    constexpr std::ptrdiff_t kSmall = 8;
    for (int round = 0; round < kMaxRounds && last - first > kSmall; ++round) {
        const T a = *first, b = first[(last - first) / 2], c = last[-1];
        const T pivot = std::max(std::min(a, b), std::min(std::max(a, b), c));
        T* const equal = partition_numbers(first, last, [&](T value) { return value < pivot; });
        if (nth < equal) {
            last = equal;
            continue;
        }
        first = partition_numbers(equal, last, [&](T value) { return !(pivot < value); });
        if (nth < first) return;
    }
    std::nth_element(first, nth, last);
}

/// Returns the median of at least one value: of an even number the upper one of the two middle values.
/// Reorders the values. O(n).
template <std::ranges::random_access_range Range>
std::ranges::range_value_t<Range> median_in_place(Range&& values) {
    COPPICE_ASSERT(!std::ranges::empty(values));
    const auto middle = std::ranges::begin(values) + std::ranges::ssize(values) / 2;
    if constexpr (std::ranges::contiguous_range<Range> &&
                  std::is_arithmetic_v<std::ranges::range_value_t<Range>>) {
        const auto data = std::to_address(std::ranges::begin(values));
        select_number(data, std::to_address(middle), data + std::ranges::ssize(values));
    } else {
        std::ranges::nth_element(values, middle);
    }
    return *middle;
}

/// The same without reordering the values.
template <std::ranges::forward_range Range>
std::ranges::range_value_t<Range> median(const Range& values) {
    return median_in_place(std::vector(std::ranges::begin(values), std::ranges::end(values)));
}

}  // namespace coppice
