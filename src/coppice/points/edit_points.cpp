#include "coppice/points/edit_points.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "coppice/base/check_fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/progress.h"
#include "coppice/base/random.h"

namespace coppice {
namespace {

constexpr std::uint64_t kStage = 0x7468696e;

std::vector<std::uint32_t> indices_inside(const PointSet& points, const FieldRef& solid, const Context& ctx) {
    constexpr std::size_t kBatch = 256;
    Buffer<std::uint8_t> inside(points.size());
    parallel_for_ranges(ctx, points.size(), kBatch, [&](IndexRange range) {
        std::array<Vec3, kBatch> place;
        std::array<FieldSample, kBatch> samples;
        for (std::size_t i = range.begin; i < range.end; ++i) place[i - range.begin] = Vec3(points.world(i));
        solid.sample(0, std::span(place).first(range.size()), std::span(samples).first(range.size()));
        for (std::size_t i = range.begin; i < range.end; ++i) {
            inside[i] = samples[i - range.begin].value > solid.level();
        }
    });
    std::vector<std::uint32_t> indices;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (inside[i] != 0) indices.push_back(static_cast<std::uint32_t>(i));
    }
    return indices;
}

}  // namespace

PointSet remove_random(const PointSet& points, const FieldRef& solid, const RemoveRandomOptions& options,
                       const Context& ctx) {
    check_fields(options, "thin");
    std::vector<std::uint32_t> inside = indices_inside(points, solid, ctx);
    const auto gone =
        static_cast<std::ptrdiff_t>(std::llround(static_cast<double>(inside.size()) * options.percent / 100));
    const CounterRandom random(static_cast<std::uint64_t>(options.seed), kStage);
    const auto key = [&](std::uint32_t i) { return std::pair(random.bits(i), i); };
    std::nth_element(inside.begin(), inside.begin() + gone, inside.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    std::vector<bool> removed(points.size());
    std::for_each(inside.begin(), inside.begin() + gone, [&](std::uint32_t i) { removed[i] = true; });
    check_in(ctx, 1, 1);
    PointSet out;
    out.origin = points.origin;
    out.positions.reserve(points.size() - static_cast<std::size_t>(gone));
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!removed[i]) out.positions.push_back(points.positions[i]);
    }
    return out;
}

PointSet densified(const PointSet& points, const PointRegion& region, const RadialKernel& kernel,
                   const DartThrowingOptions& options, const Context& ctx) {
    return merged(points, sample_dart_throwing(region, kernel, points, options, ctx).points);
}

void list_fields(RemoveRandomOptions& o, FieldList& list) {
    list.add(Field{"percent", "Percentage of the points inside to remove.", Unit::none, 0, 100}, o.percent);
    list.add(Field{"seed", "Seed of the random selection.", Unit::none, 0, 2147483647}, o.seed);
}

}  // namespace coppice
