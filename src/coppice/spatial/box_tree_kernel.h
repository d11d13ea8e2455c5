#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "coppice/base/box.h"
#include "coppice/base/kernel/host_device.h"
#include "coppice/base/kernel/morton.h"

namespace coppice {

/// Bits of the code that puts the boxes of a BoxTree in order, along each axis.
inline constexpr int kBoxCodeBits = 14;

/// The cells between which that code tells boxes apart.
struct BoxGrid {
    Vec3d low;         ///< [m] the least corner of all boxes
    double scale = 0;  ///< [1/m] cells per metre
};

/// The grid of boxes that `all` holds. Boxes without extent share one cell.
COPPICE_HOST_DEVICE inline BoxGrid box_grid(const Box3& all) {
    const Vec3d low(all.low), size = Vec3d(all.high) - low;
    const double extent = std::max(std::max(size.x, size.y), std::max(size.z, 1e-300));
    return {low, ((1 << kBoxCodeBits) - 1) / extent};
}

/// The place of a box's center along the Morton curve.
COPPICE_HOST_DEVICE inline std::uint64_t box_code(const BoxGrid& grid, const Box3& box) {
    const Vec3d center = (Vec3d(box.low) + Vec3d(box.high)) * 0.5;
    const Vec3d cell = (center - grid.low) * grid.scale;
    const auto at = [&](int axis) { return static_cast<std::uint64_t>(cell[axis]); };
    return morton_code(at(0), at(1), at(2));
}

/// Eight boxes by coordinate, so that one more box is tested against all of them at once.
struct alignas(16) BoxGroup {
    static constexpr std::uint32_t kWidth = 8;      ///< boxes
    std::array<std::array<float, kWidth>, 3> low;   ///< [m] by axis and box
    std::array<std::array<float, kWidth>, 3> high;  ///< [m] by axis and box

    /// Puts a box in its place; an empty one overlaps nothing.
    COPPICE_HOST_DEVICE void set(std::uint32_t i, const Box3& box) {
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
            low[axis][i] = box.low[static_cast<int>(axis)];
            high[axis][i] = box.high[static_cast<int>(axis)];
        }
    }
    /// The box in a place.
    COPPICE_HOST_DEVICE Box3 box(std::uint32_t i) const {
        return {{low[0][i], low[1][i], low[2][i]}, {high[0][i], high[1][i], high[2][i]}};
    }
    /// What holds all eight.
    COPPICE_HOST_DEVICE Box3 bounds() const {
        Box3 all;
        for (std::uint32_t i = 0; i < kWidth; ++i) all.extend(box(i));
        return all;
    }
    /// Bit i: box i overlaps; touching counts.
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
