#include "routes_grid.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "clock.h"
#include "coppice/base/error.h"
#include "coppice/base/random.h"
#include "coppice/field/convolution_field.h"
#include "coppice/skeleton/prepare.h"

namespace coppice::bench {
namespace {

// Maximum distance of the surface from its axis; with the default options its distance is one radius.
constexpr float kReach = 1.6f;  // [radii]

Box3 surface_box(const Skeleton& skeleton) {
    Box3 box;
    for (const NodeId n : nodes(skeleton)) {
        box.extend(capsule_box(skeleton.position(n), skeleton.position(n), kReach * skeleton.radius(n)));
    }
    return box;
}

FieldOptions round_ends(FieldOptions field) {
    field.root_extension = -1;
    return field;
}

/// Returns boxes around sections of the branches, not much longer than their thickness or than the blocks.
std::vector<Box3> pieces(const Skeleton& skeleton, const ConvolutionField& field, const FieldOptions& options,
                         float block) {
    std::vector<Box3> out;
    for (const NodeId n : nodes(skeleton)) {
        const float r = skeleton.radius(n);
        const bool is_end = skeleton.is_root(n) || skeleton.is_tip(n);
        // The line extends beyond an end, in a direction that the box does not depend on.
        const float reach = (options.support + (is_end ? field.tip_extension() : 0)) * r;
        out.push_back(capsule_box(skeleton.position(n), skeleton.position(n), reach));
        if (skeleton.is_root(n)) continue;
        const Segment s = skeleton.segment(n);
        const float thick = options.support * std::max(s.radius_a, s.radius_b);
        const auto count = static_cast<int>(std::ceil(length(s.b - s.a) / std::max(thick, block))) + 1;
        for (int i = 0; i < count; ++i) {
            const auto at = [&](int k) {
                return lerp(s.a, s.b, static_cast<float>(k) / static_cast<float>(count));
            };
            out.push_back(capsule_box(at(i), at(i + 1), thick));
        }
    }
    return out;
}

/// Samples every segment at every point, independent of the block.
struct EverySegment {
    const ConvolutionField& field;

    float level() const { return field.level(); }
    void sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
        field.sample(0, points, out);
    }
};

PolygonizeOptions cutting(const Grid& grid, const MeshOptions& options) {
    return {.cell = grid.cell, .refinements = options.tetra.march.refinements};
}

}  // namespace

std::uint64_t Grid::corners() const {
    std::uint64_t product = 1;
    for (int axis = 0; axis < 3; ++axis) {
        product *= static_cast<std::uint64_t>(std::lround(std::ceil(box.size()[axis] / cell - 1e-3f))) + 1;
    }
    return product;
}

Grid cube_about(const Skeleton& skeleton, std::uint32_t corners) {
    const Box3 box = surface_box(skeleton);
    const Vec3 size = box.size();
    const float half = 0.5f * std::max({size.x, size.y, size.z});
    const Vec3 c = box.center();
    return {Box3{c, c}.inflated(half), 2 * half / static_cast<float>(corners - 1)};
}

Grid box_about(const Skeleton& skeleton, float cell) { return {surface_box(skeleton), cell}; }

GridResult mesh_by_grid(const Skeleton& skeleton, const Grid& grid, const MeshOptions& options,
                        const Context& ctx) {
    GridResult out;
    const auto stage = [&](const char* name, const auto& work) {
        const Clock clock;
        work();
        out.stages.emplace_back(name, clock.seconds());
    };
    const FieldOptions field_options = round_ends(options.field);
    const PolygonizeOptions cut = cutting(grid, options);
    constexpr float kBlock = 8;  // [cells]
    PolygonizeRegions regions;
    PrepareResult prepared = [&] {
        const Clock clock;
        PrepareResult p = prepare(skeleton, options.prepare);
        out.stages.emplace_back("prepare", clock.seconds());
        return p;
    }();
    ConvolutionField field(prepared.skeleton, field_options, ctx);
    stage("lists", [&] {
        const auto near = pieces(prepared.skeleton, field, field_options, kBlock * grid.cell);
        regions = regions_touching(grid.box, near, cut, ctx);
        // A corner shared by two blocks must have the same value in both.
        std::vector<Box3> boxes = regions.box;
        for (Box3& b : boxes) b = b.inflated(0.01f * grid.cell);
        field.set_regions(boxes, ctx);
    });
    const std::size_t longest = longest_list(regions.box.size());
    for (std::uint32_t r = 0; r < field.region_count(); ++r) {
        if (field.candidates(r).size() >= longest) {
            throw Error("the grid is too coarse: more segments meet in a block than a list can store");
        }
    }
    stage("extract", [&] { out.surface = polygonize(FieldRef(field), grid.box, regions, cut, ctx); });
    return out;
}

BruteForce time_brute_force(const Skeleton& skeleton, const Grid& grid, const MeshOptions& options,
                            double limit, const Context& ctx) {
    const PrepareResult prepared = prepare(skeleton, options.prepare);
    ConvolutionField field(prepared.skeleton, round_ends(options.field), ctx);
    const std::array everywhere{grid.box.inflated(grid.box.diagonal())};
    field.set_regions(everywhere, ctx);
    const EverySegment every{field};
    const PolygonizeOptions cut = cutting(grid, options);
    const PolygonizeRegions all = regions_touching(grid.box, everywhere, cut, ctx);
    const std::size_t total = all.block.size();
    const auto time_some = [&](std::size_t count) {
        const CounterRandom random(1, 0);
        PolygonizeRegions some;
        for (std::size_t i = 0; i < count; ++i) {
            const double place = (static_cast<double>(i) + random.uniform(i)) / static_cast<double>(count);
            some.block.push_back(all.block[static_cast<std::size_t>(place * static_cast<double>(total))]);
        }
        const Clock clock;
        polygonize(FieldRef(every), grid.box, some, cut, ctx);
        return clock.seconds();
    };
    const std::size_t few = std::min<std::size_t>(total, 64);
    const double each = time_some(few) / static_cast<double>(few);
    const auto count = static_cast<std::size_t>(
        std::clamp(limit / each, static_cast<double>(few), static_cast<double>(total)));
    const double share = static_cast<double>(count) / static_cast<double>(total);
    return {time_some(count) / share, share};
}

}  // namespace coppice::bench
