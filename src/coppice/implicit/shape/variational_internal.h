#pragma once

#include <span>

#include "coppice/base/vec.h"

namespace coppice {

/// Value and derivatives of sum of w |p - c|^3.
struct CubeSums {
    double value = 0;
    Vec3d gradient;
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};

/// The spans have equal lengths.
struct CubeCenters {
    std::span<const double> x, y, z, weight;
};

/// Computes the sums with the widest vectors of this machine.
CubeSums sum_cubes(const CubeCenters& centers, Vec3d p);

}  // namespace coppice
