#include "coppice/io_database/map_file.h"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/system/file.h"
#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

/// Two stems, the second one without a name, and a crown.
std::vector<MapLayer> small_map() {
    const std::vector<std::string> columns{"tree", "height_m", "name"};
    return {{"stems",
             MapGeometry::points,
             columns,
             {{{{500000.125, 5400000.5, 312.25}}, {std::int64_t{1}, 20.5, std::string("oak \"big\"")}},
              {{{500010, 5399990, 310}}, {std::int64_t{2}, 7.25, std::monostate()}}}},
            {"crowns",
             MapGeometry::polygons,
             columns,
             {{{{0, 0, 1}, {4, 0, 1}, {0, 3, 1}}, {std::int64_t{1}, 20.5, std::string("oak")}}}}};
}

class MapFileTest : public test::FolderTest {
  protected:
    std::string written(const std::string& name, const MapCrs& crs) const {
        write_map(folder_ / name, small_map(), crs);
        return read_file(folder_ / name);
    }
    /// Returns the rows of a query, with cells separated by blanks.
    std::vector<std::string> rows(const std::string& name, const char* sql) const {
        sqlite3* database = nullptr;
        EXPECT_EQ(sqlite3_open_v2((folder_ / name).c_str(), &database, SQLITE_OPEN_READONLY, nullptr),
                  SQLITE_OK);
        std::vector<std::string> out;
        char* error = nullptr;
        const auto add = [](void* to, int count, char** cells, char**) {
            std::string row;
            for (int i = 0; i < count; ++i)
                row += (i > 0 ? " " : "") + std::string(cells[i] == nullptr ? "NULL" : cells[i]);
            static_cast<std::vector<std::string>*>(to)->push_back(row);
            return 0;
        };
        EXPECT_EQ(sqlite3_exec(database, sql, add, &out, &error), SQLITE_OK) << error;
        sqlite3_close(database);
        return out;
    }
};

using Rows = std::vector<std::string>;

TEST_F(MapFileTest, GeoJsonContainsPointsPolygonsAndProperties) {
    const auto map = nlohmann::json::parse(written("a.geojson", {.epsg = 32632}));
    EXPECT_EQ(map["type"], "FeatureCollection");
    EXPECT_EQ(map["crs"]["properties"]["name"], "urn:ogc:def:crs:EPSG::32632");
    ASSERT_EQ(map["features"].size(), 3u);
    const auto& stem = map["features"][0];
    EXPECT_EQ(stem["geometry"]["type"], "Point");
    EXPECT_EQ(stem["geometry"]["coordinates"], nlohmann::json::array({500000.125, 5400000.5, 312.25}));
    EXPECT_EQ(stem["properties"]["layer"], "stems");
    EXPECT_EQ(stem["properties"]["tree"], 1);
    EXPECT_EQ(stem["properties"]["name"], "oak \"big\"");
    EXPECT_TRUE(map["features"][1]["properties"]["name"].is_null());
    const auto& ring = map["features"][2]["geometry"]["coordinates"][0];
    EXPECT_EQ(ring, nlohmann::json::parse("[[0.0,0.0],[4.0,0.0],[0.0,3.0],[0.0,0.0]]"));
}

TEST_F(MapFileTest, GeoJsonOmitsAnUnknownReferenceSystem) {
    EXPECT_FALSE(nlohmann::json::parse(written("a.geojson", {})).contains("crs"));
    EXPECT_FALSE(
        nlohmann::json::parse(written("b.geojson", {.epsg = 0, .wkt = "LOCAL_CS[]"})).contains("crs"));
}

TEST_F(MapFileTest, GeoPackageHasItsTables) {
    const std::string bytes = written("a.gpkg", {.epsg = 32632});
    EXPECT_EQ(bytes.substr(0, 15), "SQLite format 3");
    EXPECT_EQ(bytes.substr(68, 4), "GPKG");
    EXPECT_EQ(rows("a.gpkg", "PRAGMA integrity_check"), Rows{"ok"});
    EXPECT_EQ(rows("a.gpkg", "PRAGMA foreign_key_check"), Rows{});
    EXPECT_EQ(
        rows("a.gpkg", "SELECT table_name, data_type, min_x, max_x, min_y, max_y, srs_id FROM gpkg_contents"),
        (Rows{"stems features 500000.125 500010.0 5399990.0 5400000.5 32632",
              "crowns features 0.0 4.0 0.0 3.0 32632"}));
    EXPECT_EQ(rows("a.gpkg", "SELECT * FROM gpkg_geometry_columns"),
              (Rows{"stems geom POINT 32632 1 0", "crowns geom POLYGON 32632 0 0"}));
    EXPECT_EQ(rows("a.gpkg", "SELECT srs_id, organization FROM gpkg_spatial_ref_sys ORDER BY srs_id"),
              (Rows{"-1 NONE", "0 NONE", "4326 EPSG", "32632 EPSG"}));
    EXPECT_EQ(rows("a.gpkg", "SELECT fid, tree, typeof(tree), height_m, typeof(height_m), name FROM stems"),
              (Rows{"1 1 integer 20.5 real oak \"big\"", "2 2 integer 7.25 real NULL"}));
}

TEST_F(MapFileTest, GeoPackageGeometriesAreWellKnownBinary) {
    written("a.gpkg", {});
    // "GP", version 0, little endian without an envelope; the system -1; a point with z; 4.0 is 0x4010...
    const Rows stem = rows("a.gpkg", "SELECT hex(geom) FROM stems WHERE fid = 2");
    EXPECT_EQ(stem[0].substr(0, 26), "47500001FFFFFFFF01E9030000");
    EXPECT_EQ(stem[0].size(), 2 * (8 + 5 + 24u));
    // A polygon with one ring of four corners, the first one repeated.
    const Rows crown = rows("a.gpkg", "SELECT hex(geom) FROM crowns");
    EXPECT_EQ(crown[0].substr(0, 16 + 26), "47500001FFFFFFFF01030000000100000004000000");
    EXPECT_EQ(crown[0].substr(16 + 26 + 2 * 16, 16), "0000000000001040");
    EXPECT_EQ(crown[0].size(), 2 * (8 + 13 + 64u));
}

TEST_F(MapFileTest, GeoPackagePreservesReferenceSystemsAsText) {
    written("a.gpkg", {.epsg = 0, .wkt = "LOCAL_CS[\"plot\"]"});
    EXPECT_EQ(rows("a.gpkg",
                   "SELECT definition FROM gpkg_spatial_ref_sys WHERE srs_id = "
                   "(SELECT srs_id FROM gpkg_contents LIMIT 1)"),
              Rows{"LOCAL_CS[\"plot\"]"});
}

TEST_F(MapFileTest, TheSameMapHasTheSameBytes) { EXPECT_EQ(written("a.gpkg", {}), written("b.gpkg", {})); }

TEST_F(MapFileTest, RejectsOtherExtensions) {
    EXPECT_EQ(test::error_of<Unsupported>([&] { write_map("trees.shp", small_map()); }),
              "'trees.shp' is no name of a map; use the ending .geojson or .gpkg");
}

TEST(MapCrs, AcceptsEpsgNumbersOnly) {
    EXPECT_EQ(parse_crs("EPSG:32632").epsg, 32632);
    EXPECT_EQ(parse_crs("epsg:4326").epsg, 4326);
    for (const char* const text :
         {"", "EPSG:", "EPSG:0", "EPSG:-1", "EPSG:32632.5", "EPSG:1e9", "32632", "UTM 32"})
        EXPECT_THROW(parse_crs(text), InvalidInput) << text;
}

}  // namespace
}  // namespace coppice
