#include "coppice/points/sampling/density.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "coppice/base/error.h"

namespace coppice {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kMax = 1e12;  // limits the loss of precision of sums of densities

bool is_in(float x, float low, float high) { return x >= low && x <= high; }

}  // namespace

DensityCurve::DensityCurve(PointDensity kind, float level, float width, float power)
    : low_(level), high_(kInfinity) {
    if (!std::isfinite(level))
        throw InvalidInput("density: the iso value of the field must be a finite number");
    if (kind == PointDensity::uniform) return;
    if (kind == PointDensity::inside_boundary || kind == PointDensity::outside_boundary) {
        if (!(width > 0) || !std::isfinite(width)) {
            throw InvalidInput(
                fmt::format("density: width must be above 0 and finite for a shell, but is {}", width));
        }
        shell_width_ = width;
        (kind == PointDensity::inside_boundary ? high_ : low_) =
            kind == PointDensity::inside_boundary ? level + width : level - width;
        if (kind == PointDensity::outside_boundary) high_ = level;
        if (!(low_ < high_)) {
            throw InvalidInput(
                fmt::format("density: width {} is too small relative to the iso value {}", width, level));
        }
        return;
    }
    if (!is_in(power, 0, 16)) {
        throw InvalidInput(fmt::format("density: power must be between 0 and 16, but is {}", power));
    }
    if (!(level > 0)) {
        throw InvalidInput(
            fmt::format("density: {} needs a field with an iso value above 0, but it is {}; use uniform",
                        name_of(kind), level));
    }
    scale_ = 1 / static_cast<double>(level);
    exponent_ = kind == PointDensity::proportional ? power : -power;
}

DensityCurve::DensityCurve(std::vector<Knot> knots)
    : low_(0), high_(0), closed_(true), knots_(std::move(knots)) {
    if (knots_.size() < 2) throw InvalidInput("density: a curve needs at least two knots");
    float first = kInfinity, last = -kInfinity;  // range of the values with a density
    for (std::size_t i = 0; i < knots_.size(); ++i) {
        const Knot k = knots_[i];
        if (!std::isfinite(k.value) || !is_in(k.density, 0, 1e6f)) {
            throw InvalidInput(
                fmt::format("density: knot {} ({}, {}) must have a finite value and a density from 0 to 1e6",
                            i + 1, k.value, k.density));
        }
        if (i > 0 && k.value < knots_[i - 1].value) {
            throw InvalidInput(
                fmt::format("density: the values of the knots must not decrease, but knot {} has {} after {}",
                            i + 1, k.value, knots_[i - 1].value));
        }
        if (!(k.density > 0)) continue;
        first = std::min(first, knots_[i == 0 ? 0 : i - 1].value);
        last = knots_[std::min(i + 1, knots_.size() - 1)].value;
    }
    low_ = knots_.front().value;
    high_ = knots_.back().value;
    if (!(first < last)) {
        throw InvalidInput(
            "density: the curve is 0 everywhere; give it knots of several values and a density above 0");
    }
    shell_width_ = last - first;
}

double DensityCurve::inside(float value) const {
    if (exponent_ != 0) return std::min(kMax, std::pow(scale_ * value, exponent_));
    if (knots_.empty()) return 1;
    const auto above = std::upper_bound(knots_.begin(), knots_.end(), value,
                                        [](float v, const Knot& k) { return v < k.value; });
    if (above == knots_.end()) return knots_.back().density;
    const Knot a = *(above - 1), b = *above;
    const double t = (static_cast<double>(value) - a.value) / (static_cast<double>(b.value) - a.value);
    return a.density + (static_cast<double>(b.density) - a.density) * t;
}

double DensityCurve::at(float value) const {
    const bool in = closed_ ? is_in(value, low_, high_) : value > low_ && value < high_;
    return in ? inside(value) : 0;
}

DensityCurve::Range DensityCurve::over(float low, float high) const {
    if (!(low <= high)) low = -kInfinity, high = kInfinity;  // not a number: no bounds are known
    if (high < low_ || low > high_) return {0, 0};
    const bool whole = low > low_ && high < high_;
    low = std::max(low, low_);
    high = std::min(high, high_);
    const auto [least, largest] = std::minmax({inside(low), inside(high)});
    Range range{least, largest};
    for (std::size_t i = 0; i < knots_.size(); ++i) {
        if (!is_in(knots_[i].value, low, high)) continue;
        range.least = std::min<double>(range.least, knots_[i].density);
        range.largest = std::max<double>(range.largest, knots_[i].density);
    }
    if (!whole) range.least = 0;
    return range;
}

}  // namespace coppice
