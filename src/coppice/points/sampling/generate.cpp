#include "coppice/points/sampling/generate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/points/sampling/eliminate_internal.h"
#include "coppice/points/sampling/independent_internal.h"
#include "coppice/points/sampling/lane_internal.h"

namespace coppice {
namespace points_internal {
namespace {

constexpr double kVoxels =
    64 * 64 * 64;                       // resolve a solid for rejection; finer ones cost more than they save
constexpr std::size_t kCandidates = 4;  // for each point of blue noise

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

constexpr double kGoodShare = 0.15;    // of the cells' volume: draws in vain are then few
constexpr double kSoundShare = 0.005;  // enough of the sampled points lie inside to tell the room by them

/// The cells and what they have room for; cells are cut until the given share of them is filled, as thin
/// shells need.
struct Survey {
    Survey(const PointRegion& region, const GenerateOptions& o, double share, const Context& ctx)
        : cells(coarse_cells(region, o, ctx)) {
        for (int cuts = 0;; ++cuts) {
            room = measure_room(region, cells, static_cast<std::uint64_t>(o.seed));
            const double whole = cells.size() * std::pow(cells.edge(), 3);
            const bool filled = room.volume > share * whole;
            if (filled || cuts == 3 || cells.size() > 500000 || cells.size() == 0) break;
            cells.subdivide(
                region, [](const Cell&) { return 0u; }, ctx);
        }
        if (!(room.volume > 0)) {
            throw InvalidInput(
                "points: the density is 0 all over the box, as far as its grid shows; check the box and the "
                "width, or "
                "give a higher resolution");
        }
    }
    Cells cells;
    Room room;
};

GenerateResult by_lane(const PointRegion& region, const GenerateOptions& o, const Context& ctx) {
    GenerateResult result;
    result.distance = o.distance;
    std::optional<Survey> survey;
    if (o.distance <= 0) {
        if (o.count == 0)
            throw InvalidInput("points: a count of 0 fills the solid, which needs a distance above 0");
        survey.emplace(region, o, kSoundShare, ctx);
        // Clusters need room to be dense in some places and empty in others.
        const double share = o.pattern == PointPattern::clustered ? o.spacing / 3 : o.spacing;
        result.distance = static_cast<float>(share * survey->room.packing_distance(o.count));
    }
    RadialKernel kernel = RadialKernel::disk(result.distance);
    if (o.pattern == PointPattern::clustered) {
        const float reach = o.cluster_reach > 0 ? o.cluster_reach : 4 * result.distance;
        if (!(reach > result.distance)) {
            throw InvalidInput("points: cluster_reach must be above distance");
        }
        kernel = RadialKernel::clustered(result.distance, reach, o.cluster_gain);
    }
    LaneOptions lane_options;
    lane_options.count = o.count;
    lane_options.resolution = o.resolution;
    lane_options.seed = o.seed;
    lane_options.max_memory = o.max_memory;
    LaneResult placed = survey ? lane_with_cells(region, kernel, lane_options, std::move(survey->cells), ctx)
                               : lane(region, kernel, lane_options, ctx);
    result.points = std::move(placed.points);
    result.stop = placed.stop;
    result.tries = placed.tries;
    return result;
}

GenerateResult independent(const PointRegion& region, const GenerateOptions& o, const Context& ctx) {
    if (o.count == 0) throw InvalidInput("points: count must be above 0 for this pattern");
    const double count = o.count;
    const bool blue = o.pattern == PointPattern::blue_noise;
    check_memory(blue ? independent_bytes(kCandidates * count) + eliminate_bytes(kCandidates * count)
                      : independent_bytes(count),
                 o.max_memory);
    const Survey survey(region, o, kGoodShare, ctx);
    const auto seed = static_cast<std::uint64_t>(o.seed);
    const auto wanted = static_cast<std::size_t>(o.count) * (blue ? kCandidates : 1);
    Draws draws = o.pattern == PointPattern::jittered
                      ? draw_jittered(region, survey.room, count, seed, ctx)
                      : draw_independent(region, survey.cells, wanted, seed, ctx);
    GenerateResult result;
    result.tries = draws.tries;
    if (blue) {
        // The distance of the densest lattice bounds that of any set.
        const double ideal =
            survey.room.packing_distance(count) * std::cbrt(std::numbers::pi / std::sqrt(18.0) / 0.384);
        draws.points = eliminate(draws.points, static_cast<std::size_t>(o.count), ideal / 2, ctx);
    }
    result.points.positions = std::move(draws.points);
    const bool enough =
        o.pattern == PointPattern::jittered || result.points.size() == static_cast<std::size_t>(o.count);
    result.stop = enough ? PointStop::count_reached : PointStop::stalled;
    ctx.report(1);
    return result;
}

}  // namespace
}  // namespace points_internal

GenerateResult generate(const PointRegion& region, const GenerateOptions& options, const Context& ctx) {
    check_fields(options, "points");
    points_internal::check_box(region.box);
    const bool by_lane =
        options.pattern == PointPattern::poisson_disk || options.pattern == PointPattern::clustered;
    return by_lane ? points_internal::by_lane(region, options, ctx)
                   : points_internal::independent(region, options, ctx);
}

GenerateResult generate(const FieldRef& field, const Box3& box, const GenerateOptions& options,
                        const Context& ctx) {
    check_fields(options, "points");
    const DensityCurve curve(options.density, field.level(), options.width, options.power);
    return generate(PointRegion{field, box, curve}, options, ctx);
}

}  // namespace coppice
