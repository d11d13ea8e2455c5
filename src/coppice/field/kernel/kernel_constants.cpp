#include "coppice/field/kernel/kernel_constants.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/check_fields.h"
#include "coppice/field/kernel/ball_kernel.h"
#include "coppice/field/kernel/cauchy_kernel.h"
#include "coppice/field/kernel/quartic_kernel.h"
#include "coppice/field/kernel/scalis_kernel.h"

namespace coppice {
namespace {

using kernel::SegmentConstants;

constexpr double kFar = 1e4;          // [radii] represents infinity along a line
constexpr double kBallLength = 0.05;  // [radii] length of the line of a ball
constexpr double kMinRadius = 0.25;   // minimum radius of a tapering extension, relative to the node's
constexpr float kSteepest = 1e3f;     // a greater slope is a step: the segment gets its greater radius
constexpr double kCalibrationSlope = 0.1;
// Maximum ratio of radii of one segment for which the spacing of balls is as specified.
constexpr float kWidest = 32;
constexpr float kMaxBalls = 1 << 20;  // maximum number per segment, limited by the precision of float

SegmentConstants<double> along_x(double begin, double end, double radius, double slope) {
    return {0, 0, 0, 1, 0, 0, begin, end, 0, radius, slope, 1, 1};
}

}  // namespace

KernelConstants kernel_constants(const FieldOptions& o) {
    switch (o.kernel) {
        case Kernel::quartic:
        case Kernel::balls:
            return {o.kernel, o.support, kernel::QuarticKernel<double>::line_weight(o.support)};
        case Kernel::cauchy:
            return {o.kernel, o.width, kernel::CauchyKernel<double>::line_weight(o.width)};
        case Kernel::scalis:
            break;
    }
    return {Kernel::scalis, kernel::ScalisKernel<double>::kSupport, 1};
}

kernel::Sample<double> sample_segment(const KernelConstants& constants,
                                      const SegmentConstants<double>& segment, kernel::Point<double> p) {
    kernel::Sample<double> sum{0, 0, 0, 0};
    switch (constants.kernel) {
        case Kernel::quartic:
            kernel::add_segment(kernel::QuarticKernel<double>(constants.shape, constants.weight), segment, p,
                                sum);
            break;
        case Kernel::cauchy:
            kernel::add_segment(kernel::CauchyKernel<double>(constants.shape, constants.weight), segment, p,
                                sum);
            break;
        case Kernel::scalis:
            kernel::ScalisKernel<double>().add(segment, p, sum);
            break;
        case Kernel::balls:
            kernel::BallKernel<double>(constants.shape, constants.weight).add(segment, p, sum);
            break;
    }
    return sum;
}

SegmentBuilder::SegmentBuilder(const FieldOptions& options)
    : options_(options), radius_scale_(options.radius_scale > 0 ? options.radius_scale : 1) {
    check_fields(options, "field");
    kernel_ = kernel_constants(options);
    reach_ = options.kernel == Kernel::cauchy ? options.reach : static_cast<float>(kernel_.shape);
    if (options.kernel == Kernel::balls) chain_ = ball_chain(options.support, options.ball_bulge);
    tip_extension_ = calibrate_tip(0);
    if (options.kernel == Kernel::scalis) {
        tip_extension_slope_ =
            (calibrate_tip(kCalibrationSlope) - calibrate_tip(-kCalibrationSlope)) / (2 * kCalibrationSlope);
    }
}

double SegmentBuilder::calibrate_tip(double slope) const {
    // On the axis, 1 radius beyond a tip at the origin, the value increases with the length of the line.
    const double before = options_.kernel == Kernel::scalis ? 2.5 : kFar;
    KernelConstants of_line = kernel_;  // many balls converge to a line
    if (of_line.kernel == Kernel::balls) of_line.kernel = Kernel::quartic;
    double low = -1, high = 4;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        SegmentConstants<double> line = along_x(-before, middle, 1, slope);
        line.weight = slope_weight(slope);
        (sample_segment(of_line, line, {1, 0, 0}).value < 1 ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

double SegmentBuilder::slope_weight(double slope) const {
    if (options_.kernel != Kernel::scalis) return 1;
    // An infinite cone has the same value at all points with a distance equal to the radius at the closest
    // point.
    const double reach = 0.9 / std::max(std::abs(slope), 1e-4);
    return 1 / sample_segment(kernel_, along_x(-reach, reach, 1, slope), {0, 1, 0}).value;
}

float SegmentBuilder::extension(float option, float radius, float slope_outward) const {
    // A round end extends one radius, without the scale, beyond the node.
    const double round = tip_extension_ - (1 - 1 / static_cast<double>(radius_scale_));
    if (options_.kernel != Kernel::scalis) {
        return radius * (option >= 0 ? option : static_cast<float>(round));
    }
    const double wanted = option >= 0 ? option : round + tip_extension_slope_ * slope_outward;
    const double most = slope_outward < 0 ? (1 - kMinRadius) / -slope_outward : wanted;
    return radius * static_cast<float>(std::min(wanted, most));
}

SegmentConstants<float> SegmentBuilder::build(const Segment& given, Vec3 fallback, bool is_tip,
                                              RootEnd root) const {
    Segment s = given;
    s.radius_a *= radius_scale_;
    s.radius_b *= radius_scale_;
    const float length = distance(s.a, s.b);
    const Vec3 u = length > 0 ? (s.b - s.a) / length : fallback;
    float radius = s.radius_a;
    float slope = 0;
    if (std::abs(s.radius_b - s.radius_a) < kSteepest * length) {
        slope = (s.radius_b - s.radius_a) / length;
    } else {
        radius = std::max(s.radius_a, s.radius_b);
    }
    if (options_.kernel == Kernel::scalis && std::abs(slope) > kernel::ScalisKernel<float>::kMaxSlope) {
        slope = std::copysign(static_cast<float>(kernel::ScalisKernel<float>::kMaxSlope), slope);
        if (slope < 0) radius = s.radius_b - slope * length;
    }
    float begin = 0;
    if (root != RootEnd::none)
        begin = -extension(root == RootEnd::base ? options_.root_extension : -1.0f, radius, -slope);
    const float end =
        length + (is_tip ? extension(options_.tip_extension, radius + slope * length, slope) : 0.0f);
    SegmentConstants<float> out{s.a.x, s.a.y, s.a.z,  u.x,    u.y,   u.z,
                                begin, end,   length, radius, slope, static_cast<float>(slope_weight(slope))};
    out.balls = ball_count(out);
    return out;
}

int SegmentBuilder::ball_count(const SegmentConstants<float>& s) const {
    if (options_.kernel != Kernel::balls || !(s.end > s.begin)) return 0;
    const float other = s.radius + s.slope * s.length;
    const float thin = std::max(std::min(s.radius, other), std::max(s.radius, other) / kWidest);
    const float count = (s.end - s.begin) / (static_cast<float>(chain_.spacing) * thin);
    return static_cast<int>(std::ceil(std::clamp(count, 1.0f, kMaxBalls)));
}

SegmentConstants<float> SegmentBuilder::build_ball(Vec3 center, float given_radius) const {
    const float radius = given_radius * radius_scale_;
    const double half = 0.5 * kBallLength;
    const double value = sample_segment(kernel_, along_x(-half, half, 1, 0), {0, 1, 0}).value;
    const float h = static_cast<float>(half) * radius;
    return {center.x, center.y, center.z, 0, 0, 1, -h, h, 0, radius, 0, static_cast<float>(1 / value), 1};
}

}  // namespace coppice
