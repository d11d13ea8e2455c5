#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/extract/points/neighbours_internal.h"

namespace coppice::extract_internal {

/// Number of neighbours over which normals are averaged in each pass; rows may contain more.
inline constexpr std::uint32_t kDispersionNeighbours = 12;

/// Variation of the normals about each point: the smallest eigenvalue of the mean of n n^T over a
/// neighbourhood of about six spacings. 0 on planes, and on cylinders and cones of any thickness, which have
/// nearly coplanar normals; up to 1/3 for normals of all directions, as among leaves.
struct NormalDispersion {
    Buffer<float> value;                 ///< per point, in [0, 1/3]
    double spacing = 0;                  ///< [m] median distance to the fourth neighbour
    double share = 0;                    ///< share of the points with values above 0.15
    float threshold = 0;                 ///< optimal threshold between two classes of values [Otsu1979]
    double low_mean = 0, high_mean = 0;  ///< means of the values on both sides of the threshold
};

/// Computes the dispersion. Requires at least two points, with their rows. O(n), about 60 bytes of additional
/// memory per point. Throws Cancelled.
NormalDispersion normal_dispersion(std::span<const Vec3> points, const Neighbours& near, const Context& ctx);

/// Points at a coarser scale: the non-empty voxels.
struct VoxelGrid {
    Buffer<Vec3> centroid;                ///< [m] mean of the points of each voxel
    std::vector<std::uint32_t> of_point;  ///< voxel of every point
};

/// Creates voxels of this edge [m] > 0, in the order of their first points. O(n).
VoxelGrid voxel_grid(std::span<const Vec3> points, double edge, const Context& ctx);

}  // namespace coppice::extract_internal
