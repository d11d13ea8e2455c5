#include "coppice/io_database/map_file.h"

#include <fmt/format.h>

#include "coppice/base/ascii.h"
#include "coppice/base/error.h"
#include "coppice/io/text.h"
#include "coppice/io_database/map_writers_internal.h"
#include "coppice/system/file.h"

namespace coppice {

MapCrs parse_crs(std::string_view text) {
    constexpr std::string_view kRegister = "EPSG:";
    constexpr std::int64_t kMax = 999'999;
    if (text.size() > kRegister.size() && to_lower(text.substr(0, kRegister.size())) == "epsg:") {
        const auto number = parse_integer(text.substr(kRegister.size()));
        if (number && *number > 0 && *number <= kMax) return {static_cast<int>(*number), {}};
    }
    throw InvalidInput(fmt::format(
        "{} names no coordinate reference system; use an EPSG code, such as EPSG:32632", in_quotes(text)));
}

std::optional<MapFormat> map_format_of_name(const std::filesystem::path& path) {
    const std::string ending = to_lower(path.extension().string());
    if (ending == ".geojson") return MapFormat::geojson;
    if (ending == ".gpkg") return MapFormat::geopackage;
    return std::nullopt;
}

void write_map(const std::filesystem::path& path, std::span<const MapLayer> layers, const MapCrs& crs,
               const Context& ctx) {
    const auto format = map_format_of_name(path);
    if (!format)
        throw Unsupported(
            fmt::format("'{}' is no name of a map; use the ending .geojson or .gpkg", path.string()));
    write_file(path, *format == MapFormat::geojson ? io_internal::encode_geojson(layers, crs, ctx)
                                                   : io_internal::encode_geopackage(layers, crs, ctx));
}

}  // namespace coppice
