#include "coppice/field/kernel/ball_chain.h"

#include <algorithm>
#include <cmath>

#include "coppice/field/kernel/quartic_kernel.h"

namespace coppice {
namespace {

constexpr double kStep = 0.01;  // [radii] step between tested spacings

// Returns the distance at which the value is 1 on a ray perpendicular to an infinite chain, at this distance
// from a ball.
double radius_across(double support, double spacing, double from_ball) {
    const double weight = spacing * kernel::QuarticKernel<double>::line_weight(support);
    const auto reach = static_cast<int>(support / spacing) + 1;
    const auto value = [&](double r) {
        double sum = 0;
        for (int k = -reach; k <= reach; ++k) {
            const double x = from_ball + k * spacing;
            const double inside = std::max(support * support - r * r - x * x, 0.0);
            sum += inside * inside;
        }
        return weight * sum;
    };
    double low = 0, high = support;
    for (int i = 0; i < 32; ++i) {
        const double middle = 0.5 * (low + high);
        (value(middle) > 1 ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

}  // namespace

BallChain compute_ball_chain(double support, double spacing) {
    return {spacing, radius_across(support, spacing, 0), radius_across(support, spacing, 0.5 * spacing)};
}

BallChain ball_chain(double support, double bulge) {
    // The difference oscillates as the spacing grows: a spacing is only valid if all smaller ones are valid
    // too.
    BallChain best = compute_ball_chain(support, kStep);
    for (int i = 2; i * kStep < 2 * support; ++i) {
        const BallChain next = compute_ball_chain(support, i * kStep);
        if (std::abs(next.at_balls - next.between) > bulge) break;
        best = next;
    }
    return best;
}

}  // namespace coppice
