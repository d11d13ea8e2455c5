#include "coppice/render/material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "coppice/render/render.h"
#include "coppice/render/trace/mip_map_internal.h"
#include "coppice/render/trace/textured_internal.h"
#include "errors.h"

namespace coppice {
namespace {

constexpr Image::Pixel kRed{255, 0, 0, 255}, kGreen{0, 255, 0, 255}, kBlue{0, 0, 255, 255},
    kWhite{255, 255, 255, 255}, kBlack{0, 0, 0, 255};

Image filled(int width, int height, Image::Pixel color) {
    Image out(width, height);
    out.pixels.assign(out.pixels.size(), color);
    return out;
}

/// Returns a pattern without symmetry or period.
Image uneven(int width, int height) {
    Image out(width, height);
    for (std::size_t i = 0; i < out.pixels.size(); ++i) {
        const auto byte = [&](std::size_t k) {
            return static_cast<std::uint8_t>((i * i * k + 31 * i) % 256);
        };
        out.pixels[i] = {byte(7), byte(11), byte(13), 255};
    }
    return out;
}

/// Returns a chessboard of single pixels.
Image chessboard(int size) {
    Image out = filled(size, size, kBlack);
    for (int y = 0; y < size; ++y) {
        for (int x = (y % 2); x < size; x += 2) out.at(x, y) = kWhite;
    }
    return out;
}

/// A square of 2 x 2 m across x that faces +x; seen from there, u is to the right and v up.
PolygonMesh square(float tiles = 1) {
    PolygonMesh mesh;
    mesh.positions = {{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}};
    mesh.add_face(Quad{0, 1, 2, 3});
    mesh.texture = {{0, 0}, {tiles, 0}, {tiles, tiles}, {0, tiles}};
    return mesh;
}

RenderOptions from_x() {
    RenderOptions o;
    o.camera.width = o.camera.height = 64;
    o.samples = 4;
    o.camera.azimuth = o.camera.elevation = 0;
    o.ground = false;
    o.transparent = true;
    return o;
}

Image drawn(const PolygonMesh& mesh, const RenderMaterial& material, const RenderOptions& options = from_x(),
            const Context& ctx = {}) {
    return render({.mesh = &mesh, .materials = {&material, 1}}, options, ctx);
}

int brightness(const Image& image, int x, int y) {
    const auto& p = image.at(x, y);
    return p[0] + p[1] + p[2];
}

TEST(MipMap, EveryLevelHasTheMeanOfTheImage) {
    for (const auto& [width, height] : {std::pair{8, 8}, {5, 3}, {7, 1}, {1, 6}, {37, 100}}) {
        SCOPED_TRACE(width);
        const Image image = uneven(width, height);
        const MipMap map(image, TexelEncoding::srgb, {});
        const auto mean = [&](std::size_t level) {
            Vec3d sum;
            for (int y = 0; y < map.height(level); ++y) {
                for (int x = 0; x < map.width(level); ++x) sum += Vec3d(map.texel(level, x, y));
            }
            return sum / (static_cast<double>(map.width(level)) * map.height(level));
        };
        const std::size_t last = map.level_count() - 1;
        EXPECT_EQ(map.width(last), 1);
        EXPECT_EQ(map.height(last), 1);
        for (std::size_t level = 1; level <= last; ++level)
            EXPECT_LT(distance(mean(level), mean(0)), 1e-5) << level;
    }
}

TEST(MipMap, AveragesLinearLight) {
    const Image image = chessboard(2);
    EXPECT_FLOAT_EQ(MipMap(image, TexelEncoding::srgb, {}).texel(1, 0, 0).x, 0.5f);
    Image grey = filled(1, 1, {188, 188, 188, 255});
    EXPECT_NEAR(MipMap(grey, TexelEncoding::srgb, {}).texel(0, 0, 0).x, 0.5f, 5e-3f);  // sRGB 188 is half
    EXPECT_FLOAT_EQ(MipMap(grey, TexelEncoding::linear, {}).texel(0, 0, 0).x, 188.0f / 255);
}

TEST(MipMap, RepeatsAndHasVUp) {
    Image image(2, 2);
    image.pixels = {kRed, kGreen, kBlue, kWhite};  // red is at the top left
    const MipMap map(image, TexelEncoding::linear, {});
    EXPECT_EQ(map.sample(0.25f, 0.75f, 0), Vec3(1, 0, 0));
    EXPECT_EQ(map.sample(0.75f, 0.75f, 0), Vec3(0, 1, 0));
    EXPECT_EQ(map.sample(0.25f, 0.25f, 0), Vec3(0, 0, 1));
    EXPECT_EQ(map.sample(-2.75f, 5.75f, 0), Vec3(1, 0, 0));
    EXPECT_EQ(map.sample(0.5f, 0.75f, 0), Vec3(0.5f, 0.5f, 0));
    EXPECT_EQ(map.sample(0, 0.75f, 0), Vec3(0.5f, 0.5f, 0));  // between the last and the first column
    // Level 1 is the mean (1/2, 1/2, 1/2); in between, both are weighted.
    EXPECT_EQ(map.sample(0.25f, 0.75f, 9), Vec3(0.5f, 0.5f, 0.5f));
    EXPECT_EQ(map.sample(0.25f, 0.75f, 0.5f), Vec3(0.75f, 0.25f, 0.25f));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(map.sample(0.25f, 0.75f, nan), Vec3(1, 0, 0));
}

TEST(MipMap, LevelFollowsTheLongerSide) {
    const Image image = filled(64, 32, kRed);
    const MipMap map(image, TexelEncoding::srgb, {});
    EXPECT_FLOAT_EQ(map.level(4.0f / 64, 0, 0, 1.0f / 32), 2);  // 4 x 1 texels
    EXPECT_FLOAT_EQ(map.level(0, 8.0f / 32, 1.0f / 64, 0), 3);  // turned: 8 x 1 texels
}

TEST(MipMap, IsBitIdenticalForAnyNumberOfThreads) {
    const Image image = uneven(301, 113);
    const MipMap one(image, TexelEncoding::srgb, {.threads = 1});
    for (const unsigned threads : {2u, 7u}) {
        const MipMap other(image, TexelEncoding::srgb, {.threads = threads});
        for (std::size_t level = 0; level < one.level_count(); ++level) {
            for (int y = 0; y < one.height(level); ++y) {
                for (int x = 0; x < one.width(level); ++x)
                    ASSERT_EQ(one.texel(level, x, y), other.texel(level, x, y));
            }
        }
    }
}

TEST(Gloss, IsStrongestTowardsTheMirroredDirection) {
    const Vec3 up{0, 0, 1}, camera = normalized(Vec3{-1, 0, 1});
    for (const float roughness : {0.3f, 0.6f}) {
        const Gloss gloss{up, camera, roughness};
        EXPECT_GT(gloss.of_source(normalized(Vec3{1, 0, 1})), gloss.of_source(up));
        EXPECT_EQ(gloss.of_source({0, 0, -1}), 0);
    }
    const Vec3 mirrored = normalized(Vec3{1, 0, 1});
    EXPECT_GT((Gloss{up, camera, 0.3f}.of_source(mirrored)), (Gloss{up, camera, 0.6f}.of_source(mirrored)));
    EXPECT_LT(distance(Gloss{up, camera, 0}.sky_direction(), mirrored), 1e-6f);
    EXPECT_NEAR((Gloss{up, up, 0.5f}.of_sky()), 0.04f, 1e-6f);  // perpendicular: that of dielectrics
}

/// The integral over all directions of a source is the reflected light; it does not exceed that which
/// arrives.
TEST(Gloss, ReflectsLessLightThanArrives) {
    for (const float angle : {0.0f, 0.7f, 1.3f}) {
        for (const float roughness : {0.0f, 0.4f, 1.0f}) {
            const Gloss gloss{{0, 0, 1}, {std::sin(angle), 0, std::cos(angle)}, roughness};
            constexpr int kSteps = 400;
            double sum = 0;
            for (int i = 0; i < kSteps; ++i) {
                for (int k = 0; k < kSteps; ++k) {  // equal areas of the half sphere
                    const float z = (static_cast<float>(i) + 0.5f) / kSteps;
                    const float a = 6.2831853f * (static_cast<float>(k) + 0.5f) / kSteps;
                    const float r = std::sqrt(1 - z * z);
                    sum += double{gloss.of_source({r * std::cos(a), r * std::sin(a), z})};
                }
            }
            // of_source is relative to 1 / pi; each direction is that of 2 pi / kSteps^2.
            const double reflected = 2 * sum / (kSteps * kSteps);
            EXPECT_LT(reflected, 0.6);
            EXPECT_GT(reflected, 0.01);  // a quarter of the reflectance: rough surfaces hide parts
        }
    }
}

TEST(Material, TheImageIsUpright) {
    RenderMaterial material;
    material.color = Image(2, 2);
    material.color.pixels = {kRed, kGreen, kBlue, kBlack};
    const Image image = drawn(square(), material);
    const auto is = [&](int x, int y, std::size_t channel) {
        const auto& p = image.at(x, y);
        return p[channel] > p[(channel + 1) % 3] + 80 && p[channel] > p[(channel + 2) % 3] + 80;
    };
    EXPECT_TRUE(is(17, 17, 0));
    EXPECT_TRUE(is(46, 17, 1));
    EXPECT_TRUE(is(17, 46, 2));
    EXPECT_LT(brightness(image, 46, 46), 90);
}

TEST(Material, BlendsBothSetsByTheirWeights) {
    RenderMaterial material;
    material.color = Image(2, 1);
    material.color.pixels = {kRed, kGreen};
    PolygonMesh mesh = square();
    mesh.texture.assign(4, {0.25f, 0});
    const auto color = [&](float left, float right) {
        mesh.texture_blends.clear();
        for (const float weight : {left, right, right, left})
            mesh.texture_blends.push_back({{0.75f, 0}, weight});
        return drawn(mesh, material);
    };
    const Image red = drawn(mesh, material), blended = color(0, 1);
    EXPECT_EQ(color(0, 0), red);
    const Image green = color(1, 1);
    EXPECT_GT(green.at(32, 32)[1], 100);
    EXPECT_EQ(green.at(32, 32)[0], red.at(32, 32)[1]);
    EXPECT_GT(blended.at(12, 32)[0], blended.at(32, 32)[0]);  // from red on the left to green on the right
    EXPECT_GT(blended.at(32, 32)[0], blended.at(52, 32)[0]);
    EXPECT_GT(blended.at(52, 32)[1], blended.at(32, 32)[1]);
    mesh.texture_blends.front().weight = 2;
    EXPECT_THROW(drawn(mesh, material), InvalidInput);
    mesh.texture_blends.pop_back();
    EXPECT_THROW(drawn(mesh, material), InvalidInput);
}

TEST(Material, DistantTexturesAreSmooth) {
    // 64 texels and 16 tiles across about 59 pixels: 17 texels for each pixel.
    const Image image = drawn(square(16), {.color = chessboard(64)});
    const Image grey = drawn(square(16), {.color = filled(1, 1, {188, 188, 188, 255})});
    for (int y = 10; y < 54; ++y) {
        for (int x = 10; x < 54; ++x) ASSERT_NEAR(image.at(x, y)[1], grey.at(x, y)[1], 4);
    }
}

TEST(Material, NearTexturesAreSharp) {
    Image squares = filled(64, 64, kBlack);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            if ((x / 16 + y / 16) % 2 == 1) squares.at(x, y) = kWhite;
        }
    }
    const Image image = drawn(square(), {.color = squares});
    int dark = 0, bright = 0;
    for (int y = 8; y < 56; ++y) {
        for (int x = 8; x < 56; ++x) {
            dark += brightness(image, x, y) < 60 ? 1 : 0;
            bright += brightness(image, x, y) > 600 ? 1 : 0;
        }
    }
    // Squares of about 15 x 15 pixels, half of them black, in 48 x 48 pixels; only their edges are mixed.
    EXPECT_GT(dark, 850);
    EXPECT_GT(bright, 850);
}

