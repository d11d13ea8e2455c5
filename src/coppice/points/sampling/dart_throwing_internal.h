#pragma once

#include <cstddef>
#include <vector>

#include "coppice/points/sampling/cells_internal.h"
#include "coppice/points/sampling/dart_throwing.h"

namespace coppice::points_internal {

/// Makes points with a minimum distance follow a density. Many points leave no space for each other in dense
/// regions, and at the boundary of a solid the density of neighbours is lower; both change the density of
/// Lane's method by up to a factor of two.
///
/// Therefore the distance follows the density: at the density `mean` it is the core of the kernel, and at the
/// density d it is the core times the cube root of mean / d. Two points keep the smaller of their distances.
/// In addition, the values of the field are divided into shells, none of which may exceed its share by more
/// than some per cent.
struct DensityLaw {
    double mean = 0;             ///< density at which the distance is the core of the kernel; > 0
    std::vector<float> limits;   ///< values of the field between the shells, increasing
    std::vector<double> shares;  ///< shares of the points in each shell: one more than limits; their sum is 1

    /// Returns the index of the shell of a value.
    std::size_t shell(float value) const;
};

/// Computes the law of a surveyed region, with shells of about equal shares.
DensityLaw density_law(const Capacity& capacity, std::size_t shells);

/// Runs `sample_dart_throwing` with surveyed cells: they are reused if they have the voxels that Lane's
/// method would choose and are not subdivided. Options and box must have been checked.
DartThrowingResult sample_lane_in_cells(const PointRegion& region, const RadialKernel& kernel,
                                        const DartThrowingOptions& options, const DensityLaw& law,
                                        Cells surveyed, const Context& ctx);

}  // namespace coppice::points_internal
