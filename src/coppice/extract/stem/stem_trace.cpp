#include "coppice/extract/stem/stem_trace_internal.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "coppice/base/median.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"

namespace coppice::extract_internal {
namespace {

constexpr double kSlab = 0.12;      // [m] thickness of a section
constexpr double kThickSlab = 0.4;  // [m] thickness if there are few points
constexpr std::size_t kFewSections = 4;
constexpr double kAbout = 0.45;        // [m] half-height of the range in which a diameter is measured
constexpr double kAboutStep = 0.075;   // [m]
constexpr std::size_t kOneSided = 20;  // maximum ratio of all points to those on one side of a section
constexpr double kHidden = 0.6;
constexpr double kHiddenSteps = 3;  // [m], [step] maximum length without sections before tracing stops
constexpr double kThin = 0.004;     // [m] edge of the squares in which one point is kept
constexpr double kMaxGrowth = 1.5;  // [radius of the guess] maximum radius of a section
constexpr double kUpward = 0.2;     // weight of a section that is thicker than those below it
constexpr int kCuts = 3;            // maximum number of cuts for a section
constexpr double kAcross = 0.995;   // [cos] minimum alignment of the axis and the direction of a cut
constexpr double kUpright = 0.3;    // [cos] minimum alignment of a stem and the vertical
constexpr double kChance = 0.01;    // probability of a false section in uniformly distributed points

/// Returns the minimum contrast of a circle, from the number of distinct circles of this thickness in the
/// search region.
double min_contrast(const CircleSearch& search, double thickness) {
    const double places = search.reach / thickness;
    const double radii = (search.max_radius - search.min_radius) / thickness;
    return std::log(std::max(1.0, std::numbers::pi * places * places * radii) / kChance);
}

/// Expected axis and radius of a stem at a section to be measured.
struct Guess {
    Vec3d center, direction;
    double radius, max_radius;

