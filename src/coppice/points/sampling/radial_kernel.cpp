#include "coppice/points/sampling/radial_kernel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "coppice/base/error.h"

namespace coppice {

RadialKernel RadialKernel::disk(float distance) { return RadialKernel({{distance, 1}}); }

RadialKernel RadialKernel::clustered(float distance, float reach, float gain) {
    return RadialKernel({{distance, gain}, {reach, 1}});
}

RadialKernel::RadialKernel(std::vector<Knot> knots) : knots_(std::move(knots)) {
    for (std::size_t i = 0; i < knots_.size(); ++i) {
        const Knot k = knots_[i];
        if (!(k.distance >= 0) || !std::isfinite(k.distance) || !(k.factor >= 0 && k.factor <= 1e6f)) {
            throw InvalidInput(fmt::format(
                "kernel: knot {} ({}, {}) must have a distance of 0 or more and a factor from 0 to 1e6",
                i + 1, k.distance, k.factor));
        }
        if (i > 0 && k.distance < knots_[i - 1].distance) {
            throw InvalidInput(fmt::format(
                "kernel: the distances of the knots must not decrease, but knot {} has {} after {}", i + 1,
                k.distance, knots_[i - 1].distance));
        }
    }
}

double RadialKernel::at(double distance) const {
    const auto above = std::upper_bound(knots_.begin(), knots_.end(), distance,
                                        [](double d, const Knot& k) { return d < k.distance; });
    if (above == knots_.end()) return 1;
    if (above == knots_.begin()) return above->factor;
    const Knot a = *(above - 1), b = *above;
    const double t = (distance - a.distance) / (static_cast<double>(b.distance) - a.distance);
    return a.factor + (static_cast<double>(b.factor) - a.factor) * t;
}

}  // namespace coppice
