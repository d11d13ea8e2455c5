#pragma once

#include <cstddef>
#include <vector>

#include "coppice/points/sampling/cells_internal.h"
#include "coppice/points/sampling/lane.h"

namespace coppice::points_internal {

/// What makes points that keep a distance follow a density all the same. Where many are wanted they leave no
/// room for one another, and at the rim of a solid there is nothing that keeps them away; both bend the law
/// of Lane's method, by up to twice the density.
///
/// So the distance follows the density: `mean` has the kernel's core, and where the density is d it is the
/// core times the cube root of mean / d. Two points keep the lesser distance of their places. And the field's
/// values are parted into shells, of which none may be ahead of its share by more than some per cent.
struct DensityLaw {
    double mean = 0;             ///< density where the kernel's core holds; > 0
    std::vector<float> limits;   ///< field's values between the shells, rising
    std::vector<double> shares;  ///< of the points in each shell: one more than limits; they add up to 1

    /// Index of the shell of a value.
    std::size_t shell(float value) const;
};

/// The law of a region that was surveyed, in shells of about equal shares.
DensityLaw density_law(const Capacity& capacity, std::size_t shells);

/// `sample_lane` for a caller that has surveyed the region: where the cells are of the voxels that Lane's
/// method would take and not yet cut, they are not made anew. Options and box must have been checked.
LaneResult sample_lane_in_cells(const PointRegion& region, const RadialKernel& kernel,
                                const LaneOptions& options, const DensityLaw& law, Cells surveyed,
                                const Context& ctx);

}  // namespace coppice::points_internal
