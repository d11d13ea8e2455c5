#include "coppice/render/trace/ring_internal.h"

#include <algorithm>
#include <cmath>

#include "coppice/render/trace/shading_internal.h"

namespace coppice {
namespace {

void blend(Image::Pixel& pixel, Vec3 encoded, float cover) {
    const float behind = static_cast<float>(pixel[3]) / 255 * (1 - cover), alpha = cover + behind;
    if (!(alpha > 0)) return;
    for (int k = 0; k < 3; ++k) {
        auto& channel = pixel[static_cast<std::size_t>(k)];
        const float mixed = (255 * encoded[k] * cover + static_cast<float>(channel) * behind) / alpha;
        channel = static_cast<std::uint8_t>(std::lround(std::clamp(mixed, 0.0f, 255.0f)));
    }
    pixel[3] = static_cast<std::uint8_t>(std::lround(255 * std::min(alpha, 1.0f)));
}

}  // namespace

void draw_ring(Image& image, const Ring& ring, Vec3 color) {
    const Vec3 encoded{to_srgb(color.x), to_srgb(color.y), to_srgb(color.z)};
    const float reach = ring.radius + ring.width / 2 + 1;
    const auto first = [](float at) { return static_cast<int>(std::max(0.0f, std::floor(at))); };
    const auto end = [](float at, int most) {
        return static_cast<int>(std::clamp(std::ceil(at), 0.0f, static_cast<float>(most)));
    };
    for (int y = first(ring.y - reach); y < end(ring.y + reach, image.height); ++y) {
        for (int x = first(ring.x - reach); x < end(ring.x + reach, image.width); ++x) {
            const float away =
                std::hypot(static_cast<float>(x) + 0.5f - ring.x, static_cast<float>(y) + 0.5f - ring.y);
            const float cover = ring.width / 2 + 0.5f - std::fabs(away - ring.radius);
            if (cover > 0) blend(image.at(x, y), encoded, std::min(cover, 1.0f));
        }
    }
}

}  // namespace coppice
