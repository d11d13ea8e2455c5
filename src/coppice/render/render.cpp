#include "coppice/render/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "coppice/base/check_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/render/ring_internal.h"
#include "coppice/render/scale_bar_internal.h"
#include "coppice/render/shading_internal.h"

namespace coppice {
namespace {

constexpr long long kMostPixels = 128'000'000;
constexpr int kTile = 16;           // [pixels] a square of them is traced together, for the caches
constexpr int kRowsPerReport = 64;  // between two reports of progress
constexpr float kBuildShare = 0.3f;
constexpr double kUsual = 0.98;       // of the vertices lie within the range of the colours
constexpr float kLeastRange = 1e-9f;  // [m]

void check(const RenderScene& scene, const RenderOptions& options) {
    check_fields(options, "render");
    const auto pixels = static_cast<long long>(options.width) * options.height;
    if (pixels > kMostPixels) {
        throw InvalidInput(
            fmt::format("render: {} x {} pixels are more than {} million; choose a smaller picture",
                        options.width, options.height, kMostPixels / 1'000'000));
    }
    if (scene.view != nullptr) validate(*scene.view, "render: view");
    if (scene.mesh == nullptr && scene.skeleton == nullptr)
        throw InvalidInput("render: there is nothing to draw");
    if (scene.mesh != nullptr) {
        if (scene.mesh->face_count() == 0) throw InvalidInput("render: the mesh has no faces");
        for (const std::uint32_t v : scene.mesh->corners) {
            if (!is_finite(scene.mesh->positions[v])) {
                throw InvalidInput(fmt::format("render: vertex {} of the mesh has no finite position", v));
            }
        }
    }
    const std::uint32_t faces = scene.mesh == nullptr ? 0 : scene.mesh->face_count();
    for (const std::uint32_t f : scene.marked_faces) {
        if (f >= faces)
            throw InvalidInput(fmt::format("render: face {} is marked, but there are {}", f, faces));
    }
    if (options.color == RenderColor::distance &&
        (scene.mesh == nullptr || scene.distance_to == nullptr || scene.distance_to->boxes().size() == 0)) {
        throw InvalidInput("render: colour by distance needs a mesh and another one with faces");
    }
    if (options.color != RenderColor::deviation) return;
    if (scene.mesh == nullptr || scene.deviation.size() != scene.mesh->positions.size()) {
        throw InvalidInput(
            "render: colour by deviation needs a mesh and one deviation for each of its vertices");
    }
}

Image::Pixel encode(const Light& light) {
    if (light.alpha <= 0) return {0, 0, 0, 0};
    const auto byte = [](float x) { return static_cast<std::uint8_t>(std::lround(255 * x)); };
    const Vec3 c = light.color / light.alpha;
    return {byte(to_srgb(c.x)), byte(to_srgb(c.y)), byte(to_srgb(c.z)), byte(std::min(1.0f, light.alpha))};
}

/// What most vertices keep below, so that a few far away do not pale the rest.
float distance_range(const RenderScene& scene, const RenderOptions& options, const Context& ctx) {
    if (options.color != RenderColor::distance || options.distance_range > 0) return options.distance_range;
    constexpr std::size_t kGrain = 256;
    std::vector<std::uint32_t> used = scene.mesh->corners;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    std::vector<double> distance(used.size());
    const Vec3d shift = scene.mesh->origin - scene.distance_to->mesh().origin;
    parallel_for(ctx, used.size(), kGrain, [&](std::size_t i) {
        if (ctx.stop.stop_requested()) return;
        distance[i] = scene.distance_to->distance(Vec3d(scene.mesh->positions[used[i]]) + shift);
    });
    ctx.throw_if_cancelled();
    const auto at =
        distance.begin() + static_cast<std::ptrdiff_t>(kUsual * static_cast<double>(used.size() - 1));
    std::nth_element(distance.begin(), at, distance.end());
    return static_cast<float>(std::max(*at, double{kLeastRange}));
}

/// Looks at the stop token in each row, because many samples make a tile long.
void draw_tile(Image& image, const Shading& shading, int left, int top, int bottom,
               const std::stop_token& stop) {
    for (int y = top; y < bottom && !stop.stop_requested(); ++y) {
        for (int x = left; x < std::min(image.width, left + kTile); ++x)
            image.at(x, y) = encode(shading.pixel(x, y));
    }
}

/// Rings at least as wide as a fortieth of the picture, so that none is overlooked.
void draw_marks(Image& image, const RenderScene& scene, const TracedScene& traced, const Camera& camera) {
    constexpr float kLeastRadius = 1.0f / 80, kWidth = 1.0f / 450, kFree = 1.15f;
    const auto size = static_cast<float>(std::min(image.width, image.height));
    for (const RenderMark& mark : scene.marks) {
        const Vec3 place = traced.local(mark.place);
        const Camera::Projected middle = camera.project(place);
        if (middle.depth <= 0) continue;
        const auto beside =
            camera.project(place + camera.right() * (traced.local_length(mark.radius) * kFree));
        const float radius =
            std::max(std::hypot(beside.x - middle.x, beside.y - middle.y), kLeastRadius * size);
        draw_ring(image, {middle.x, middle.y, radius, std::max(1.5f, kWidth * size)}, kMarkColor);
    }
}

}  // namespace

Image render(const RenderScene& scene, const RenderOptions& options, const Context& ctx) {
    check(scene, options);
    ctx.throw_if_cancelled();
    ctx.report(0);
    RenderScene shown = scene;
    if (options.color != RenderColor::plain) shown.skeleton = nullptr;  // it would cover what is to be seen
    RenderOptions chosen = options;
    chosen.distance_range = distance_range(scene, options, ctx);
    const TracedScene traced(shown, options, ctx);
    ctx.throw_if_cancelled();
    ctx.report(kBuildShare);
    const Camera camera =
        scene.view != nullptr ? Camera(traced.local(*scene.view)) : Camera(traced.frame_points(), options);
    const Shading shading(traced, camera, chosen);
    Image image(options.width, options.height);
    const int columns = (options.width + kTile - 1) / kTile;
    for (int top = 0; top < options.height; top += kRowsPerReport) {
        const int end = std::min(options.height, top + kRowsPerReport);
        const int rows = (end - top + kTile - 1) / kTile;
        const auto tiles = static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
        parallel_for(ctx, tiles, 1, [&](std::size_t i) {
            const int tile = static_cast<int>(i), y = top + tile / columns * kTile;
            draw_tile(image, shading, tile % columns * kTile, y, std::min(end, y + kTile), ctx.stop);
        });
        ctx.throw_if_cancelled();
        ctx.report(kBuildShare +
                   (1 - kBuildShare) * static_cast<float>(end) / static_cast<float>(options.height));
    }
    draw_marks(image, scene, traced, camera);
    if (options.color == RenderColor::deviation)
        draw_scale_bar(image, fmt::format("{:.3g}%", 100 * options.deviation_range));
    if (options.color == RenderColor::distance) draw_scale_bar(image, length_text(chosen.distance_range));
    return image;
}

}  // namespace coppice
