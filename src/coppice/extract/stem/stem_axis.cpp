#include "coppice/extract/stem/stem_axis_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "coppice/base/id.h"
#include "coppice/base/median.h"
#include "coppice/base/parallel.h"
#include "coppice/extract/prior/isotonic_internal.h"
#include "coppice/extract/stem/stem_form_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr std::size_t kDirectionGrain = 4096;
constexpr std::size_t kMinSections = 4;
constexpr std::array kWindows{4.0, 2.5, 1.6};  // [sections] half-widths of the window of a local line
constexpr double kStraight = 0.04;  // [radius] maximum median distance of sections from a straight axis
constexpr double kMinStep = 0.02;   // [m]
constexpr int kPasses = 4;          // number of iterations of the robust weights
constexpr double kOutlier = 4.685 * 1.4826;  // [median deviation] distance from which a section has weight 0
constexpr double kMinDeviation = 0.01;       // [radius] minimum deviation of a section
constexpr double kBreastSections = 13;  // number of sections that determine the diameter at breast height
constexpr double kOther = 0.4;          // minimum radius of another stem, relative to the thickest one
constexpr double kApart = 1.5;  // [sum of radii] minimum distance of the bases of stems of different trees
// [m] for a tree of ten metres: a stem with an end higher than this above the ground is not rooted
constexpr double kHanging = 0.3;
constexpr double kAsWellSeen = 0.5;  // minimum evidence of another stem, relative to the best one
// maximum number of points inside per point on the circles of another stem
constexpr double kMaxInside = 0.15;
constexpr double kAtRoot = 2;  // [radius] maximum distance of a specified root from the axis of its stem

struct Section {
    double z;
    Vec3d center;
    double radius, weight;
};

std::vector<Section> compute_sections(const StemForm& form) {
    std::vector<Section> out;
    const auto add = [&](const StemDiameter& d) {
        if (!(d.diameter > 0)) return;
        const double r = 0.5 * d.diameter;
        const double deviation = std::max(0.5 * d.deviation, kMinDeviation * r);
        out.push_back({d.center.z, d.center, r, 1 / (deviation * deviation)});
    };
    for (const StemDiameter& d : form.taper) add(d);
    add(form.breast);
    std::ranges::stable_sort(out, {}, &Section::z);
    return out;
}

/// Line through sections, evaluated at a height: x, y and radius.
struct LocalLine {
    double value[3], slope[3];
    double off;  ///< [m] median horizontal distance of the sections from the unweighted line
};

double component(const Section& s, int k) { return k == 0 ? s.center.x : k == 1 ? s.center.y : s.radius; }

/// Fits a line by weighted least squares; `off` [m] receives the absolute residuals.
void fit_line(std::span<const Section> near, std::span<const double> weight, double z, int k, LocalLine& line,
              std::vector<double>& off) {
    double w = 0, wt = 0, wtt = 0, wv = 0, wtv = 0;
    for (std::size_t i = 0; i < near.size(); ++i) {
        const double t = near[i].z - z, v = component(near[i], k);
        w += weight[i], wt += weight[i] * t, wtt += weight[i] * t * t;
        wv += weight[i] * v, wtv += weight[i] * t * v;
    }
    const double det = w * wtt - wt * wt;
    if (!(w > 0)) return;
    line.slope[k] = det > 1e-9 * w * wtt ? (w * wtv - wt * wv) / det : 0;
    line.value[k] = (wv - line.slope[k] * wt) / w;
    off.clear();
    for (const Section& s : near)
        off.push_back(std::abs(component(s, k) - line.value[k] - line.slope[k] * (s.z - z)));
}

