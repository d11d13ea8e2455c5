#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/field/kernel/kernel_constants.h"

namespace coppice::test {

/// A few segments summed in double precision, without extensions: for the comparison of formulas, not for
/// speed.
class DoubleField {
  public:
    explicit DoubleField(const KernelConstants& kernel) : kernel_(kernel) {}

    DoubleField& add(Vec3d a, Vec3d b, double radius_a = 1, double radius_b = 1, double weight = 1) {
        const double l = distance(a, b);
        const Vec3d u = (b - a) / l;
        segments_.push_back(
            {a.x, a.y, a.z, u.x, u.y, u.z, 0, l, l, radius_a, (radius_b - radius_a) / l, weight});
        return *this;
    }

    kernel::Sample<double> sample(Vec3d p) const {
        kernel::Sample<double> sum{0, 0, 0, 0};
        for (const auto& s : segments_) {
            const kernel::Sample<double> f = sample_segment(kernel_, s, {p.x, p.y, p.z});
            sum = {sum.value + f.value, sum.gx + f.gx, sum.gy + f.gy, sum.gz + f.gz};
        }
        return sum;
    }
    double value(Vec3d p) const { return sample(p).value; }

    /// Returns the distance from `start` along `direction` at which the value falls below 1; 0 if it is below
    /// 1 at the start.
    double reach(Vec3d start, Vec3d direction) const {
        const Vec3d u = normalized(direction);
        double low = 0;
        if (value(start) < 1) return 0;
        while (value(start + (low + 0.01) * u) >= 1) low += 0.01;
        double high = low + 0.01;
        for (int i = 0; i < 40; ++i) {
            const double middle = 0.5 * (low + high);
            (value(start + middle * u) >= 1 ? low : high) = middle;
        }
        return low;
    }

  private:
    KernelConstants kernel_;
    std::vector<kernel::SegmentConstants<double>> segments_;
};

inline KernelConstants quartic(double support) {
    return kernel_constants({.kernel = Kernel::quartic, .support = static_cast<float>(support)});
}
inline KernelConstants cauchy(double width) {
    return kernel_constants({.kernel = Kernel::cauchy, .width = static_cast<float>(width)});
}
inline KernelConstants scalis() { return kernel_constants({.kernel = Kernel::scalis}); }

/// Gauss-Legendre quadrature with five points on `pieces` equal sections.
inline double integrate(const std::function<double(double)>& f, double a, double b, int pieces = 2000) {
    constexpr double kNode[] = {0, 0.53846931010568309, -0.53846931010568309, 0.90617984593866399,
                                -0.90617984593866399};
    constexpr double kWeight[] = {0.56888888888888889, 0.47862867049936647, 0.47862867049936647,
                                  0.23692688505618909, 0.23692688505618909};
    const double h = (b - a) / pieces;
    double sum = 0;
    for (int i = 0; i < pieces; ++i) {
        for (int k = 0; k < 5; ++k) sum += kWeight[k] * f(a + h * (i + 0.5 + 0.5 * kNode[k]));
    }
    return 0.5 * h * sum;
}

/// Returns the maximum difference between the gradient and central differences of the value at p, relative to
/// 1 + its length.
inline double gradient_error(const std::function<kernel::Sample<double>(Vec3d)>& f, Vec3d p,
                             double step = 1e-5) {
    const auto s = f(p);
    const Vec3d g{s.gx, s.gy, s.gz};
    double worst = 0;
    for (int axis = 0; axis < 3; ++axis) {
        Vec3d e;
        e[axis] = step;
        worst = std::max(worst, std::abs((f(p + e).value - f(p - e).value) / (2 * step) - g[axis]));
    }
    return worst / (1 + length(g));
}

/// Compares the partial derivatives of a kernel in normal form with central differences.
template <class NormalForm>
void expect_derivatives_match(const NormalForm& f, double h2, double x0, double x1) {
    constexpr double kStep = 1e-5;
    const auto n = f(h2, x0, x1);
    const auto slope = [&](double dh, double d0, double d1) {
        return (f(h2 + dh, x0 + d0, x1 + d1).value - f(h2 - dh, x0 - d0, x1 - d1).value) / (2 * kStep);
    };
    EXPECT_NEAR(n.d_h2, slope(kStep, 0, 0), 1e-6 * (1 + std::abs(n.d_h2)));
    EXPECT_NEAR(n.d_x0, slope(0, kStep, 0), 1e-6 * (1 + std::abs(n.d_x0)));
    EXPECT_NEAR(n.d_x1, slope(0, 0, kStep), 1e-6 * (1 + std::abs(n.d_x1)));
}

}  // namespace coppice::test
