#include "coppice/render/radius_colors.h"

#include <gtest/gtest.h>

#include "coppice/render/render.h"
#include "mesh/shapes.h"

namespace coppice {
namespace {

/// A stem of radius 0.4 m and a branch of 0.1 m, 4 m apart.
Skeleton two_trees() {
    return Skeleton({NodeId{}, NodeId(0), NodeId{}, NodeId(2)}, {{0, 0, 0}, {0, 0, 2}, {0, 4, 0}, {0, 4, 2}},
                    {0.4f, 0.4f, 0.1f, 0.1f});
}

TEST(RadiusColors, ThinIsBlueAndThickIsRed) {
    const RadiusColors colors = radius_colors(two_trees(), nullptr);
    EXPECT_FLOAT_EQ(colors.min, 0.1f);
    EXPECT_FLOAT_EQ(colors.max, 0.4f);
    EXPECT_TRUE(colors.vertices.empty());
    ASSERT_EQ(colors.nodes.size(), 4u);
    EXPECT_GT(colors.nodes[0][0], colors.nodes[0][2] + 80);
    EXPECT_GT(colors.nodes[2][2], colors.nodes[2][0] + 80);
}

TEST(RadiusColors, ScaleIsLogarithmic) {
    const Skeleton skeleton({NodeId{}, NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 2}, {0, 0, 4}},
                            {0.4f, 0.2f, 0.1f});
    const RadiusColors colors = radius_colors(skeleton, nullptr);
    const Rgb middle = colors.nodes[1];  // the geometric mean: pale grey
    EXPECT_NEAR(middle[0], middle[1], 6);
    EXPECT_NEAR(middle[1], middle[2], 6);
}

TEST(RadiusColors, EqualRadiiHaveTheColourOfTheMiddle) {
    const Skeleton skeleton({NodeId{}, NodeId(0)}, {{0, 0, 0}, {0, 0, 2}}, {0.2f, 0.2f});
    const Rgb color = radius_colors(skeleton, nullptr).nodes[0];
    EXPECT_NEAR(color[0], color[2], 6);
}

TEST(RadiusColors, VerticesHaveTheRadiusOfTheClosestSegment) {
    PolygonMesh mesh = shapes::box({-0.3f, -0.3f, 0.5f}, {0.3f, 0.3f, 1});
    mesh.positions.push_back({0.1f, 3.9f, 1});
    for (Vec3& p : mesh.positions) p -= Vec3{100, 0, 0};
    mesh.origin = {100, 0, 0};
    const RadiusColors colors = radius_colors(two_trees(), &mesh);
    ASSERT_EQ(colors.vertices.size(), 9u);
    for (std::size_t v = 0; v < 8; ++v) EXPECT_EQ(colors.vertices[v], colors.nodes[0]);
    EXPECT_EQ(colors.vertices[8], colors.nodes[2]);
    for (const unsigned threads : {1u, 3u})
        EXPECT_EQ(radius_colors(two_trees(), &mesh, {.threads = threads}).vertices, colors.vertices);
}

RenderOptions from_x(RenderColor color) {
    RenderOptions o;
    o.camera.width = o.camera.height = 300;
    o.samples = 1;
    o.camera.azimuth = o.camera.elevation = 0;
    o.ground = false;
    o.transparent = true;
    o.color = color;
    return o;
}

/// Returns the number of pixels in which a channel is much stronger than both others.
int strong(const Image& image, std::size_t channel) {
    int count = 0;
    for (const auto& p : image.pixels)
        count += p[channel] > p[(channel + 1) % 3] + 40 && p[channel] > p[(channel + 2) % 3] + 40 ? 1 : 0;
    return count;
}

TEST(RadiusColors, AreDrawnOnSkeletonsAndMeshesWithAScale) {
    const Skeleton skeleton = two_trees();
    const PolygonMesh stem = shapes::box({-0.3f, -0.3f, 0}, {0.3f, 0.3f, 2});
    const Image alone = render({.skeleton = &skeleton}, from_x(RenderColor::radius));
    EXPECT_GT(strong(alone, 0), 1000);  // the stem is at the left
    EXPECT_GT(strong(alone, 2), 300);
    const Image surface = render({.mesh = &stem, .skeleton = &skeleton}, from_x(RenderColor::radius));
    EXPECT_GT(strong(surface, 0), 10'000);  // the stem fills the image; the thin tree is not drawn
    EXPECT_THROW(render({.mesh = &stem}, from_x(RenderColor::radius)), InvalidInput);
}

TEST(RadiusColors, GivenColoursAreThoseOfVerticesAndNodes) {
    const Skeleton skeleton = two_trees();
    const PolygonMesh mesh = shapes::box({-1, -1, 0}, {1, 1, 2});
    const std::vector<Rgb> green(8, Rgb{0, 200, 0}), blue(4, Rgb{0, 0, 220});
    const RenderOptions plain = from_x(RenderColor::plain);
    EXPECT_EQ(strong(render({.mesh = &mesh}, plain), 1), 0);
    EXPECT_GT(strong(render({.mesh = &mesh, .mesh_colors = green}, plain), 1), 10'000);
    EXPECT_GT(strong(render({.skeleton = &skeleton, .skeleton_colors = blue}, plain), 2), 1000);
    // An axis that is visible through the mesh has its colour too.
    const RenderScene both{
        .mesh = &mesh, .skeleton = &skeleton, .mesh_colors = green, .skeleton_colors = blue};
    EXPECT_GT(strong(render(both, plain), 1), 5000);
    EXPECT_GT(strong(render(both, plain), 2), 500);
    EXPECT_THROW(render({.mesh = &mesh, .mesh_colors = blue}, plain), InvalidInput);
    EXPECT_THROW(render({.skeleton = &skeleton, .skeleton_colors = green}, plain), InvalidInput);
}

}  // namespace
}  // namespace coppice
