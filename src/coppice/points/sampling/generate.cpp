#include "coppice/points/sampling/generate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/progress.h"
#include "coppice/points/sampling/dart_throwing_internal.h"
#include "coppice/points/sampling/eliminate_internal.h"
#include "coppice/points/sampling/independent_internal.h"

namespace coppice {
namespace points_internal {
namespace {

constexpr double kVoxels =
    64 * 64 *
    64;  // number of voxels to resolve a solid for rejection sampling; more cost more than they save
constexpr std::size_t kCandidates = 4;  // number of candidates per point of blue noise

Cells coarse_cells(const PointRegion& region, const GenerateOptions& o, const Context& ctx) {
    const Vec3 size = region.box.size();
    const double longest = std::max({size.x, size.y, size.z});
    const double wanted = std::clamp(static_cast<double>(o.count), 32768.0, kVoxels);
    const Voxels voxels = o.resolution > 0 ? Voxels::over(region.box, 1e9, longest / o.resolution)
                                           : Voxels::over(region.box, wanted, 0);
    check_memory((Voxels::bytes_per_voxel() + sizeof(Cell)) * static_cast<double>(voxels.count()),
                 o.max_memory);
    return Cells(region, voxels, ctx);
}

constexpr double kGoodShare = 0.15;  // minimum share of the volume of the cells for few rejected draws
// minimum share of samples inside for a reliable estimate of the capacity
constexpr double kSoundShare = 0.005;

// Progress at the end of each stage.
constexpr float kSurveyed = 0.05f;
constexpr float kBlueDrawn = 0.2f;

/// Cells and their capacity.
struct Survey {
    Cells cells;
    Capacity capacity;
};

/// Subdivides cells until at least the given share of their volume has density, as required for thin shells.
Survey survey_region(const PointRegion& region, const GenerateOptions& o, double share, const Context& ctx) {
    Survey survey{coarse_cells(region, o, ctx), {}};
    Cells& cells = survey.cells;
    for (int subdivisions = 0;; ++subdivisions) {
        survey.capacity = measure_capacity(region, cells, static_cast<std::uint64_t>(o.seed), ctx);
        const double whole = cells.size() * std::pow(cells.edge(), 3);
        const bool filled = survey.capacity.volume > share * whole;
        if (filled || subdivisions == 3 || cells.size() > 500000 || cells.size() == 0) break;
        cells.subdivide(
            region, [](const Cell&) { return 0u; }, ctx);
    }
    if (!(survey.capacity.volume > 0)) refuse_empty_region();
    ctx.report(kSurveyed);
    return survey;
}

/// Computes the density law; the number of samples increases with the number of points.
DensityLaw make_law(const PointRegion& region, const GenerateOptions& o, const Survey& survey,
                    const Context& ctx) {
    constexpr int kSamplesPerPoint = 16;
    constexpr std::size_t kPointsOfShell = 40, kMaxShells = 32;
    const auto samples = static_cast<std::uint32_t>(std::clamp(o.count, 1024, 32768)) * kSamplesPerPoint;
    const auto shells =
        std::clamp<std::size_t>(static_cast<std::size_t>(o.count) / kPointsOfShell, 1, kMaxShells);
    const Capacity close =
        measure_capacity(region, survey.cells, static_cast<std::uint64_t>(o.seed) + 1, ctx, samples);
    return density_law(close.met.empty() ? survey.capacity : close, shells);
}

RadialKernel make_kernel(const GenerateOptions& o, float distance) {
    if (o.pattern != PointPattern::clustered) return RadialKernel::disk(distance);
    const float reach = o.cluster_reach > 0 ? o.cluster_reach : 4 * distance;
    if (!(reach > distance)) throw InvalidInput("points: cluster_reach must be above distance");
    return RadialKernel::clustered(distance, reach, o.cluster_gain);
}

GenerateResult generate_by_lane(const PointRegion& region, const GenerateOptions& o, const Context& ctx) {
    GenerateResult result;
    float distance = o.distance;
    std::optional<Survey> survey;
    if (o.distance <= 0) {
        if (o.count == 0)
            throw InvalidInput("points: a count of 0 fills the solid, which needs a distance above 0");
        survey = survey_region(region, o, kSoundShare, ctx);
        // Clusters need space for dense and empty regions.
        const double share = o.pattern == PointPattern::clustered ? o.spacing / 3 : o.spacing;
        distance = static_cast<float>(share * survey->capacity.packing_distance(o.count));
    }
    const RadialKernel kernel = make_kernel(o, distance);
    DartThrowingOptions lane_options;
    lane_options.count = o.count;
    lane_options.resolution = o.resolution;
    lane_options.seed = o.seed;
    lane_options.max_memory = o.max_memory;
    const Context sampling = narrow_progress(ctx, survey ? kSurveyed : 0, 1);
    DartThrowingResult placed;
    if (survey) {
        const DensityLaw law = make_law(region, o, *survey, ctx);
        placed = sample_lane_in_cells(region, kernel, lane_options, law, std::move(survey->cells), sampling);
    } else {
        placed = sample_dart_throwing(region, kernel, lane_options, sampling);
    }
    result.points = std::move(placed.points);
    result.stop = placed.stop;
    result.distance = placed.distance;
    result.tries = placed.tries;
    return result;
}

GenerateResult generate_independent(const PointRegion& region, const GenerateOptions& o, const Context& ctx) {
    if (o.count == 0) throw InvalidInput("points: count must be above 0 for this pattern");
    const double count = o.count;
    const bool blue = o.pattern == PointPattern::blue_noise;
    check_memory(blue ? independent_bytes(kCandidates * count) + eliminate_bytes(kCandidates * count)
                      : independent_bytes(count),
                 o.max_memory);
    const Survey survey = survey_region(region, o, kGoodShare, ctx);
    const auto seed = static_cast<std::uint64_t>(o.seed);
    const auto wanted = static_cast<std::size_t>(o.count) * (blue ? kCandidates : 1);
    const Context drawing = narrow_progress(ctx, kSurveyed, blue ? kBlueDrawn : 1);
    Draws draws = o.pattern == PointPattern::jittered
                      ? draw_jittered(region, survey.capacity, count, seed, drawing)
                      : draw_independent(region, survey.cells, wanted, seed, drawing);
    GenerateResult result;
    result.tries = draws.tries;
    if (blue) {
        // The distance of the densest lattice is an upper bound for every set.
        const double ideal =
            survey.capacity.packing_distance(count) * std::cbrt(std::numbers::pi / std::sqrt(18.0) / 0.384);
        draws.points = eliminate(draws.points, static_cast<std::size_t>(o.count), ideal / 2,
                                 narrow_progress(ctx, kBlueDrawn, 1));
    }
    result.points.positions = std::move(draws.points);
    const bool enough =
        o.pattern == PointPattern::jittered || result.points.size() == static_cast<std::size_t>(o.count);
    result.stop = enough ? PointStop::count_reached : PointStop::stalled;
    check_in(ctx, 1, 1);
    return result;
}

}  // namespace
}  // namespace points_internal

GenerateResult generate(const PointRegion& region, const GenerateOptions& options, const Context& ctx) {
    check_fields(options, "points");
    points_internal::check_box(region.box);
    const bool by_lane =
        options.pattern == PointPattern::poisson_disk || options.pattern == PointPattern::clustered;
    return by_lane ? points_internal::generate_by_lane(region, options, ctx)
                   : points_internal::generate_independent(region, options, ctx);
}

GenerateResult generate(const FieldRef& field, const Box3& box, const GenerateOptions& options,
                        const Context& ctx) {
    check_fields(options, "points");
    const DensityCurve curve(options.density, field.level(), options.width, options.power);
    return generate(PointRegion{field, box, curve}, options, ctx);
}

void list_fields(GenerateOptions& o, FieldList& list) {
    list.add(Field{"pattern", "Distribution of the points relative to each other."}, o.pattern);
    list.add(Field{"density", "Density of the points as a function of the value of the field."}, o.density);
    list.add(Field{"width", "Width of a shell at the boundary, in units of the value of the field.",
                   Unit::none, 1e-6, 1e6},
             o.width);
    list.add(
        Field{"power", "Exponent of the value in proportional and inverse densities.", Unit::none, 0, 16},
        o.power);
    list.add(Field{"count", "Number of points; 0 places as many as keep the distance.", Unit::none, 0, 1e8},
             o.count);
    list.add(Field{"distance", "Minimum distance between points; 0 computes it from the spacing.",
                   Unit::metre, 0, 1e9},
             o.distance);
    list.add(Field{"spacing",
                   "Minimum distance between points, relative to that at which the points fill the region.",
                   Unit::none, 0, 1},
             o.spacing);
    list.add(Field{"cluster_reach",
                   "Distance up to which a point of a cluster attracts others; 0 uses four times the minimum "
                   "distance.",
                   Unit::metre, 0, 1e9},
             o.cluster_reach);
    list.add(
        Field{"cluster_gain", "Factor by which a point increases the density near it.", Unit::none, 0, 1e4},
        o.cluster_gain);
    list.add(
        Field{"resolution", "Number of voxels along the longest side of the box; 0 chooses it automatically.",
              Unit::none, 0, 2048},
        o.resolution);
    list.add(Field{"seed", "Seed of the random points.", Unit::none, 0, 2147483647}, o.seed);
    list.add(Field{"max_memory", "Maximum memory in MiB.", Unit::none, 1, 1e6}, o.max_memory);
}

}  // namespace coppice
