#include "coppice/mesh/instances.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "coppice/base/error.h"

namespace coppice {
namespace {

constexpr float kHalf = 0.70710678f;

/// A square of 1 m that extends along +y, and a triangle of 2 m without texture.
std::vector<Prototype> make_prototypes() {
    Prototype square{"square", {}, {}, 3};
    square.mesh.positions = {{-0.5f, 0, 0}, {0.5f, 0, 0}, {0.5f, 1, 0}, {-0.5f, 1, 0}};
    square.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    square.texture = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    Prototype triangle{"triangle", {}, {}, 5};
    triangle.mesh.positions = {{-1, 0, 0}, {1, 0, 0}, {0, 2, 0}};
    triangle.mesh.triangles = {{0, 1, 2}};
    return {square, triangle};
}

/// A triangle at 1 m along x, and a square turned from +y to +z at double size.
Instances make_instances() {
    Instances out;
    out.prototypes = {1, 0};
    out.positions = {{1, 0, 0}, {0, 0, 5}};
    out.rotations = {Quaternion{}, Quaternion{kHalf, 0, 0, kHalf}};
    out.scales = {1, 2};
    out.colors = {{255, 255, 255}, {10, 20, 30}};
    out.origin = {100, 200, 300};
    return out;
}

void expect_near(Vec3 a, Vec3 b) { EXPECT_LT(length(a - b), 1e-5f) << a.x << " " << a.y << " " << a.z; }

TEST(Instances, MergesInTheOrderOfThePrototypes) {
    const auto prototypes = make_prototypes();
    const MergedInstances merged = merge_instances(prototypes, make_instances());
    EXPECT_EQ(merged.mesh.origin, (Vec3d{100, 200, 300}));
    ASSERT_EQ(merged.mesh.positions.size(), 7u);
    // The square comes first although its copy is the second: 2 m high, in the plane y = 0.
    expect_near(merged.mesh.positions[0], {-1, 0, 5});
    expect_near(merged.mesh.positions[2], {1, 0, 7});
    expect_near(merged.mesh.positions[4], {0, 0, 0});
    EXPECT_EQ(merged.mesh.triangles, (Buffer<Triangle>{{0, 1, 2}, {0, 2, 3}, {4, 5, 6}}));
    EXPECT_EQ(merged.materials, (std::vector<std::uint32_t>{3, 3, 5}));
    EXPECT_EQ(merged.first_face, (std::vector<std::size_t>{0, 2, 3}));
    ASSERT_EQ(merged.texture.size(), 9u);
    EXPECT_EQ(merged.texture[5], (TexturePoint{0, 1}));
    EXPECT_EQ(merged.texture[6], TexturePoint{});
    EXPECT_EQ(merged.colors[3], (std::array<std::uint8_t, 3>{10, 20, 30}));
    EXPECT_EQ(merged.colors[4], (std::array<std::uint8_t, 3>{255, 255, 255}));
}

TEST(Instances, BoundsContainAllVertices) {
    const Box3 box = compute_bounds(make_prototypes(), make_instances());
    expect_near(box.low, {-1, 0, 0});  // x: both at -1 and 0; z: the triangle
    expect_near(box.high, {2, 2, 7});  // x, y: the triangle; z: 5 + 2 x 1
    EXPECT_TRUE(compute_bounds(make_prototypes(), {}).empty());
}

TEST(Instances, MergingDoesNotDependOnTheNumberOfThreads) {
    Instances many;
    for (std::uint32_t i = 0; i < 5000; ++i) {
        const float angle = static_cast<float>(i);
        many.prototypes.push_back(i % 3 == 0 ? 1 : 0);
        many.positions.push_back({angle, std::sin(angle), std::cos(angle)});
        many.rotations.push_back({0, 0, std::sin(angle), std::cos(angle)});
        many.scales.push_back(1 + 0.1f * std::sin(angle));
        many.colors.push_back({static_cast<std::uint8_t>(i % 256), 0, 0});
    }
    const auto prototypes = make_prototypes();
    const MergedInstances one = merge_instances(prototypes, many, {.threads = 1});
    const MergedInstances seven = merge_instances(prototypes, many, {.threads = 7});
    EXPECT_EQ(one.mesh.positions, seven.mesh.positions);
    EXPECT_EQ(one.mesh.triangles, seven.mesh.triangles);
    EXPECT_EQ(one.colors, seven.colors);
    EXPECT_EQ(compute_bounds(prototypes, many, {.threads = 1}).high,
              compute_bounds(prototypes, many, {.threads = 7}).high);
    // 3,333 squares of 4 vertices and 2 faces, 1,667 triangles of 3 and 1: 15 bytes per vertex, 40 per face,
    // and 4 per copy.
    EXPECT_DOUBLE_EQ(estimate_merged_bytes(prototypes, many),
                     15.0 * (3333 * 4 + 1667 * 3) + 40.0 * (3333 * 2 + 1667) + 4 * 5000);
}

TEST(Instances, RefusesBadValues) {
    const auto prototypes = make_prototypes();
    EXPECT_NO_THROW(validate(prototypes, make_instances()));
    EXPECT_NO_THROW(validate(prototypes, {}));
    const auto refuses = [&](auto change) {
        Instances bad = make_instances();
        change(bad);
        EXPECT_THROW(validate(prototypes, bad), InvalidInput);
    };
    refuses([](Instances& i) { i.prototypes[1] = 2; });
    refuses([](Instances& i) { i.colors.pop_back(); });
    refuses([](Instances& i) { i.positions[0].x = std::numeric_limits<float>::quiet_NaN(); });
    refuses([](Instances& i) { i.rotations[0].w = 2; });
    refuses([](Instances& i) { i.scales[0] = 0; });
    auto untextured = prototypes;
    untextured[0].texture.pop_back();
    EXPECT_THROW(validate(untextured, make_instances()), InvalidInput);
    untextured[0].mesh.triangles.clear();
    EXPECT_THROW(validate(untextured, make_instances()), InvalidInput);
}

}  // namespace
}  // namespace coppice
