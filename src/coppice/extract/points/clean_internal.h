#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/extract/points/neighbours_internal.h"

namespace coppice::extract_internal {

/// A point and the voxel that it lies in; voxels are numbered along the Morton curve.
struct MortonPlace {
    std::uint64_t key;
    std::uint32_t index;
};

/// The points in the order of their voxels of this edge [m], those of one voxel in their own order. Of edges
/// too short for the extent of the points the least that will do. O(n).
Buffer<MortonPlace> morton_order(std::span<const Vec3> points, double edge, const Context& ctx);

/// Orders points along a Morton curve, so that neighbours in space are near in memory, and drops those at
/// the place of another one. O(n log n).
Buffer<Vec3> sorted_without_duplicates(std::span<const Vec3> points, const Context& ctx);

/// Voxel downsampling: one point, the mean, for all points in a voxel of this edge [m] > 0. O(n).
Buffer<Vec3> voxel_downsample(std::span<const Vec3> points, double edge, const Context& ctx);

/// Downsamples with ever larger voxels until at most `limit` > 0 points are left.
Buffer<Vec3> downsample_to(Buffer<Vec3> points, std::size_t limit, const Context& ctx);

/// Marks outliers, points that lie far from everything: their mean distance to the six nearest is more than
/// `factor` times what is usual about those, so that a density that falls with distance is no reason.
std::vector<std::uint8_t> find_outliers(const Neighbours& neighbours, double factor, const Context& ctx);

}  // namespace coppice::extract_internal
