#include "bark_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "coppice/render/render.h"
#include "coppice/scene/drawn_material.h"

namespace coppice::cli {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr std::uint32_t kSides = 256;  // around an axis
constexpr std::uint32_t kRows = 128;
constexpr float kDistance = 1.12f;      // [radius] from the centre of the image to each axis
constexpr float kHalfLength = 1.5f;     // [radius] of the stem, which ends outside the image
constexpr double kHalfWidth = 2.2;      // [radius] of the image
constexpr double kDiscWidth = 1.05;     // [radius] half of the width of the image of a disc
constexpr float kRadiusOfPole = 1e-3f;  // [radius] so that the faces at the poles are quads

/// Adds a surface of revolution around a vertical axis. `profile` returns its radius and height [radius] for
/// the distance [radius] along it from the equator, which is in [-length, length].
template <class Profile>
void add_revolution(PolygonMesh& mesh, float x, float length, float wraps, float tiles_along,
                    const Profile& profile) {
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    const auto along = [&](std::uint32_t j) {
        return length * (2 * static_cast<float>(j) / static_cast<float>(kRows) - 1);
    };
    for (std::uint32_t j = 0; j <= kRows; ++j) {
        const auto [radius, z] = profile(along(j));
        for (std::uint32_t i = 0; i < kSides; ++i) {
            const float angle = 2 * kPi * static_cast<float>(i) / static_cast<float>(kSides);
            mesh.positions.push_back({x + radius * std::cos(angle), radius * std::sin(angle), z});
        }
    }
    constexpr std::array<std::array<std::uint32_t, 2>, 4> kCorners{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    for (std::uint32_t j = 0; j < kRows; ++j) {
        for (std::uint32_t i = 0; i < kSides; ++i) {
            std::array<std::uint32_t, 4> face{};
            for (std::size_t k = 0; k < face.size(); ++k) {
                const std::uint32_t column = i + kCorners[k][0], row = j + kCorners[k][1];
                face[k] = base + row * kSides + column % kSides;
                mesh.texture.push_back({wraps * static_cast<float>(column) / static_cast<float>(kSides),
                                        tiles_along * along(row)});
            }
            mesh.add_face(face);
        }
    }
}

}  // namespace

Image draw_bark(const BarkMaps& maps, float diameter, int width, const Context& ctx) {
    // A whole number of tiles around the stem; along it they are scaled as well, so that they keep their
    // proportions.
    const float wraps = std::max(1.0f, std::round(kPi * diameter / maps.tile_width));
    const float tiles_along = wraps * maps.tile_width / (2 * kPi * maps.tile_height);
    PolygonMesh mesh;
    add_revolution(mesh, -kDistance, kPi / 2, wraps, tiles_along, [](float s) {
        return std::array{std::max(std::cos(s), kRadiusOfPole), std::sin(s)};
    });
    add_revolution(mesh, kDistance, kHalfLength, wraps, tiles_along, [](float s) {
        return std::array{1.0f, s};
    });
    const RenderMaterial material = make_render_material(maps);
    const std::array<Vec3d, 2> framed{{{-kHalfWidth, 0, -kHalfWidth / 2}, {kHalfWidth, 0, kHalfWidth / 2}}};
    const RenderOptions options{.camera = {.width = width,
                                           .height = (width + 1) / 2,
                                           .azimuth = -kPi / 2,
                                           .elevation = 0,
                                           .margin = 0},
                                .ground = false};
    return render({.mesh = &mesh, .materials = {&material, 1}, .framed = framed}, options, ctx);
}

Image draw_cut(const BarkMaps& maps, int width, const Context& ctx) {
    PolygonMesh mesh;
    mesh.positions.push_back({0, 0, 0});
    for (std::uint32_t i = 0; i < kSides; ++i) {
        const float angle = 2 * kPi * static_cast<float>(i) / static_cast<float>(kSides);
        mesh.positions.push_back({0, std::cos(angle), std::sin(angle)});
    }
    for (std::uint32_t i = 0; i < kSides; ++i) {
        const std::array<std::uint32_t, 3> face{0, i + 1, (i + 1) % kSides + 1};
        mesh.add_face(face);
        for (const std::uint32_t v : face) {
            const Vec3 p = mesh.positions[v];
            mesh.texture.push_back({0.5f + 0.5f * p.y, 0.5f + 0.5f * p.z});
        }
    }
    const RenderMaterial material = make_render_material(maps);
    const std::array<Vec3d, 2> framed{{{0, -kDiscWidth, -kDiscWidth}, {0, kDiscWidth, kDiscWidth}}};
    const RenderOptions options{
        .camera = {.width = width, .height = width, .azimuth = 0, .elevation = 0, .margin = 0},
        .ground = false};
    return render({.mesh = &mesh, .materials = {&material, 1}, .framed = framed}, options, ctx);
}

}  // namespace coppice::cli
