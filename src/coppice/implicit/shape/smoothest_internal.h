#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice {

/// What a function through points is to have the least of.
enum class Bending {
    in_space,  ///< third derivatives in space: kernel r^3
    in_plane   ///< second derivatives in the plane z = 0: kernel r^2 log r, the thin plate
};

/// f(p) = sum of weight k(|p - center|) + linear . p + constant, with the kernel k of its bending.
struct SmoothestFunction {
    std::vector<Vec3d> centers;
    std::vector<double> weight;  ///< one for each center
    Vec3d linear;
    double constant = 0;
};

/// The kernel of a bending at a squared distance.
double bending_kernel(Bending bending, double squared);

/// Of all functions that are 0 at the points, and the offset at points shifted along their normals by it
/// (less where that would come nearer to another point), the one that bends least [Turk2002]. Points lie
/// within a box of size 1; normals have a length; beyond a thousand they count at a thousand points. `what`
/// begins messages. O(n^3). Throws InvalidInput for points that coincide, or that leave a linear function
/// free.
SmoothestFunction smoothest_function(std::span<const Vec3d> points, std::span<const Vec3> normals,
                                     double offset, Bending bending, const char* what, const Context& ctx);

}  // namespace coppice
