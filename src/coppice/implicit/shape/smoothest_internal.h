#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice {

/// The bending energy that a function through points minimizes.
enum class Bending {
    in_space,  ///< third derivatives in space: kernel r^3
    in_plane   ///< second derivatives in the plane z = 0: kernel r^2 log r, the thin plate
};

/// f(p) = sum of weight k(|p - center|) + linear . p + constant, with the kernel k of its bending.
struct SmoothestFunction {
    std::vector<Vec3d> centers;
    std::vector<double> weight;  ///< one for each centre
    Vec3d linear;
    double constant = 0;
};

/// Returns the kernel of a bending at a squared distance.
double bending_kernel(Bending bending, double squared);

/// Returns the function with the smallest bending energy [Turk2002] of all functions that are 0 at the
/// points, and equal to the offset at points shifted along their normals by it (less if another point would
/// be nearer). Points must be within a box of size 1; normals must have a length; of more than a thousand
/// normals, those at a thousand points are used. `subject` is the prefix of messages. O(n^3). Throws
/// InvalidInput for points that coincide, or that do not determine a linear function.
SmoothestFunction smoothest_function(std::span<const Vec3d> points, std::span<const Vec3> normals,
                                     double offset, Bending bending, const char* subject, const Context& ctx);

}  // namespace coppice
