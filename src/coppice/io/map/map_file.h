#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice {

/// The coordinate reference system of a map: where its coordinates are on the Earth. Nothing is converted.
struct MapCrs {
    int epsg = 0;     ///< number in the register of EPSG; 0: none
    std::string wkt;  ///< its definition as well-known text; may be empty

    /// Neither is known.
    bool undefined() const { return epsg == 0 && wkt.empty(); }
};

/// The system that "EPSG:32632" names. Throws InvalidInput where the text is no such name.
MapCrs parse_crs(std::string_view text);

/// A value of a feature: nothing, a whole number, a number or a text.
using MapValue = std::variant<std::monostate, std::int64_t, double, std::string>;

/// What a layer consists of.
enum class MapGeometry : std::uint8_t { points, polygons };

/// A place or an area with what is known of it.
struct MapFeature {
    /// [m] the point; or the outline of a polygon, counter-clockwise, three corners at least, the first one
    /// not repeated, of which z is not written
    std::vector<Vec3d> corners;
    std::vector<MapValue> values;  ///< one for each column of the layer
};

/// Features of one kind with the same columns.
struct MapLayer {
    std::string name;                            ///< none twice in a map
    MapGeometry geometry = MapGeometry::points;  ///< of all features
    std::vector<std::string> columns;  ///< their names, none of them twice, `fid`, `geom` or `layer`
    std::vector<MapFeature> features;  ///< with a value for each column
};

/// Formats of maps.
enum class MapFormat : std::uint8_t { geojson, geopackage };

/// By the ending of the name: .geojson, .gpkg.
std::optional<MapFormat> map_format_of_name(const std::filesystem::path& path);

/// Writes layers of a map; the file appears whole or not at all.
///
/// * GeoJSON: one collection, in which the property `layer` names the layer of a feature. RFC 7946 wants
///   longitude and latitude; coordinates are written as they are, and the system is named by the member `crs`
///   of the standard before it [GeoJSON2008], which GDAL and QGIS read, where its EPSG number is known.
/// * GeoPackage 1.3: a table for each layer. A system that is not known is "undefined Cartesian" (-1). The
///   date of change is 1970-01-01, so that the same map has the same bytes.
///
/// Throws IoError for trouble with the file, Unsupported for a name of no known format; Cancelled.
void write_map(const std::filesystem::path& path, std::span<const MapLayer> layers, const MapCrs& crs = {},
               const Context& ctx = {});

}  // namespace coppice
