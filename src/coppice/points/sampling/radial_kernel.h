#pragma once

#include <vector>

namespace coppice {

/// By what a placed point multiplies the density at a distance from it: 0 within its core, then linear
/// between knots, 1 beyond the last. Poisson disks and clusters come from one mechanism. Source: [Lane2002].
class RadialKernel {
  public:
    /// A corner of the kernel.
    struct Knot {
        float distance;  ///< [m]
        float factor;    ///< 0 to 1e6
    };

    /// Leaves the density as it is.
    RadialKernel() = default;

    /// 0 nearer than `distance`, 1 elsewhere: Poisson disks. 0 changes nothing.
    static RadialKernel disk(float distance);

    /// 0 nearer than `distance`, from there `gain` falling to 1 at `reach`: above 1 clusters, below 1 a soft
    /// edge.
    static RadialKernel clustered(float distance, float reach, float gain);

    /// Nothing comes nearer than the first knot, whose distance is the core (0: no core). Distances must not
    /// fall. Throws InvalidInput naming the knot.
    explicit RadialKernel(std::vector<Knot> knots);

    double core() const { return knots_.empty() ? 0 : knots_.front().distance; }  ///< [m]
    double reach() const { return knots_.empty() ? 0 : knots_.back().distance; }  ///< [m] 1 beyond
    bool is_soft() const { return reach() > core(); }                             ///< acts beyond its core

    /// The factor at a distance outside the core.
    double at(double distance) const;

  private:
    std::vector<Knot> knots_;
};

}  // namespace coppice
