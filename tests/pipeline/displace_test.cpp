#include "coppice/pipeline/displace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "coppice/measure/intersections.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/mesh/topology.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "errors.h"
#include "zoo.h"

namespace coppice {
namespace {

using test::error_of;

constexpr float kRadius = 0.1f;

Skeleton stem() {
    return {{NodeId::none(), NodeId(0), NodeId(1)},
            {{0, 0, 0}, {0, 0, 0.5f}, {0, 0, 1}},
            {kRadius, kRadius, kRadius}};
}

MeshOptions with_bark(float tile, int levels = 3) {
    MeshOptions options;
    options.levels = levels;
    options.texture = {TextureCoordinates::bark, tile};
    return options;
}

/// Heights of a function of the position in the tile, with values from 0 to 1.
template <class Height>
HeightTexture make_texture(int width, int height, float scale, const Height& at) {
    HeightTexture out{width, height, scale, {}};
    for (int row = 0; row < height; ++row) {
        for (int x = 0; x < width; ++x) {
            const double value = at((x + 0.5) / width, 1 - (row + 0.5) / height);
            out.heights.push_back(static_cast<std::uint16_t>(std::lround(65535 * value)));
        }
    }
    return out;
}

/// One wave around the tile.
HeightTexture make_wave(float scale) {
    return make_texture(256, 4, scale,
                        [](double u, double) { return 0.5 + 0.5 * std::sin(2 * std::numbers::pi * u); });
}

/// Steep bumps.
HeightTexture make_bumps(float scale) {
    return make_texture(64, 64, scale, [](double u, double v) {
        return 0.5 + 0.5 * std::sin(20 * std::numbers::pi * u) * std::sin(16 * std::numbers::pi * v);
    });
}

std::uint64_t count_crossings(const PolygonMesh& mesh) {
    return crossing_faces(SurfaceTree(mesh), 1'000'000).pairs.size();
}

// One tile around the stem: radii follow the wave, half of the scale to both sides.
TEST(Displace, FollowsTheWave) {
    constexpr double kScale = 0.02;
    const Skeleton skeleton = stem();
    MeshResult made = mesh_skeleton(skeleton, with_bark(2 * std::numbers::pi_v<float> * kRadius));
    const QuadMesh before = made.quads().mesh;
    const DisplaceReport report = displace_surface(made, skeleton, make_wave(kScale));
    const QuadMesh& mesh = made.quads().mesh;
    double low = 1, high = 0;
    for (std::size_t f = 0; f < mesh.quads.size(); ++f) {
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3 p = mesh.positions[mesh.quads[f][k]], from = before.positions[mesh.quads[f][k]];
            if (p.z < 0.2f || p.z > 0.8f) continue;
            const double offset = std::hypot(p.x, p.y) - std::hypot(from.x, from.y);
            const double u = made.texture->points[4 * f + k].u;
            ASSERT_NEAR(offset, 0.5 * kScale * std::sin(2 * std::numbers::pi * u), 0.01 * kScale);
            low = std::min(low, offset);
            high = std::max(high, offset);
        }
    }
    // 64 sides have a vertex within a quarter of 1/64 of a period of the extremes.
    EXPECT_NEAR(high - low, kScale, 0.01 * kScale);
    EXPECT_NEAR(report.max_offset, kScale / 2, 0.01 * kScale);
    // The rims of the ends move, and the vertices within do not: some of them are too close.
    EXPECT_LT(report.pulled_back, report.displaced / 20);
    EXPECT_FLOAT_EQ(static_cast<float>(report.scale), 0.02f);
    // The area of the section grows by the mean square of the offset: (0.01^2 / 2) / 0.1^2 = 0.5 %.
    EXPECT_NEAR(report.volume_after / report.volume_before, 1.005, 0.002);
}

TEST(Displace, KeepsFlatBasesAndTheReachOfTips) {
    const Skeleton skeleton = stem();
    MeshResult made = mesh_skeleton(skeleton, with_bark(0.1f));
    const auto extent = [&] {
        Box3 box;
        for (const Vec3 p : made.quads().mesh.positions) box.extend(p);
        return box;
    };
    const Box3 before = extent();
    displace_surface(made, skeleton, make_bumps(0.01f));
    EXPECT_NEAR(extent().low.z, before.low.z, 1e-5);
    EXPECT_NEAR(extent().high.z, before.high.z, 1e-3);
}

TEST(Displace, IsLimitedByTheRadius) {
    const Skeleton skeleton = stem();
    for (const float share : {0.05f, 0.2f}) {
        MeshResult made = mesh_skeleton(skeleton, with_bark(2 * std::numbers::pi_v<float> * kRadius));
        const DisplaceReport report =
            displace_surface(made, skeleton, make_wave(10), {.displace_share = share});
        EXPECT_NEAR(report.max_offset, share * kRadius, 0.02 * share * kRadius);
    }
}

TEST(Displace, FiltersDetailsBelowTheSpacing) {
    const Skeleton skeleton = stem();
    MeshResult made = mesh_skeleton(skeleton, with_bark(2 * std::numbers::pi_v<float> * kRadius, 1));
    // 512 stripes over 16 sides: their mean is that of the texture, up to half a stripe of 32 at the ends of
    // a rectangle: 0.02 m / 2 / 64.
    const HeightTexture stripes =
        make_texture(1024, 1, 0.02f, [](double u, double) { return static_cast<int>(u * 1024) % 2; });
    EXPECT_LT(displace_surface(made, skeleton, stripes).max_offset, 1.6e-4);
}

TEST(Displace, KeepsSurfacesClosedAndFreeOfCrossings) {
    for (const MeshMethod method : {MeshMethod::quads, MeshMethod::tetrahedra}) {
        std::uint64_t pulled_back = 0;
        for (const auto& [name, skeleton] : skeleton_zoo()) {
            MeshOptions options = with_bark(0.1f, 2);
            options.method = method;
            MeshResult made = mesh_skeleton(skeleton, options);
            const PolygonMesh before = to_polygons(made);
            const DisplaceReport report =
                displace_surface(made, skeleton, make_bumps(0.05f), {.displace_share = 0.5f});
            const PolygonMesh after = to_polygons(made);
            EXPECT_EQ(topology(after).watertight(), topology(before).watertight()) << name;
            EXPECT_LE(count_crossings(after), count_crossings(before)) << name;
            pulled_back += report.pulled_back;
        }
        EXPECT_GT(pulled_back, 0u);  // otherwise the test is too easy
    }
}

TEST(Displace, DoesNotDependOnThreads) {
    const Skeleton skeleton = zoo_skeleton("fork_60");
    std::vector<Buffer<Vec3>> positions;
    std::vector<DisplaceReport> reports;
    for (const unsigned threads : {1u, 3u}) {
        MeshResult made = mesh_skeleton(skeleton, with_bark(0.1f));
        reports.push_back(displace_surface(made, skeleton, make_bumps(0.05f), {}, {.threads = threads}));
        positions.push_back(made.quads().mesh.positions);
    }
    EXPECT_EQ(positions[0], positions[1]);
    EXPECT_EQ(reports[0], reports[1]);
    EXPECT_GT(reports[0].displaced, 0u);
}

TEST(Displace, TakesTheScaleOfTheOptions) {
    const Skeleton skeleton = stem();
    MeshResult made = mesh_skeleton(skeleton, with_bark(2 * std::numbers::pi_v<float> * kRadius));
    const DisplaceReport report =
        displace_surface(made, skeleton, make_wave(0.002f), {.displace_height = 0.02f});
    EXPECT_NEAR(report.max_offset, 0.01, 1e-4);
}

TEST(Displace, RejectsUnsuitableInput) {
    const Skeleton skeleton = stem();
    const auto error = [&](const MeshOptions& options, const HeightTexture& texture,
                           const DisplaceOptions& displace = {}) {
        MeshResult made = mesh_skeleton(skeleton, options);
        return error_of([&] { displace_surface(made, skeleton, texture, displace); });
    };
    MeshOptions tubes = with_bark(0.1f);
    tubes.method = MeshMethod::cylinders;
    MeshOptions atlas = with_bark(0.1f);
    atlas.texture.coordinates = TextureCoordinates::atlas;
    EXPECT_EQ(error({}, make_wave(1)), "displace: the surface needs texture coordinates of bark");
    EXPECT_EQ(error(atlas, make_wave(1)), "displace: the surface needs texture coordinates of bark");
    EXPECT_EQ(error(tubes, make_wave(1)),
              "displace: cylinders intersect each other; displace a surface of another method");
    EXPECT_EQ(error(with_bark(0.1f), make_wave(0)),
              "displace: the heights have no scale; give displace_height in metres");
    EXPECT_EQ(error(with_bark(0.1f), {}),
              "displace: the heights have no scale; give displace_height in metres");
    EXPECT_EQ(error(with_bark(0.1f), {.scale = 1}),
              "a height texture needs pixels, with one height for each");
    EXPECT_NE(error(with_bark(0.1f), make_wave(1), {.displace_height = -1}), "no error");
    EXPECT_NE(error(with_bark(0.1f), make_wave(1), {.displace_height = NAN}), "no error");
    EXPECT_NE(error(with_bark(0.1f), make_wave(1), {.displace_share = 0}), "no error");
}

}  // namespace
}  // namespace coppice
