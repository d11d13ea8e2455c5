#include "coppice/scene/bark_images.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <span>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/render/png.h"

namespace coppice {

std::string encode_bark_map(const BarkMaps& maps, std::string_view map) {
    PngMap out{.width = maps.width,
               .height = maps.height,
               .channels = 3,
               .bits = 8,
               .tile_width = maps.tile_width,
               .tile_height = maps.tile_height};
    std::vector<BarkMaps::Texel> packed;
    if (map == "color") {
        out.samples = std::as_bytes(std::span(maps.color));
    } else if (map == "normal") {
        out.samples = std::as_bytes(std::span(maps.normal));
    } else if (map == "orm") {
        packed = maps.packed();
        out.samples = std::as_bytes(std::span(packed));
    } else if (map == "height") {
        out.channels = 1;
        out.bits = 16;
        out.samples = std::as_bytes(std::span(maps.heights));
        out.low = maps.low;
        out.high = maps.high;
    } else {
        COPPICE_ASSERT(map == "roughness" || map == "occlusion");
        out.channels = 1;
        out.samples = std::as_bytes(std::span(map == "roughness" ? maps.roughness : maps.occlusion));
    }
    return encode_png(out);
}

std::vector<BarkImage> encode_bark(const BarkMaps& maps, const Context& ctx) {
    constexpr std::array<std::string_view, 6> kMaps{"color", "normal",    "height",
                                                    "orm",   "roughness", "occlusion"};
    std::vector<BarkImage> out(kMaps.size());
    parallel_for(ctx, kMaps.size(), 1, [&](std::size_t i) {
        out[i] = {kMaps[i], encode_bark_map(maps, kMaps[i])};
    });
    return out;
}

std::string make_bark_file_name(const std::string& prefix, std::string_view map) {
    return fmt::format("{}_{}.png", prefix, map);
}

}  // namespace coppice