    /// Creates a guess without knowledge of the taper from other sections.
    static Guess at(Vec3d center, Vec3d direction, double radius) {
        return {center, direction, radius, kMaxGrowth * radius};
    }
};

/// Measures the section at a guess; returns nullopt if no circle is found.
std::optional<StemSection> cut(const HeightOrder& points, const Guess& guess, double thickness,
                               const TraceOptions& options) {
    const Vec3d d = guess.direction, u = perpendicular(d), v = cross(d, u);
    const double wide = 2.2 * guess.radius + 4 * options.noise;
    const double lean = std::hypot(d.x, d.y);
    const double reach = 0.5 * thickness + wide * lean;
    std::vector<PlanePoint> plane;
    std::size_t above = 0;
    for (const Vec3 p : points.between(guess.center.z - reach, guess.center.z + reach)) {
        const Vec3d off = Vec3d(p) - guess.center;
        if (std::abs(off.x) > wide + reach || std::abs(off.y) > wide + reach) continue;
        const double along = dot(off, d), x = dot(off, u), y = dot(off, v);
        if (std::abs(along) > 0.5 * thickness || x * x + y * y >= wide * wide) continue;
        plane.push_back({x, y, 1});
        above += along > 0;
    }
    // Beyond the end of a stem there are points on one side only.
    if (const std::size_t below = plane.size() - above; kOneSided * std::min(above, below) < plane.size())
        return {};
    plane = thin_plane(plane, kThin);
    const CircleSearch search{.min_radius = 0.5 * guess.radius,
                              .max_radius = guess.max_radius,
                              .noise = options.noise,
                              .seed = 1,
                              .anywhere = false,
                              .reach = 0.6 * guess.radius + 0.02};
    const FoundCircle c = find_circle(plane, search);
    if (c.used == 0 || c.inside > 0.5 || c.residual > 0.2 * c.radius + options.noise) return {};
    if (std::hypot(c.x, c.y) > 0.8 * guess.radius + 0.03) return {};
    if (circle_contrast(plane, c, options.noise, wide) < min_contrast(search, 2 * options.noise)) return {};
    StemSection section{guess.center + u * c.x + v * c.y, 0, c};
    section.height = section.center.z - options.foot;
    section.circle.radius = outline_radius(plane, c, options.noise);
    return section;
}

/// Measures the section at a guess, in a thicker slab if there are few points. A plane that is oblique to the
/// axis cuts an ellipse, and circles are found on its ends: cuts again until the axis from the section before
/// is perpendicular to the plane.
std::optional<StemSection> cut_across(const HeightOrder& points, Guess guess, const StemSection* before,
                                      const TraceOptions& options) {
    std::optional<StemSection> section;
    for (int pass = 0; pass < kCuts; ++pass) {
        section = cut(points, guess, kSlab, options);
        if (!section) section = cut(points, guess, 2.5 * kSlab, options);
        if (!section || before == nullptr) break;
        const Vec3d way = section->center - before->center;
        const Vec3d along = normalized(way.z < 0 ? -1.0 * way : way, guess.direction);
        if (along.z <= kUpright || dot(along, guess.direction) >= kAcross) break;
        guess.direction = along;
        guess.center = section->center;
    }
    return section;
}

/// Robust radius at a height, and its slope.
struct Line {
    double at = 0, slope = 0, deviation = 0;
};

/// Returns a straight line through (t, value) by weighted least squares that ignores outliers.
Line robust_line(std::span<const double> t, std::span<const double> value, std::span<const double> weight) {
    Line line{median(value), 0, 0};
    std::vector<double> off(value.size());
    double scale = 0;
    double s0 = 0, s1 = 0, s2 = 0, b0 = 0, b1 = 0, squares = 0, used = 0;
    for (int pass = 0; pass < 8; ++pass) {
        for (std::size_t i = 0; i < t.size(); ++i) off[i] = std::abs(value[i] - line.at - line.slope * t[i]);
        scale = std::max(4.685 * 1.4826 * median(off), 0.01 * line.at);
        s0 = s1 = s2 = b0 = b1 = squares = used = 0;
        for (std::size_t i = 0; i < t.size(); ++i) {
            const double r = off[i] / scale;
            if (r >= 1) continue;
            const double w = weight[i] * (1 - r * r) * (1 - r * r);
            s0 += w, s1 += w * t[i], s2 += w * t[i] * t[i];
            b0 += w * value[i], b1 += w * value[i] * t[i];
            squares += w * off[i] * off[i];
            used += 1;
        }
        // A stem tapers by some centimetres per metre: regularizes the slope if there are few sections.
        const double kStiff = 0.01 * s0;
        const double det = s0 * (s2 + kStiff) - s1 * s1;
        if (!(det > 0)) break;
        line.at = (b0 * (s2 + kStiff) - s1 * b1) / det;
        line.slope = (s0 * b1 - s1 * b0) / det;
        const double variance = squares / s0 * (used > 2 ? used / (used - 2) : 4);
        line.deviation = std::sqrt(std::max(variance, 0.0) * (s2 + kStiff) / det * s0 / std::max(used, 1.0));
    }
    return line;
}

/// Returns the sections within kAbout of a height.
std::vector<StemSection> sections_about(const HeightOrder& points, const StemTrack& track, double height,
                                        double thickness, const TraceOptions& options) {
    std::vector<StemSection> sections;
    for (double off = -kAbout; off <= kAbout + 1e-9; off += kAboutStep) {
        const double z = options.foot + height + off;
        if (z <= options.foot || z >= options.top) continue;
        if (const auto s =
                cut(points, Guess::at(track.at(z), track.direction_at(z), track.radius), thickness, options))
            sections.push_back(*s);
    }
    return sections;
}

}  // namespace

HeightOrder::HeightOrder(std::span<const Vec3> points, const Context& ctx) {
    constexpr double kLayer = 0.02, kMaxLayers = 1e5;  // [m]; maximum number of layers
    if (!points.empty()) {
        const auto [low, high] = std::ranges::minmax(points, {}, &Vec3::z);
        low_ = low.z;
        high_ = high.z;
    }
    thick_ = std::max(kLayer, (high_ - low_) / kMaxLayers);
    first_.assign(find_layer(high_) + 2, 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        poll_stop(ctx, i);
        ++first_[find_layer(points[i].z)];
    }
    exclusive_scan(std::span(first_));
    points_.resize(points.size());
    std::vector<std::uint32_t> next = first_;
    for (std::size_t i = 0; i < points.size(); ++i) {
        poll_stop(ctx, i);
        points_[next[find_layer(points[i].z)]++] = points[i];
    }
}

std::size_t HeightOrder::find_layer(double z) const {
    return static_cast<std::size_t>((std::clamp(z, low_, high_) - low_) / thick_);
}

std::span<const Vec3> HeightOrder::between(double low, double high) const {
    if (high < low_ || low > high_) return {};
    const std::size_t first = first_[find_layer(low)], last = first_[find_layer(high) + 1];
    return all().subspan(first, last - first);
}

std::vector<StemSection> trace_stem(const HeightOrder& points, const StemTrack& track, double step,
                                    const TraceOptions& options) {
    std::vector<StemSection> sections;
    const double start = std::clamp(track.middle().z, options.foot + 0.5 * step, options.top);
    const double least = std::max(0.7 * options.spacing, 0.004);
    // Traces first down, then up, each from breast height.
    for (const double way : {-1.0, 1.0}) {
        Guess guess = Guess::at(track.at(start), track.direction_at(start), track.radius);
        std::vector<StemSection> found;
        double hidden = 0;
        for (double z = way < 0 ? start : start + step; z > options.foot && z < options.top;
             z += way * step) {
            guess.center = guess.center + guess.direction * ((z - guess.center.z) / guess.direction.z);
            auto section = cut_across(points, guess, found.empty() ? nullptr : &found.back(), options);
            if (section && section->radius() > guess.max_radius) section.reset();
            if (!section) {
                hidden += step;
                if (hidden > std::max(kHidden, kHiddenSteps * step)) break;
                continue;
            }
            hidden = 0;
            if (way > 0 && section->radius() < least) break;
            found.push_back(*section);
            // Direction of the axis through the last few sections, limited to the lean of stems.
            const std::size_t back = std::min<std::size_t>(found.size() - 1, 4);
            Vec3d along = found.back().center - found[found.size() - 1 - back].center;
            if (back >= 2) {
                along = normalized(along * way);
                if (along.z > kUpright) guess.direction = normalized(lerp(guess.direction, along, 0.6));
            }
            guess.center = section->center;
            const bool thicker = section->radius() > guess.radius;
            guess.radius = std::lerp(guess.radius, section->radius(), way > 0 && thicker ? kUpward : 0.6);
            guess.max_radius = way > 0 ? 1.2 * guess.radius + options.noise : kMaxGrowth * guess.radius;
        }
        sections.insert(sections.end(), found.begin(), found.end());
    }
    std::ranges::sort(sections, {}, [](const StemSection& s) { return s.center.z; });
    return sections;
}

DiameterAt diameter_at(const HeightOrder& points, const StemTrack& track, double height,
                       const TraceOptions& options) {
    std::vector<StemSection> sections = sections_about(points, track, height, kSlab, options);
    if (sections.size() < kFewSections) sections = sections_about(points, track, height, kThickSlab, options);
    // No section at this height: use the sections above and below, which are circles across the vertical.
    if (sections.empty()) sections = track.sections;
    DiameterAt out;
    out.sections = sections.size();
    std::vector<double> t, radius, weight, residual, coverage;
    double formal = 0;
    for (const StemSection& s : sections) {
        const double sure = std::max(s.circle.deviation, 0.005 * s.radius());
        t.push_back(s.height - height);
        radius.push_back(s.radius());
        weight.push_back(1 / (sure * sure + 1e-8));
        residual.push_back(s.circle.residual);
        coverage.push_back(s.circle.coverage);
        formal += weight.back();
    }
    const auto off = [&](const StemSection& s) { return std::abs(s.height - height); };
    out.center = std::ranges::min(sections, {}, off).center;
    const Line line = robust_line(t, radius, weight);
    out.diameter = 2 * line.at;
    out.residual = median_in_place(residual);
    out.coverage = median_in_place(coverage);
    out.deviation = 2 * std::hypot(line.deviation, std::sqrt(1 / formal));
    return out;
}

}  // namespace coppice::extract_internal
