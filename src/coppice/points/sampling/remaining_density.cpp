#include "coppice/points/sampling/remaining_density.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "coppice/base/parallel.h"
#include "coppice/points/sampling/point_grid_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kBatch = 256;  // number of evaluations of the field per call

/// Computes the densities of the field, 0 outside the box.
void sample_densities(const PointRegion& region, std::span<const Vec3> places, std::span<double> out) {
    std::array<FieldSample, kBatch> samples;
    const std::span<FieldSample> all(samples.data(), places.size());
    region.field.sample(0, places, all);
    for (std::size_t i = 0; i < places.size(); ++i)
        out[i] = region.contains(places[i]) ? region.density.at(all[i].value) : 0;
}

}  // namespace

std::vector<double> remaining_density(const PointRegion& region, const RadialKernel& kernel,
                                      const PointSet& points, std::span<const Vec3> places, double max_factor,
                                      const Context& ctx) {
    std::vector<Vec3> world;
    if (kernel.reach() > 0) {
        for (const Vec3 p : points.positions) world.push_back(Vec3(points.origin + Vec3d(p)));
    }
    const points_internal::PointGrid grid(world, std::max(kernel.reach(), 1e-9), ctx);
    std::vector<double> out(places.size());
    parallel_for_ranges(ctx, places.size(), kBatch, [&](IndexRange range) {
        if (ctx.stop.stop_requested()) return;
        const auto here = std::span(out).subspan(range.begin, range.size());
        sample_densities(region, places.subspan(range.begin, range.size()), here);
        for (std::size_t i = 0; i < here.size(); ++i) {
            double factor = 1;
            if (!(here[i] > 0) || world.empty()) continue;
            grid.visit(places[range.begin + i], kernel.reach(), [&](std::uint32_t, double squared) {
                const double distance = std::sqrt(squared);
                factor *= distance < kernel.core() ? 0 : kernel.at(distance);
                return factor > 0;
            });
            here[i] *= std::min(factor, max_factor);
        }
    });
    ctx.throw_if_cancelled();
    return out;
}

}  // namespace coppice
