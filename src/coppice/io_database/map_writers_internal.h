#pragma once

#include <span>
#include <string>

#include "coppice/base/context.h"
#include "coppice/io_database/map_file.h"

namespace coppice::io_internal {

/// Returns the content of the file.
std::string encode_geojson(std::span<const MapLayer> layers, const MapCrs& crs, const Context& ctx);
std::string encode_geopackage(std::span<const MapLayer> layers, const MapCrs& crs, const Context& ctx);

}  // namespace coppice::io_internal
