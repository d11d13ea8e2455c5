#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/extract/points/neighbours_internal.h"

namespace coppice::extract_internal {

/// Neighbours over which normals are averaged, each time; rows may hold more.
inline constexpr std::uint32_t kDispersionNeighbours = 12;

/// How much normals differ about each of some points: the least eigenvalue of the mean of n n^T over a
/// neighbourhood of about six spacings. 0 on planes, and on cylinders and cones of any thickness, whose
/// normals all lie in a plane or nearly so; up to 1/3 where they point everywhere, as among leaves.
struct NormalDispersion {
    Buffer<float> value;                 ///< of every point, in [0, 1/3]
    double spacing = 0;                  ///< [m] median distance to the fourth neighbour
    double share = 0;                    ///< of the points, with values above 0.15
    float threshold = 0;                 ///< that divides the values best in two [Otsu1979]
    double low_mean = 0, high_mean = 0;  ///< means of the values on both sides of it
};

/// At least two points, with their rows. O(n), about 60 bytes per point while it runs. Throws Cancelled.
NormalDispersion normal_dispersion(std::span<const Vec3> points, const Neighbours& near, const Context& ctx);

/// Points at a coarser scale: the voxels that hold any.
struct VoxelGrid {
    Buffer<Vec3> centroid;                ///< [m] of each voxel: the mean of its points
    std::vector<std::uint32_t> of_point;  ///< the voxel of every point
};

/// Voxels of this edge [m] > 0, in the order of their first points. O(n).
VoxelGrid voxel_grid(std::span<const Vec3> points, double edge, const Context& ctx);

}  // namespace coppice::extract_internal