/// The sun is at the upper right: normals that turn there are brighter.
TEST(Material, NormalsTurnInTheFrameOfTheTexture) {
    RenderOptions o = from_x();
    o.sun_azimuth = 0.8f;
    o.sun_elevation = 0.6f;
    const auto turned = [&](std::uint8_t red, std::uint8_t green, const PolygonMesh& mesh) {
        RenderMaterial m{.color = filled(1, 1, {90, 90, 90, 255}),
                         .normal = filled(1, 1, {red, green, 230, 255})};
        return brightness(drawn(mesh, m, o), 32, 32);
    };
    const PolygonMesh plain = square();
    EXPECT_GT(turned(200, 128, plain), turned(56, 128, plain) + 30);
    EXPECT_GT(turned(128, 200, plain), turned(128, 56, plain) + 30);
    PolygonMesh other = square();  // u is up and v to the left
    other.texture = {{0, 1}, {0, 0}, {1, 0}, {1, 1}};
    EXPECT_NEAR(turned(200, 128, other), turned(128, 200, plain), 1);
    EXPECT_NEAR(turned(128, 56, other), turned(200, 128, plain), 1);
    PolygonMesh mirrored = square();  // u is to the left
    mirrored.texture = {{1, 0}, {0, 0}, {0, 1}, {1, 1}};
    EXPECT_NEAR(turned(56, 128, mirrored), turned(200, 128, plain), 1);
    EXPECT_NEAR(turned(128, 200, mirrored), turned(128, 200, plain), 1);
}