/// Returns the robust line through the sections within a window [m].
LocalLine fit_local_line(std::span<const Section> near, double z, double window) {
    std::vector<double> base, weight, off;
    for (const Section& s : near) {
        const double t = (s.z - z) / window;
        base.push_back(s.weight * (1 - t * t));
    }
    LocalLine line{};
    for (int k = 0; k < 3; ++k) {
        fit_line(near, base, z, k, line, off);
        if (k < 2) line.off = std::hypot(line.off, median(off));
        for (int pass = 0; pass < kPasses; ++pass) {
            const double scale = std::max(kOutlier * median(off), 1e-4);
            weight = base;
            for (std::size_t i = 0; i < weight.size(); ++i) {
                const double x = std::min(1.0, off[i] / scale);
                weight[i] *= (1 - x * x) * (1 - x * x);
            }
            fit_line(near, weight, z, k, line, off);
        }
    }
    return line;
}

/// Returns the line at a height over the widest window in which the axis is straight, or else over the
/// smallest one.
LocalLine find_local_line(std::span<const Section> sections, double z, double step) {
    std::vector<double> far;
    for (const Section& s : sections) far.push_back(std::abs(s.z - z));
    std::ranges::nth_element(far, far.begin() + 2);
    LocalLine line{};
    for (const double count : kWindows) {
        const double window = std::max(count * step, 1.01 * far[2]);
        const auto low = std::ranges::upper_bound(sections, z - window, {}, &Section::z);
        const auto high = std::ranges::lower_bound(sections, z + window, {}, &Section::z);
        line = fit_local_line({low, high}, z, window);
        if (line.off <= kStraight * line.value[2]) break;
    }
    return line;
}

/// Position on an axis.
struct AxisPlace {
    Vec3d center;
    double radius;
    bool inside;  ///< whether it is between both ends
};

/// Returns the axis at a height; beyond its ends, the end.
AxisPlace place_at(const StemAxis& stem, double z) {
    const auto& at = stem.position;
    const auto above = std::ranges::upper_bound(at, z, {}, &Vec3d::z);
    if (above == at.begin()) return {at.front(), stem.radius.front(), false};
    if (above == at.end()) return {at.back(), stem.radius.back(), false};
    const auto i = static_cast<std::size_t>(above - at.begin());
    const double t = (z - at[i - 1].z) / (at[i].z - at[i - 1].z);
    return {lerp(at[i - 1], at[i], t), std::lerp(stem.radius[i - 1], stem.radius[i], t), true};
}

/// Quality of the detection of a stem: the sum of the coverage of its sections, and the mean number of points
/// inside per point on them.
struct Evidence {
    double seen = 0, inside = 0;
};

Evidence compute_evidence(const StemTrack& track) {
    Evidence out;
    for (const StemSection& s : track.sections) {
        out.seen += s.circle.coverage;
        out.inside += s.circle.inside / static_cast<double>(track.sections.size());
    }
    return out;
}

/// Fits radii that do not increase upward to those of the lines.
void make_monotone(std::vector<double>& radius, std::span<const double> weight) {
    std::vector<std::uint32_t> parent(radius.size());
    for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = i == 0 ? kNoIndex : i - 1;
    radius = isotonic_on_tree(parent, radius, weight);
}

}  // namespace

bool is_on_stem(std::span<const StemAxis> stems, Vec3d p, double spacing) {
    return std::ranges::any_of(stems, [&](const StemAxis& stem) {
        const AxisPlace at = place_at(stem, p.z);
        const Vec3d d = p - at.center;
        return at.inside && std::hypot(d.x, d.y) <= reach_of_stem(at.radius, spacing);
    });
}

Buffer<Vec3> growth_directions(std::span<const Vec3> points, std::span<const StemAxis> stems, StemBases bases,
                               const Context& ctx) {
    std::vector<Vec3d> feet;
    for (const auto& base : bases) {
        Vec3d sum;
        for (const std::uint32_t p : base) sum += Vec3d(points[p]) / static_cast<double>(base.size());
        feet.push_back(sum);
    }
    Buffer<Vec3> out(points.size());
    parallel_for(ctx, points.size(), kDirectionGrain, [&](std::size_t i) {
        const Vec3d p(points[i]);
        Vec3d best;
        double least = std::numeric_limits<double>::infinity();
        const auto look = [&](Vec3d at, Vec3d from) {
            const double aside = std::hypot(p.x - at.x, p.y - at.y);
            if (aside >= least) return;
            least = aside;
            best = from;
        };
        for (const StemAxis& stem : stems) {
            const Vec3d at = place_at(stem, p.z).center;
            look(at, place_at(stem, p.z - std::hypot(p.x - at.x, p.y - at.y)).center);
        }
        for (const Vec3d foot : feet) look(foot, foot);
        out[i] = Vec3(normalized(p - best, {0, 0, 1}));
    });
    return out;
}

