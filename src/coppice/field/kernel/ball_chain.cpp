#include "coppice/field/kernel/ball_chain.h"

#include <algorithm>
#include <cmath>

#include "coppice/field/kernel/quartic_kernel.h"

namespace coppice {
namespace {

constexpr double kStep = 0.01;  // [radii] in which spacings are tried

// Where the value is 1 on a ray across an endless chain that begins this far from a ball.
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

BallChain ball_chain_of(double support, double spacing) {
    return {spacing, radius_across(support, spacing, 0), radius_across(support, spacing, 0.5 * spacing)};
}

BallChain ball_chain(double support, double bulge) {
    // The difference swings as the spacing grows: spacings that happen to have none count only where all
    // closer ones are as good.
    BallChain best = ball_chain_of(support, kStep);
    for (int i = 2; i * kStep < 2 * support; ++i) {
        const BallChain next = ball_chain_of(support, i * kStep);
        if (std::abs(next.at_balls - next.between) > bulge) break;
        best = next;
    }
    return best;
}

}  // namespace coppice
