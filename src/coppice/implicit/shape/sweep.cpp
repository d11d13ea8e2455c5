#include "coppice/implicit/shape/sweep.h"

#include <fmt/format.h>

#include <algorithm>

#include "coppice/base/check_fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/implicit/shape/path_internal.h"

namespace coppice {
namespace {

constexpr float kMaxScale = 1e3f;

void check_scales(std::span<const ScaleAt> scales, bool closed) {
    for (std::size_t i = 0; i < scales.size(); ++i) {
        const auto [fraction, scale] = scales[i];
        if (!(fraction >= 0 && fraction <= 1) || (i > 0 && !(fraction > scales[i - 1].fraction)))
            throw InvalidInput(
                fmt::format("sweep: fractions of scales must increase from 0 to 1, but scale {} is at {}",
                            i + 1, fraction));
        if (!(scale > 0 && scale <= kMaxScale))
            throw InvalidInput(
                fmt::format("sweep: scale {} must be above 0 and at most 1000, but is {}", i + 1, scale));
    }
    if (closed && !scales.empty() && scales.front().scale != scales.back().scale)
        throw InvalidInput("sweep: along a closed path the first and the last scale must be equal");
}

struct ScaleValue {
    double value = 1, slope = 0;
};

ScaleValue scale_at(std::span<const ScaleAt> scales, double fraction) {
    if (scales.empty()) return {};
    const auto after = std::upper_bound(scales.begin(), scales.end(), fraction,
                                        [](double f, const ScaleAt& s) { return f < s.fraction; });
    if (after == scales.begin()) return {scales.front().scale, 0};
    if (after == scales.end()) return {scales.back().scale, 0};
    const ScaleAt a = after[-1], b = *after;
    const double slope = (double{b.scale} - a.scale) / (double{b.fraction} - a.fraction);
    return {a.scale + slope * (fraction - a.fraction), slope};
}

}  // namespace

Sweep::Sweep(Curve path, Profile profile, std::span<const ScaleAt> scales, const SweepOptions& options)
    : path_(std::move(path)),
      profile_(std::move(profile)),
      scales_(scales.begin(), scales.end()),
      options_(options) {
    check_fields(options, "sweep");
    const PathTurn turn{options.roll, options.twist};
    check_path(path_, turn, "sweep");
    if (!profile_.closed()) throw InvalidInput("sweep: the profile is open; close it");
    check_scales(scales_, path_.closed());
    double most = scales_.empty() ? 1 : 0;
    for (const ScaleAt& s : scales_) most = std::max<double>(most, s.scale);
    reach_ = most * profile_.reach();
    // Scales may have a maximum between the evaluated places, so that the maximum is used for all.
    bounds_ = swept_bounds(path_, turn, profile_.low(), profile_.high(), [&](double) { return most; });
}

void Sweep::distance(std::span<const Vec3> points, std::span<FieldSample> out) const {
    const auto value = [&](double fraction, Vec2d q) -> PathSample {
        const ScaleValue scale = scale_at(scales_, fraction);
        const PlaneSample s = profile_.distance(q * (1 / scale.value));
        const double by_scale = s.value - (q.x * s.gradient.x + q.y * s.gradient.y) / scale.value;
        return {scale.value * s.value, s.gradient, by_scale * scale.slope};
    };
    const PathTurn turn{options_.roll, options_.twist};
    for (std::size_t i = 0; i < points.size(); ++i)
        out[i] = sample_along(path_, turn, points[i], reach_, value);
}

void list_fields(SweepOptions& o, FieldList& list) {
    list.add(Field{"roll", "Angle by which the profile is rotated about the path.", Unit::radian, -1e3, 1e3},
             o.roll);
    list.add(Field{"twist", "Additional angle by which it rotates from the path's start to its end.",
                   Unit::radian, -1e3, 1e3},
             o.twist);
}

}  // namespace coppice
