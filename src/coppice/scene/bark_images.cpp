#include "coppice/scene/bark_images.h"

#include <fmt/format.h>

#include <cstddef>
#include <span>

#include "coppice/base/parallel.h"
#include "coppice/render/png.h"

namespace coppice {

std::vector<BarkImage> encode_bark(const BarkMaps& maps, const Context& ctx) {
    struct NamedMap {
        std::string_view name;
        PngMap map;
    };
    const std::vector<BarkMaps::Texel> packed = maps.packed();
    const auto named = [&](std::string_view name, int channels, int bits,
                           std::span<const std::byte> samples) {
        return NamedMap{name,
                        {.width = maps.width,
                         .height = maps.height,
                         .channels = channels,
                         .bits = bits,
                         .samples = samples,
                         .tile_width = maps.tile_width,
                         .tile_height = maps.tile_height}};
    };
    NamedMap heights = named("height", 1, 16, std::as_bytes(std::span(maps.heights)));
    heights.map.low = maps.low;
    heights.map.high = maps.high;
    const std::vector<NamedMap> all{named("color", 3, 8, std::as_bytes(std::span(maps.color))),
                                    named("normal", 3, 8, std::as_bytes(std::span(maps.normal))),
                                    heights,
                                    named("orm", 3, 8, std::as_bytes(std::span(packed))),
                                    named("roughness", 1, 8, std::as_bytes(std::span(maps.roughness))),
                                    named("occlusion", 1, 8, std::as_bytes(std::span(maps.occlusion)))};
    std::vector<BarkImage> out(all.size());
    parallel_for(ctx, all.size(), 1, [&](std::size_t i) { out[i] = {all[i].name, encode_png(all[i].map)}; });
    return out;
}

std::string make_bark_file_name(const std::string& prefix, std::string_view map) {
    return fmt::format("{}_{}.png", prefix, map);
}

}  // namespace coppice