StemAxis make_stem_axis(const StemForm& form) {
    const std::vector<Section> sections = compute_sections(form);
    StemAxis axis;
    if (sections.size() < kMinSections) return axis;
    const double rise = sections.back().z - sections.front().z;
    const double step = std::max(rise / static_cast<double>(sections.size() - 1), kMinStep);
    std::vector<double> weight;
    const auto add = [&](double z, const LocalLine& line, double w) {
        axis.position.push_back({line.value[0], line.value[1], z});
        axis.radius.push_back(line.value[2]);
        weight.push_back(w);
    };
    const LocalLine low = find_local_line(sections, sections.front().z, step);
    const double down = form.foot.z - sections.front().z;
    if (down < 0) {
        LocalLine foot = low;
        for (int k = 0; k < 2; ++k) foot.value[k] += down * foot.slope[k];
        add(form.foot.z, foot, 1e-3 * sections.front().weight);
    }
    for (const Section& s : sections) {
        if (!axis.position.empty() && s.z - axis.position.back().z < 1e-3) continue;
        LocalLine line = find_local_line(sections, s.z, step);
        const bool at_breast = form.breast.diameter > 0 && s.z == form.breast.center.z;
        if (at_breast) line.value[2] = s.radius;
        add(s.z, line, at_breast ? kBreastSections * s.weight : s.weight);
    }
    make_monotone(axis.radius, weight);
    axis.breast = form.breast;
    return axis;
}

std::vector<StemAxis> find_stem_axes(std::span<const Vec3> points, const Terrain& terrain,
                                     const StemAxisSearch& search, const Context& ctx) {
    const StemScene scene = find_stem_scene(points, terrain, search.spacing, ctx);
    struct Found {
        StemAxis axis;
        double radius, above_ground;
    };
    std::vector<Found> found;
    double best = 0;  // evidence of the first stem
    for (const StemTrack& track : scene.tracks) {
        TraceOptions trace = scene.make_trace_options(terrain, track);
        if (search.root) {
            const Vec3d at = track.at(search.root->z);
            if (std::hypot(at.x - search.root->x, at.y - search.root->y) > kAtRoot * track.radius) continue;
            trace.foot = search.root->z;
        }
        const Evidence evidence = compute_evidence(track);
        if (!found.empty() && (evidence.seen < kAsWellSeen * best || evidence.inside > kMaxInside ||
                               track.radius < kOther * found.front().radius))
            continue;
        StemAxis axis = make_stem_axis(measure_stem(scene.wood, track, trace, {}));
        if (axis.position.empty()) continue;
        axis.track = track;
        const Vec3d foot = axis.position.front();
        const double low = find_base_height(scene.wood, track),
                     above_ground = low - scene.ground(terrain, foot);
        const auto is_same = [&](const Found& other) {
            const Vec3d d = foot - other.axis.position.front();
            return std::hypot(d.x, d.y) < kApart * (track.radius + other.radius);
        };
        if (std::ranges::any_of(found, is_same)) continue;
        if (!found.empty() && above_ground - found.front().above_ground > kHanging * scene.scale) continue;
        if (found.empty()) best = evidence.seen;
        found.push_back({std::move(axis), track.radius, above_ground});
        if (search.root) break;
    }
    std::ranges::stable_sort(found, std::ranges::greater{}, &Found::radius);
    std::vector<StemAxis> out;
    if (search.max_trees > 0 && found.size() > static_cast<std::size_t>(search.max_trees))
        found.resize(static_cast<std::size_t>(search.max_trees));
    for (Found& f : found) out.push_back(std::move(f.axis));
    return out;
}

}  // namespace coppice::extract_internal