TEST(Material, SmoothSurfacesReflectTheSun) {
    RenderOptions o = from_x();
    o.sun_azimuth = 0;
    o.sun_elevation = 0.05f;
    const auto shine = [&](std::uint8_t roughness) {
        RenderMaterial m{.color = filled(1, 1, kBlack), .roughness = filled(1, 1, {roughness, 0, 0, 255})};
        return brightness(drawn(square(), m, o), 32, 32);
    };
    EXPECT_GT(shine(80), shine(255) + 50);
    EXPECT_EQ(brightness(drawn(square(), {.color = filled(1, 1, kBlack)}, o), 32, 32), 0);
}

TEST(Material, OcclusionDarkensTheSkyOnly) {
    RenderOptions o = from_x();
    o.sun_azimuth = 3;  // behind the square
    RenderMaterial m{.color = filled(1, 1, kWhite), .occlusion = filled(1, 1, kBlack)};
    EXPECT_EQ(brightness(drawn(square(), m, o), 32, 32), 0);
    o.sun_azimuth = 0;
    EXPECT_GT(brightness(drawn(square(), m, o), 32, 32), 300);
}

TEST(Material, IsBitIdenticalForAnyNumberOfThreads) {
    const RenderMaterial m{uneven(19, 40), uneven(8, 5), uneven(16, 16), uneven(3, 3)};
    RenderOptions o = from_x();
    o.camera.azimuth = 0.7f;
    const Image one = drawn(square(3), m, o, {.threads = 1});
    for (const unsigned threads : {2u, 7u}) EXPECT_EQ(drawn(square(3), m, o, {.threads = threads}), one);
}

