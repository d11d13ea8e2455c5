// Placed copies of prototypes.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "coppice/base/random.h"
#include "coppice/mesh/instances.h"
#include "coppice/render/render.h"

namespace coppice {
namespace {

/// A leaf of two squares, folded along its midrib.
Prototype make_leaf() {
    Prototype leaf{"leaf", {}, {}, 0};
    leaf.mesh.positions = {{-0.1f, 0, 0.02f}, {0, 0, 0},       {0.1f, 0, 0.02f},
                           {-0.1f, 0.3f, 0},  {0, 0.3f, 0.0f}, {0.1f, 0.3f, 0}};
    leaf.mesh.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
    leaf.texture = {{0, 0},    {0.5f, 0}, {0.5f, 1}, {0, 0},    {0.5f, 1}, {0, 1},
                    {0.5f, 0}, {1, 0},    {1, 1},    {0.5f, 0}, {1, 1},    {0.5f, 1}};
    return leaf;
}

/// Copies of random positions, rotations, sizes and colours in a cube of 2 m.
Instances make_copies(std::uint32_t count) {
    Instances out;
    const CounterRandom random(5, 0);
    const auto draw = [&](std::uint32_t i, std::uint32_t k) {
        return static_cast<float>(random.bits(16 * std::uint64_t{i} + k) >> 40) * 0x1p-23f - 1;
    };
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3 axis = normalized(Vec3{draw(i, 3), draw(i, 4), draw(i, 5)});
        const float half = 3 * draw(i, 6);
        const Vec3 v = axis * std::sin(half);
        out.prototypes.push_back(0);
        out.positions.push_back({draw(i, 0), draw(i, 1), draw(i, 2)});
        out.rotations.push_back({v.x, v.y, v.z, std::cos(half)});
        out.scales.push_back(1 + 0.5f * draw(i, 7));
        out.colors.push_back({255, 255, 255});
    }
    return out;
}

Image filled(Image::Pixel color) {
    Image out(4, 4);
    out.pixels.assign(out.pixels.size(), color);
    return out;
}

RenderOptions options_from_x() {
    RenderOptions o;
    o.camera.width = o.camera.height = 128;
    o.samples = 4;
    o.camera.azimuth = o.camera.elevation = 0;
    o.ground = false;
    o.transparent = true;
    o.flat = true;
    return o;
}

/// The corners of a cube of 3 m.
const std::vector<Vec3d> kFrame{{-1.5, -1.5, -1.5}, {1.5, -1.5, -1.5}, {-1.5, 1.5, -1.5}, {1.5, 1.5, -1.5},
                                {-1.5, -1.5, 1.5},  {1.5, -1.5, 1.5},  {-1.5, 1.5, 1.5},  {1.5, 1.5, 1.5}};

int opaque_pixels(const Image& image) {
    return static_cast<int>(std::ranges::count_if(image.pixels, [](const auto& p) { return p[3] > 127; }));
}

/// Returns the means of the three channels over opaque pixels.
std::array<double, 3> mean_color(const Image& image) {
    std::array<double, 3> sum{};
    for (const auto& p : image.pixels)
        for (std::size_t k = 0; k < 3; ++k) sum[k] += p[3] > 127 ? p[k] : 0;
    for (double& s : sum) s /= opaque_pixels(image);
    return sum;
}

TEST(Copies, LookLikeTheMergedMesh) {
    const std::vector<Prototype> prototypes{make_leaf()};
    const Instances copies = make_copies(300);
    const MergedInstances merged = merge_instances(prototypes, copies);
    PolygonMesh mesh = to_polygons(merged.mesh);
    mesh.texture = merged.texture;
    const RenderMaterial green{.color = filled({60, 120, 40, 255})};
    const RenderOptions options = options_from_x();
    const Image a = render({.instances = &copies,
                            .prototypes = prototypes,
                            .prototype_materials = {&green, 1},
                            .framed = kFrame},
                           options);
    const Image b = render({.mesh = &mesh, .materials = {&green, 1}, .framed = kFrame}, options);
    EXPECT_GT(opaque_pixels(a), 3000);
    // Rounding moves few silhouettes and shadows.
    int different = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        for (std::size_t k = 0; k < 4; ++k) {
            if (std::abs(int{a.pixels[i][k]} - int{b.pixels[i][k]}) > 8) {
                ++different;
                break;
            }
        }
    }
    EXPECT_LT(different, 30);
}

TEST(Copies, DoNotDependOnTheNumberOfThreads) {
    const std::vector<Prototype> prototypes{make_leaf()};
    const Instances copies = make_copies(2000);
    const RenderMaterial leaf{.color = filled({60, 120, 40, 255}), .cut_out = true, .transmission = 0.5f};
    const RenderScene scene{
        .instances = &copies, .prototypes = prototypes, .prototype_materials = {&leaf, 1}};
    EXPECT_EQ(render(scene, options_from_x(), {.threads = 1}),
              render(scene, options_from_x(), {.threads = 3}));
}

/// A square of 2 m that faces +x, at the place of a copy.
Instances make_one(float x, float scale = 1) {
    Instances out;
    out.prototypes = {0};
    out.positions = {{x, 0, -scale}};
    out.rotations = {Quaternion{0.5f, 0.5f, 0.5f, 0.5f}};  // x to y, y to z, z to x
    out.scales = {scale};
    out.colors = {{255, 255, 255}};
    return out;
}

Prototype make_card() {
    Prototype card{"card", {}, {}, 0};
    card.mesh.positions = {{-1, 0, 0}, {1, 0, 0}, {1, 2, 0}, {-1, 2, 0}};
    card.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    card.texture = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    return card;
}

