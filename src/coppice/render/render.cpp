#include "coppice/render/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/check_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/render/scale_bar_internal.h"
#include "coppice/render/shading_internal.h"

namespace coppice {
namespace {

constexpr long long kMostPixels = 128'000'000;
constexpr int kTile = 16;           // [pixels] a square of them is traced together, for the caches
constexpr int kRowsPerReport = 64;  // between two reports of progress
constexpr float kBuildShare = 0.3f;

void check(const RenderScene& scene, const RenderOptions& options) {
    check_fields(options, "render");
    const auto pixels = static_cast<long long>(options.width) * options.height;
    if (pixels > kMostPixels) {
        throw InvalidInput(
            fmt::format("render: {} x {} pixels are more than {} million; choose a smaller picture",
                        options.width, options.height, kMostPixels / 1'000'000));
    }
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

/// Looks at the stop token in each row, because many samples make a tile long.
void draw_tile(Image& image, const Shading& shading, int left, int top, int bottom,
               const std::stop_token& stop) {
    for (int y = top; y < bottom && !stop.stop_requested(); ++y) {
        for (int x = left; x < std::min(image.width, left + kTile); ++x)
            image.at(x, y) = encode(shading.pixel(x, y));
    }
}

}  // namespace

Image render(const RenderScene& scene, const RenderOptions& options, const Context& ctx) {
    check(scene, options);
    ctx.throw_if_cancelled();
    ctx.report(0);
    RenderScene shown = scene;
    if (options.color == RenderColor::deviation)
        shown.skeleton = nullptr;  // it would cover what is to be seen
    const TracedScene traced(shown, options, ctx);
    ctx.throw_if_cancelled();
    ctx.report(kBuildShare);
    const Camera camera(traced.frame_points(), options);
    const Shading shading(traced, camera, options);
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
    if (options.color == RenderColor::deviation) draw_scale_bar(image, options.deviation_range);
    return image;
}

}  // namespace coppice
