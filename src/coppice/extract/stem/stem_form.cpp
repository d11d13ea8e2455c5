#include "coppice/extract/stem/stem_form.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/error.h"
#include "coppice/base/median.h"
#include "coppice/extract/plot/terrain.h"
#include "coppice/extract/stem/stem_axis_internal.h"
#include "coppice/extract/stem/stem_form_internal.h"
#include "coppice/points/spacing.h"
#include "coppice/skeleton/measure.h"

namespace coppice {
namespace {

using namespace extract_internal;

constexpr std::size_t kMinPoints = 20;
constexpr std::size_t kEnd = 2000;    // number of points at an end among which outliers are searched
constexpr std::size_t kTogether = 5;  // maximum number of points close in height required to exclude outliers
constexpr double kMinStep = 0.1, kMaxStep = 0.5;
constexpr double kSteps = 40;  // [m] range of the distance of sections; number of sections over the height
constexpr double kLow = 1.1;
constexpr double kHigh = 1.5;  // [m] range about breast height in which the radii of a skeleton are averaged
constexpr double kSecondStem = 0.4;  // minimum radius of a second stem, relative to the first one

/// Returns the first height followed by enough close points to exclude an outlier; the heights are sorted.
double first_dense(std::span<const double> z, const HeightOrder& points) {
    const double reach = 0.03 * (points.high() - points.low()) + 0.05;
    const std::size_t together = std::clamp<std::size_t>(points.all().size() / 1000, 2, kTogether);
    for (std::size_t i = 0; i + together <= z.size(); ++i)
        if (std::abs(z[i + together - 1] - z[i]) <= reach) return z[i];
    return z.front();
}

/// Returns z [m] of the lowest point that is not an outlier.
double compute_min_height(const HeightOrder& points) {
    const auto end = points.all().first(std::min(points.all().size(), kEnd));
    std::vector<double> z;
    for (const Vec3 p : points.between(points.low(), end.back().z)) z.push_back(p.z);
    std::ranges::sort(z);
    return first_dense(z, points);
}

/// Returns the scale of the search heights: it is smaller for trees below ten metres, which have shorter
/// stems.
double compute_scale(const HeightOrder& points, double foot) {
    return points.all().empty() ? 1 : std::clamp((compute_max_height(points) - foot) / 10, 0.3, 1.0);
}

StemDiameter compute_diameter(const StemSection& s, Vec3d origin) {
    return {s.height,          2 * s.radius(),    2 * s.circle.deviation,
            s.circle.residual, s.circle.coverage, s.center + origin};
}

/// Returns the stem about a height from the sections within a metre of it; the initial track if there are
/// few.
StemTrack about(const StemTrack& track, std::span<const StemSection> sections, double height) {
    constexpr double kNear = 1;  // [m]
    StemTrack out;
    std::vector<double> radii;
    for (const StemSection& s : sections) {
        if (std::abs(s.height - height) > kNear) continue;
        out.sections.push_back(s);
        radii.push_back(s.radius());
    }
    if (radii.size() < 4 || out.sections.front().height > height || out.sections.back().height < height)
        return track;
    out.radius = median_in_place(radii);
    return out;
}

/// Returns the mean radius [m] of an axis between two heights, weighted by length; 0 if it does not extend
/// there.
double mean_radius(const Skeleton& s, const std::vector<NodeId>& axis, double low, double high) {
    double sum = 0, total = 0;
    for (std::size_t i = 1; i < axis.size(); ++i) {
        const Segment segment = s.segment(axis[i]);
        const double a = segment.a.z, b = segment.b.z, rise = b - a;
        if (!(rise > 0) || b < low || a > high) continue;
        const double t0 = std::max(low - a, 0.0) / rise, t1 = std::min(high - a, rise) / rise;
        const double part = (t1 - t0) * distance(Vec3d(segment.a), Vec3d(segment.b));
        sum += part * std::lerp(double{segment.radius_a}, double{segment.radius_b}, 0.5 * (t0 + t1));
        total += part;
    }
    return total > 0 ? sum / total : 0;
}

StemForm measure_form(const Skeleton& s, NodeId root, std::span<const float> reach) {
    StemForm out;
    out.foot = s.origin() + Vec3d(s.position(root));
    const auto axis = main_axis(s, root, reach);
    const double z = s.position(root).z;
    double radius = mean_radius(s, axis, z + kLow, z + kHigh);
    if (!(radius > 0)) radius = mean_radius(s, axis, z + kBreastHeight, z + kBreastHeight);
    for (const NodeId n : axis) {
        out.taper.push_back({double{s.position(n).z} - z, 2 * double{s.radius(n)}, 0, 0, 0,
                             s.origin() + Vec3d(s.position(n))});
    }
    if (radius > 0) {
        out.breast = {kBreastHeight, 2 * radius, 0, 0, 0, out.foot + Vec3d{0, 0, kBreastHeight}};
        for (std::size_t i = 1; i < out.taper.size(); ++i) {
            const StemDiameter &a = out.taper[i - 1], &b = out.taper[i];
            if (a.height > kBreastHeight || b.height < kBreastHeight) continue;
            const double t = b.height > a.height ? (kBreastHeight - a.height) / (b.height - a.height) : 0;
            out.breast.center = lerp(a.center, b.center, t);
            break;
        }
    }
    return out;
}

/// Returns whether a single circle in a slice is certainly a stem: it is round and hollow, and has points in
/// the lower and in the upper third of the slice.
bool is_stem_in_slice(const PointSet& set, const Box3& box, const FoundCircle& c, double noise) {
    constexpr double kMinCoverage = 0.4,
                     // minimum share of the circumference; maximum residual relative to the radius
        kMaxResidual = 0.06;
    constexpr double kWithin = 0.8, kMaxWithin = 0.1;  // relative radius of the core; maximum number of
                                                       // points in it per point on the circle
    constexpr std::uint32_t kMinOnCircle = 30;
    if (c.used < kMinOnCircle || c.coverage < kMinCoverage ||
        c.residual > std::max(kMaxResidual * c.radius, noise))
        return false;
    const float third = box.size().z / 3;
    std::size_t low = 0, high = 0, on = 0, within = 0;
    for (const Vec3 p : set.positions) {
        const double from_center = std::hypot(p.x - c.x, p.y - c.y);
        within += from_center < kWithin * c.radius;
        if (std::abs(from_center - c.radius) > 2 * noise) continue;
        ++on;
        low += p.z <= box.low.z + third;
        high += p.z >= box.high.z - third;
    }
    return low > 0 && high > 0 && static_cast<double>(within) <= kMaxWithin * static_cast<double>(on);
}

/// Returns half of the width [m] of the 90 % interval of the diameter.
double compute_margin(const StemDiameter& d) {
    constexpr double kOfModel = 0.025;  // [diameter] standard deviation of sections from circles on a line
    return kNineOfTen * std::hypot(d.deviation, kOfModel * d.diameter);
}

}  // namespace

double height_margin(double spacing) {
    constexpr double kMin = 0.02, kSpacings = 2;
    return kMin + kSpacings * spacing;
}

double StemDiameter::low() const { return std::max(diameter - compute_margin(*this), 0.0); }
double StemDiameter::high() const { return diameter + compute_margin(*this); }

namespace extract_internal {

std::vector<float> highest_below(const Skeleton& s) {
    std::vector<float> reach;
    for (const Vec3 p : s.positions()) reach.push_back(p.z);
    for (std::uint32_t i = s.size(); i-- > 0;) {
        if (s.is_root(NodeId(i))) continue;
        float& below = reach[s.parent(NodeId(i)).index()];
        below = std::max(below, reach[i]);
    }
    return reach;
}

std::vector<NodeId> main_axis(const Skeleton& s, NodeId root, std::span<const float> reach) {
    constexpr float kStemlike = 0.4f;  // relative to the radius of the thickest child
    std::vector<NodeId> axis{root};
    while (!s.is_tip(axis.back())) {
        NodeId next = s.leader(axis.back());
        const float least = kStemlike * s.radius(next);
        for (const NodeId child : s.children(axis.back()))
            if (s.radius(child) >= least && reach[child.index()] > reach[next.index()]) next = child;
        axis.push_back(next);
    }
    return axis;
}

double stem_noise(double spacing) { return std::clamp(0.25 * spacing, 0.005, 0.02); }

StemForm measure_stem(const HeightOrder& points, const StemTrack& track, const TraceOptions& trace,
                      Vec3d origin) {
    StemForm out;
    const Vec3d foot = track.at(trace.foot);
    out.foot = origin + foot;
    out.height = trace.top - trace.foot;
    const double step = std::clamp(out.height / kSteps, kMinStep, kMaxStep);
    const std::vector<StemSection> sections = trace_stem(points, track, step, trace);
    for (const StemSection& s : sections) out.taper.push_back(compute_diameter(s, origin));
    const DiameterAt breast =
        diameter_at(points, about(track, sections, kBreastHeight), kBreastHeight, trace);
    out.breast = {kBreastHeight,   breast.diameter, breast.deviation,
                  breast.residual, breast.coverage, origin + breast.center};
    return out;
}

double find_base_height(const HeightOrder& points, const StemTrack& track) {
    std::vector<double> z;
    for (const Vec3 p : points.all()) {
        if (double{p.z} > track.middle().z) continue;
        const Vec3d at = track.at(p.z);
        if (std::hypot(p.x - at.x, p.y - at.y) < 3 * track.radius + 0.05) z.push_back(p.z);
    }
    std::ranges::sort(z);
    return z.empty() ? track.middle().z : first_dense(z, points);
}

double compute_max_height(const HeightOrder& points) {
    const auto end = points.all().last(std::min(points.all().size(), kEnd));
    std::vector<double> z;
    for (const Vec3 p : points.between(end.front().z, points.high())) z.push_back(p.z);
    std::ranges::sort(z, std::ranges::greater{});
    return first_dense(z, points);
}

}  // namespace extract_internal

namespace extract_internal {

StemScene find_stem_scene(std::span<const Vec3> points, const Terrain& terrain, double spacing,
                          const Context& ctx) {
    const HeightOrder order(points, ctx);
    StemScene out{.lowest = points.empty() ? 0 : compute_min_height(order)};
    std::vector<float> height;
    std::vector<Vec3> above;
    for (const Vec3 p : order.all()) {
        const double h = double{p.z} - out.ground(terrain, Vec3d(p));
        if (terrain.is_ground && h < terrain.clearance) continue;
        above.push_back(p);
        height.push_back(static_cast<float>(h));
    }
    const double noise = stem_noise(spacing);
    out.wood = HeightOrder(above, ctx);
    out.trace = {.foot = out.lowest,
                 .top = above.empty() ? out.lowest : compute_max_height(out.wood),
                 .noise = noise,
                 .spacing = spacing};
    out.scale = compute_scale(out.wood, out.lowest);
    out.tracks = find_stems(
        above, height, {.min_radius = 0.008, .max_radius = 1.5, .noise = noise, .scale = out.scale}, ctx);
    for (StemTrack& track : out.tracks) track.raise(out.ground(terrain, track.middle()));
    return out;
}

TraceOptions StemScene::make_trace_options(const Terrain& terrain, const StemTrack& track) const {
    TraceOptions out = trace;
    out.foot = terrain.is_ground ? ground(terrain, track.at(ground(terrain, track.middle())))
                                 : find_base_height(wood, track);
    return out;
}

StemForm stem_form_on(const Terrain& terrain, const PointSet& set, const Context& ctx) {
    const double spacing = median_spacing(set, ctx);
    const StemScene scene = find_stem_scene(set.positions, terrain, spacing, ctx);
    const std::vector<StemTrack>& stems = scene.tracks;
    StemForm out;
    if (stems.empty()) {
        const Vec3d low(*std::ranges::min_element(set.positions, {}, &Vec3::z));
        out.foot = set.origin + Vec3d{low.x, low.y, scene.lowest};
        out.height = scene.trace.top - scene.lowest;
    } else {
        out = measure_stem(scene.wood, stems.front(), scene.make_trace_options(terrain, stems.front()),
                           set.origin);
    }
    out.height_low = std::max(out.height - height_margin(spacing), 0.0);
    out.height_high = out.height + height_margin(spacing);
    out.on_ground = terrain.is_ground;
    for (const StemTrack& t : stems) out.stems += t.radius >= kSecondStem * stems.front().radius;
    return out;
}

}  // namespace extract_internal

StemForm stem_form(const PointSet& set, const Context& ctx) {
    if (set.size() < kMinPoints) {
        throw InvalidInput(fmt::format("forestry: the cloud has {} points, but a stem needs at least {}",
                                       set.size(), kMinPoints));
    }
    return stem_form_on(find_terrain(set.positions, ctx), set, ctx);
}

std::vector<StemForm> slice_forms(const PointSet& set, const Context& ctx) {
    constexpr float kThickest = 1;  // [m]
    const Box3 box = bounds(set);
    std::vector<StemForm> out;
    if (set.size() < kMinPoints || box.size().z > kThickest ||
        2 * box.size().z > std::max(box.size().x, box.size().y))
        return out;
    const StemSearch search{
        .min_radius = 0.02, .max_radius = 1.5, .noise = stem_noise(median_spacing(set, ctx))};
    for (const FoundCircle& c : circles_in_slice(set.positions, search, ctx)) {
        if (!is_stem_in_slice(set, box, c, search.noise)) continue;
        StemForm form;
        form.foot = set.origin + Vec3d{c.x, c.y, box.low.z};
        form.stems = 1;
        form.breast = {0, 2 * c.radius, 2 * c.deviation, c.residual, c.coverage, form.foot};
        out.push_back(std::move(form));
    }
    return out;
}

std::vector<StemForm> stem_forms(const Skeleton& skeleton) {
    std::vector<StemForm> out;
    std::vector<std::uint32_t> of_root(skeleton.size(), 0);
    const std::vector<NodeId> roots = tree_roots(skeleton);
    const std::vector<float> reach = highest_below(skeleton);
    for (const NodeId n : nodes(skeleton)) {
        if (!skeleton.is_root(n)) continue;
        of_root[n.index()] = static_cast<std::uint32_t>(out.size());
        out.push_back(measure_form(skeleton, n, reach));
    }
    for (const NodeId n : nodes(skeleton)) {
        StemForm& form = out[of_root[roots[n.index()].index()]];
        const double top = skeleton.origin().z + double{skeleton.position(n).z} + double{skeleton.radius(n)};
        form.height = std::max(form.height, top - form.foot.z);
        if (skeleton.is_root(n) || !(form.breast.diameter > 0)) continue;
        const Segment s = skeleton.segment(n);
        const double at = form.foot.z - skeleton.origin().z + kBreastHeight;
        if (s.a.z <= at && s.b.z > at && double{s.radius_b} >= kSecondStem * 0.5 * form.breast.diameter)
            ++form.stems;
    }
    return out;
}

std::optional<Skeleton> stem_skeleton(const StemForm& form) {
    constexpr double kThinnest = 1e-4;  // [m]
    const StemAxis axis = make_stem_axis(form);
    if (axis.position.empty()) return std::nullopt;
    std::vector<NodeId> parent;
    std::vector<Vec3> position;
    std::vector<float> radius;
    for (std::size_t i = 0; i < axis.position.size(); ++i) {
        parent.push_back(i == 0 ? NodeId::none() : NodeId(static_cast<std::uint32_t>(i) - 1));
        position.emplace_back(Vec3d(axis.position[i]) - form.foot);
        radius.push_back(static_cast<float>(std::max(axis.radius[i], kThinnest)));
    }
    return Skeleton(std::move(parent), std::move(position), std::move(radius), form.foot);
}

}  // namespace coppice