/// Opaque in the left half.
Image half_opaque() {
    Image out(64, 64);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) out.at(x, y) = {200, 0, 0, static_cast<std::uint8_t>(x < 32 ? 255 : 0)};
    return out;
}

TEST(Copies, HolesAreTransparentAlsoForShadows) {
    const std::vector<Prototype> prototypes{make_card()};
    const Instances copies = make_one(0);
    RenderMaterial card{.color = half_opaque()};
    const auto draw = [&](bool ground) {
        RenderOptions options = options_from_x();
        options.ground = ground;
        options.camera.elevation = ground ? 0.7f : 0;
        return render({.instances = &copies,
                       .prototypes = prototypes,
                       .prototype_materials = {&card, 1},
                       .framed = kFrame},
                      options);
    };
    const auto shadow = [&](const Image& image) {
        return std::ranges::count_if(image.pixels, [](const auto& p) { return p[3] > 60 && p[0] == 0; });
    };
    const int whole = opaque_pixels(draw(false));
    const auto whole_shadow = shadow(draw(true));
    card.cut_out = true;
    EXPECT_NEAR(opaque_pixels(draw(false)), 0.5 * whole, 0.03 * whole);
    // u is to the right: the right half of the image is empty.
    const Image image = draw(false);
    EXPECT_GT(image.at(54, 64)[3], 200);
    EXPECT_EQ(image.at(74, 64)[3], 0);
    // The shadow of the half that remains, and the sky that both hide from the ground around them.
    EXPECT_LT(static_cast<double>(shadow(draw(true))), 0.85 * static_cast<double>(whole_shadow));
}

TEST(Copies, HolesOfAMeshAreTransparent) {
    PolygonMesh mesh = to_polygons(make_card().mesh);
    const std::vector<TexturePoint> texture = make_card().texture;
    mesh.texture.assign(texture.begin(), texture.end());
    for (Vec3& p : mesh.positions) p = {0, p.x, p.y - 1};
    RenderMaterial card{.color = half_opaque()};
    const RenderScene scene{.mesh = &mesh, .materials = {&card, 1}, .framed = kFrame};
    const int whole = opaque_pixels(render(scene, options_from_x()));
    card.cut_out = true;
    EXPECT_NEAR(opaque_pixels(render(scene, options_from_x())), 0.5 * whole, 0.03 * whole);
}

TEST(Copies, AreMultipliedWithTheirColor) {
    const std::vector<Prototype> prototypes{make_card()};
    Instances copies = make_one(0);
    copies.colors = {{255, 0, 0}};
    const RenderMaterial plain{.base_color = Vec3{0.5f, 0.5f, 0.5f}};
    const auto mean = mean_color(
        render({.instances = &copies, .prototypes = prototypes, .prototype_materials = {&plain, 1}},
               options_from_x()));
    EXPECT_GT(mean[0], 100);
    EXPECT_EQ(mean[1], 0);
    EXPECT_EQ(mean[2], 0);
}

TEST(Copies, LightPassesThroughLeaves) {
    const std::vector<Prototype> prototypes{make_card()};
    const Instances copies = make_one(0);
    RenderOptions options = options_from_x();
    options.sun_azimuth = 3.14159f;  // behind the card
    options.sun_elevation = 0.5f;
    RenderMaterial leaf{.base_color = Vec3{0.1f, 0.2f, 0.05f}};
    const auto draw = [&] {
        return mean_color(render(
            {.instances = &copies, .prototypes = prototypes, .prototype_materials = {&leaf, 1}}, options));
    };
    const auto dark = draw();
    leaf.transmission = 0.5f;
    const auto bright = draw();
    // sRGB of twice the linear light is about 1.35 times as large.
    EXPECT_GT(bright[1], 1.3 * dark[1]);
    EXPECT_GT(bright[0] / bright[2], 1.05 * dark[0] / dark[2]);  // yellower
}

TEST(Copies, TheCameraFramesThem) {
    const std::vector<Prototype> prototypes{make_card()};
    Instances copies = make_one(0);
    RenderOptions options = options_from_x();
    options.camera.margin = 0.1f;
    const RenderScene scene{.instances = &copies, .prototypes = prototypes};
    for (const float scale : {0.01f, 1.0f, 100.0f}) {
        copies = make_one(3 * scale, scale);
        copies.origin = {1e5, -1e5, 10};
        const int pixels = opaque_pixels(render(scene, options));
        // A ball around the square fits: its side is the diameter / sqrt(2), thus 0.8 x 128 / 1.41 = 72
        // pixels, less by the perspective.
        EXPECT_GT(pixels, 55 * 55) << scale;
        EXPECT_LT(pixels, 75 * 75) << scale;
    }
}

TEST(Copies, RefuseBadInput) {
    const std::vector<Prototype> prototypes{make_card()};
    Instances copies = make_one(0);
    RenderMaterial material{.cut_out = true};
    RenderScene scene{.instances = &copies, .prototypes = prototypes};
    RenderOptions options = options_from_x();
    EXPECT_NO_THROW(render(scene, options));
    scene.prototype_materials = {&material, 1};
    EXPECT_THROW(render(scene, options), InvalidInput);  // holes without an image
    scene.prototype_materials = {};
    options.color = RenderColor::evidence;
    EXPECT_THROW(render(scene, options), InvalidInput);  // copies have no evidence, and nothing else exists
    options.color = RenderColor::plain;
    copies.prototypes[0] = 1;
    EXPECT_THROW(render(scene, options), InvalidInput);
    copies = {};
    EXPECT_THROW(render(scene, options), InvalidInput);
}

}  // namespace
}  // namespace coppice
