#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "coppice/base/box.h"
#include "coppice/base/kernel/host_device.h"
#include "coppice/base/kernel/morton.h"

namespace coppice {

/// Number of bits per axis of the code that sorts the boxes of a BoxTree.
inline constexpr int kBoxCodeBits = 14;

/// Grid of the cells numbered by that code.
struct BoxGrid {
    Vec3d low;         ///< [m] minimum corner of all boxes
    double scale = 0;  ///< [1/m] cells per metre
};

/// Returns the grid of boxes inside `all`. Boxes without extent share one cell.
COPPICE_HOST_DEVICE inline BoxGrid box_grid(const Box3& all) {
    const Vec3d low(all.low), size = Vec3d(all.high) - low;
    const double extent = std::max(std::max(size.x, size.y), std::max(size.z, 1e-300));
    return {low, ((1 << kBoxCodeBits) - 1) / extent};
}

/// Returns the position of the centre of a box along the Morton curve.
COPPICE_HOST_DEVICE inline std::uint64_t box_code(const BoxGrid& grid, const Box3& box) {
    const Vec3d center = (Vec3d(box.low) + Vec3d(box.high)) * 0.5;
    const Vec3d cell = (center - grid.low) * grid.scale;
    const auto at = [&](int axis) { return static_cast<std::uint64_t>(cell[axis]); };
    return morton_code(at(0), at(1), at(2));
}

/// Eight boxes stored by coordinate, for a simultaneous test against one more box.
struct alignas(16) BoxGroup {
    static constexpr std::uint32_t kWidth = 8;      ///< number of boxes
    std::array<std::array<float, kWidth>, 3> low;   ///< [m] by axis and box
    std::array<std::array<float, kWidth>, 3> high;  ///< [m] by axis and box

    /// Stores box i; an empty box overlaps no other.
    COPPICE_HOST_DEVICE void set(std::uint32_t i, const Box3& box) {
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
            low[axis][i] = box.low[static_cast<int>(axis)];
            high[axis][i] = box.high[static_cast<int>(axis)];
        }
    }
    /// Returns box i.
    COPPICE_HOST_DEVICE Box3 box(std::uint32_t i) const {
        return {{low[0][i], low[1][i], low[2][i]}, {high[0][i], high[1][i], high[2][i]}};
    }
    /// Returns the bounding box of all eight.
    COPPICE_HOST_DEVICE Box3 bounds() const {
        Box3 all;
        for (std::uint32_t i = 0; i < kWidth; ++i) all.extend(box(i));
        return all;
    }
    /// Returns a mask: bit i is set if box i overlaps b; touching boxes overlap.
    COPPICE_HOST_DEVICE std::uint32_t overlapping(const Box3& b) const {
        std::array<std::uint32_t, kWidth> hit;
        for (std::uint32_t i = 0; i < kWidth; ++i) {
            hit[i] = std::uint32_t{low[0][i] <= b.high.x} & std::uint32_t{b.low.x <= high[0][i]} &
                     std::uint32_t{low[1][i] <= b.high.y} & std::uint32_t{b.low.y <= high[1][i]} &
                     std::uint32_t{low[2][i] <= b.high.z} & std::uint32_t{b.low.z <= high[2][i]};
        }
        std::uint32_t bits = 0;
        for (std::uint32_t i = 0; i < kWidth; ++i) bits |= hit[i] << i;
        return bits;
    }
};

}  // namespace coppice
