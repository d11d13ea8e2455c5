#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/extract/points/neighbours_internal.h"

namespace coppice::extract_internal {

/// Point and the key of its voxel; voxels are numbered along the Morton curve.
struct MortonPlace {
    std::uint64_t key;
    std::uint32_t index;
};

/// Returns the points in the order of their voxels of this edge [m]; points of one voxel keep their order.
/// Replaces an edge too short for the extent of the points by the minimum. O(n).
Buffer<MortonPlace> morton_order(std::span<const Vec3> points, double edge, const Context& ctx);

/// Returns whether a is before b in the order by x, then y, then z.
bool comes_before(Vec3 a, Vec3 b);

/// Sorts points along a Morton curve, so that neighbours in space are close in memory, and removes
/// duplicates. O(n log n).
Buffer<Vec3> sorted_without_duplicates(std::span<const Vec3> points, const Context& ctx);

/// Voxel downsampling: replaces all points in a voxel of this edge [m] > 0 by their mean. O(n).
Buffer<Vec3> voxel_downsample(std::span<const Vec3> points, double edge, const Context& ctx);

/// Downsamples with increasing voxels until at most `limit` > 0 points are left.
Buffer<Vec3> downsample_to(Buffer<Vec3> points, std::size_t limit, const Context& ctx);

/// Marks outliers: points with a mean distance to their six closest points of more than `factor` times the
/// median of the same value at those points, so that a density that decreases with distance does not produce
/// outliers.
std::vector<std::uint8_t> find_outliers(const Neighbours& neighbours, double factor, const Context& ctx);

}  // namespace coppice::extract_internal
