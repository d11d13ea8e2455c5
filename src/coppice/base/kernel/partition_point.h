#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"

namespace coppice::kernel {

/// Returns the number of items at the front that satisfy `is_before`; no item after the first that does not
/// may satisfy it. For kernels, in which std::lower_bound and std::upper_bound are compiled incorrectly:
/// nvcc 13.0 drops the steps of std::advance by a distance that is only known at run time. O(log n).
template <class T, class Test>
COPPICE_HOST_DEVICE std::uint32_t partition_point(std::span<const T> items, const Test& is_before) {
    std::uint32_t begin = 0;
    auto count = static_cast<std::uint32_t>(items.size());
    while (count > 0) {
        const std::uint32_t half = count / 2;
        if (is_before(items[begin + half])) {
            begin += half + 1;
            count -= half + 1;
        } else {
            count = half;
        }
    }
    return begin;
}

}  // namespace coppice::kernel
