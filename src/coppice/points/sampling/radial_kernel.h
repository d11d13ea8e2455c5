#pragma once

#include <vector>

namespace coppice {

/// Factor by which a placed point multiplies the density as a function of the distance: 0 within its core,
/// then linear between knots, 1 beyond the last. Represents both Poisson disks and clusters. Source:
/// [Lane2002].
class RadialKernel {
  public:
    /// Vertex of the piecewise linear kernel.
    struct Knot {
        float distance;  ///< [m]
        float factor;    ///< 0 to 1e6
    };

    /// Does not change the density.
    RadialKernel() = default;

    /// Returns a kernel for Poisson disks: 0 closer than `distance`, 1 elsewhere. A distance of 0 has no
    /// effect.
    static RadialKernel disk(float distance);

    /// Returns a kernel that is 0 closer than `distance` and decreases linearly from `gain` there to 1 at
    /// `reach`: a gain above 1 creates clusters, below 1 a soft edge.
    static RadialKernel clustered(float distance, float reach, float gain);

    /// The distance of the first knot is the core, the minimum distance of points (0: no core). Distances
    /// must not decrease. Throws InvalidInput with the number of the invalid knot.
    explicit RadialKernel(std::vector<Knot> knots);

    double core() const { return knots_.empty() ? 0 : knots_.front().distance; }  ///< [m]
    double reach() const {
        return knots_.empty() ? 0 : knots_.back().distance;
    }                                                  ///< [m] the factor is 1 beyond
    bool is_soft() const { return reach() > core(); }  ///< whether it acts beyond its core

    /// Returns the factor at a distance outside the core.
    double at(double distance) const;

  private:
    std::vector<Knot> knots_;
};

}  // namespace coppice
