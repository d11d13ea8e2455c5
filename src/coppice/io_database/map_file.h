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

/// Coordinate reference system of a map. Coordinates are not converted.
struct MapCrs {
    int epsg = 0;     ///< EPSG code; 0: none
    std::string wkt;  ///< definition as well-known text; may be empty

    /// Returns whether there is neither a code nor a definition.
    bool undefined() const { return epsg == 0 && wkt.empty(); }
};

/// Parses a name such as "EPSG:32632". Throws InvalidInput if the text is not such a name.
MapCrs parse_crs(std::string_view text);

/// Value of an attribute of a feature: null, integer, number or text.
using MapValue = std::variant<std::monostate, std::int64_t, double, std::string>;

/// Geometry type of a layer.
enum class MapGeometry : std::uint8_t { points, polygons };

/// A point or an area with attributes.
struct MapFeature {
    /// [m] the point; or the outline of a polygon, counter-clockwise, at least three corners, the first one
    /// not repeated, written without z
    std::vector<Vec3d> corners;
    std::vector<MapValue> values;  ///< one for each column of the layer
};

/// Features of one geometry type with the same columns.
struct MapLayer {
    std::string name;                            ///< unique in a map
    MapGeometry geometry = MapGeometry::points;  ///< type of all features
    std::vector<std::string> columns;            ///< unique names other than `fid`, `geom` and `layer`
    std::vector<MapFeature> features;            ///< each has a value for each column
};

/// File format of a map.
enum class MapFormat : std::uint8_t { geojson, geopackage };

/// Returns the format by the extension of the name: .geojson, .gpkg.
std::optional<MapFormat> map_format_of_name(const std::filesystem::path& path);

/// Writes the layers of a map atomically (see AtomicFile).
///
/// * GeoJSON: one collection; the property `layer` of a feature names its layer. RFC 7946 requires longitude
/// and latitude; coordinates are written unchanged, and if the EPSG code is known, it is written as the
/// member `crs` of the preceding standard [GeoJSON2008], which GDAL and QGIS read.
/// * GeoPackage 1.3: a table for each layer. An unknown system is written as "undefined Cartesian" (-1). The
/// date of change is 1970-01-01, so that equal maps give bit-identical files.
///
/// Throws IoError if the file cannot be written, Unsupported if the extension is unknown; Cancelled.
void write_map(const std::filesystem::path& path, std::span<const MapLayer> layers, const MapCrs& crs = {},
               const Context& ctx = {});

}  // namespace coppice