TEST(Material, AcceptsDegenerateTextureCoordinates) {
    PolygonMesh mesh = square();
    mesh.texture = {{1e30f, -1e30f}, {1e30f, -1e30f}, {-1e30f, 0}, {0, 0}};
    const RenderMaterial m{uneven(4, 4), uneven(4, 4), uneven(4, 4), uneven(4, 4)};
    EXPECT_EQ(drawn(mesh, m).width, 64);
    mesh.texture.assign(4, TexturePoint{});
    EXPECT_EQ(drawn(mesh, m).width, 64);
}

/// A square, and another one of 2 m to the right of it.
PolygonMesh pair_of_squares() {
    PolygonMesh mesh = square();
    for (const Vec3 p : square().positions) mesh.positions.push_back(p + Vec3{0, 2, 0});
    mesh.add_face(Quad{4, 5, 6, 7});
    for (const TexturePoint t : square().texture) mesh.texture.push_back(t);
    return mesh;
}

TEST(Material, FacesMayHaveDifferentOnes) {
    const PolygonMesh mesh = pair_of_squares();
    const RenderMaterial materials[] = {{.color = filled(1, 1, kGreen)}, {.color = filled(1, 1, kRed)}};
    const auto draw = [&](std::vector<std::uint32_t> of_faces) {
        return render({.mesh = &mesh, .materials = materials, .face_materials = of_faces}, from_x());
    };
    const Image both = draw({1, 0});
    const Image::Pixel left = both.at(24, 32), right = both.at(40, 32);
    EXPECT_GT(left[0], 100);
    EXPECT_EQ(left[1], 0);
    EXPECT_EQ(right[0], 0);
    EXPECT_GT(right[1], 100);
    // Other values: no material, as of a mesh without any.
    EXPECT_EQ(draw({7, 7}), render({.mesh = &mesh}, from_x()));
    EXPECT_THROW(draw({1}), InvalidInput);
}

TEST(Material, RejectsInvalidInput) {
    const RenderMaterial red{.color = filled(1, 1, kRed)};
    const auto error = [&](const PolygonMesh& mesh, const RenderMaterial& material) {
        return test::error_of<InvalidInput>([&] { drawn(mesh, material); });
    };
    PolygonMesh mesh = square();
    EXPECT_EQ(error(mesh, {}), "render: the material has no image");
    mesh.texture.back().v = std::numeric_limits<float>::infinity();
    EXPECT_EQ(error(mesh, red), "render: the texture coordinates of the mesh are not finite");
    mesh.texture.pop_back();
    EXPECT_EQ(error(mesh, red), "render: the number of texture coordinates must be that of the corners");
    mesh.texture.clear();
    EXPECT_EQ(error(mesh, red), "render: a material requires a mesh with texture coordinates");
    const Skeleton skeleton({NodeId{}}, {{0, 0, 0}}, {0.9f});
    EXPECT_THROW(render({.materials = {&red, 1}, .skeleton = &skeleton}, from_x()), InvalidInput);
}

}  // namespace
}  // namespace coppice
