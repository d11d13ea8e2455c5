#pragma once

#include <span>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice::extract_internal {

/// Coordinate system of a cloud that moves and turns about the vertical with the points: results that depend
/// on rasters, voxels or the order of points do not change with the position and the direction of a tree.
/// Heights are not changed.
struct CloudFrame {
    double x = 0, y = 0;          ///< [m] origin, the mean of the points
    double cosine = 1, sine = 0;  ///< of the angle from x of the cloud to x of the frame

    /// Returns a position [m] in the frame.
    Vec3d to_frame(Vec3d p) const {
        const double dx = p.x - x, dy = p.y - y;
        return {cosine * dx + sine * dy, cosine * dy - sine * dx, p.z};
    }
    /// Returns a position [m] of the frame in the cloud.
    Vec3d to_cloud(Vec3d p) const {
        return {x + cosine * p.x - sine * p.y, y + sine * p.x + cosine * p.y, p.z};
    }
};

/// Returns the frame of at least one point: x is the horizontal direction of the largest variance, towards
/// the side where the points are farther out. Points very far from the others do not count. O(n).
CloudFrame find_cloud_frame(std::span<const Vec3> points);

/// Returns the points [m] in the frame, rounded. O(n).
Buffer<Vec3> enter_frame(const CloudFrame& frame, std::span<const Vec3> points, const Context& ctx);

/// Returns for points of the frame, which must differ, exactly the points of the cloud from which
/// enter_frame() made them. Others, as means of points, are turned back. O(cloud log points).
Buffer<Vec3> leave_frame(const CloudFrame& frame, std::span<const Vec3> points, std::span<const Vec3> cloud,
                         const Context& ctx);

}  // namespace coppice::extract_internal
