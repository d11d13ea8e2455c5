#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>

#include "coppice/io_database/database_internal.h"
#include "coppice/io_database/map_writers_internal.h"

namespace coppice::io_internal {
namespace {

// Tables and constants follow OGC 12-128r17 (GeoPackage 1.3).
constexpr int kUndefinedCartesian = -1;
constexpr int kOwnSystem = 100'000;  // id of a system given as well-known text without an EPSG code

constexpr const char* kTables = R"(
PRAGMA application_id = 0x47504B47;
PRAGMA user_version = 10300;
CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL, srs_id INTEGER NOT NULL PRIMARY KEY,
    organization TEXT NOT NULL, organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL,
    description TEXT);
CREATE TABLE gpkg_contents (table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL,
    identifier TEXT UNIQUE, description TEXT DEFAULT '',
    last_change DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ', 'now')),
    min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE, srs_id INTEGER,
    CONSTRAINT fk_gc_r_srs_id FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id));
CREATE TABLE gpkg_geometry_columns (table_name TEXT NOT NULL, column_name TEXT NOT NULL,
    geometry_type_name TEXT NOT NULL, srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL,
    CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name),
    CONSTRAINT uk_gc_table_name UNIQUE (table_name),
    CONSTRAINT fk_gc_tn FOREIGN KEY (table_name) REFERENCES gpkg_contents(table_name),
    CONSTRAINT fk_gc_srs FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys (srs_id));
INSERT INTO gpkg_spatial_ref_sys VALUES
    ('Undefined Cartesian SRS', -1, 'NONE', -1, 'undefined', 'undefined Cartesian coordinate reference system'),
    ('Undefined geographic SRS', 0, 'NONE', 0, 'undefined', 'undefined geographic coordinate reference system'),
    ('WGS 84 geodetic', 4326, 'EPSG', 4326, 'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563,AUTHORITY["EPSG","7030"]],AUTHORITY["EPSG","6326"]],PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4326"]]', 'longitude and latitude in degrees on the WGS 84 ellipsoid');
)";

/// Inserts a row for the system, if needed, and returns its id in the file.
int add_system(const Sqlite& database, const MapCrs& crs) {
    if (crs.undefined()) return kUndefinedCartesian;
    const int id = crs.epsg > 0 ? crs.epsg : kOwnSystem;
    Statement insert(database, "INSERT OR IGNORE INTO gpkg_spatial_ref_sys VALUES (?, ?, ?, ?, ?, NULL)");
    const std::string name = crs.epsg > 0 ? fmt::format("EPSG:{}", crs.epsg) : "as the cloud has it";
    insert.bind(1, std::string_view(name));
    insert.bind(2, std::int64_t{id});
    insert.bind(3, crs.epsg > 0 ? std::string_view("EPSG") : std::string_view("NONE"));
    insert.bind(4, std::int64_t{id});
    // Programs resolve EPSG codes themselves.
    insert.bind(5, crs.wkt.empty() ? std::string_view("undefined") : std::string_view(crs.wkt));
    insert.run();
    return id;
}

/// A sequence of little-endian values.
class Bytes {
  public:
    template <class Number>
    void add(Number number) {
        std::array<char, sizeof(Number)> bytes{};
        std::memcpy(bytes.data(), &number, sizeof(Number));
        if constexpr (std::endian::native == std::endian::big) std::ranges::reverse(bytes);
        out_.append(bytes.data(), bytes.size());
    }
    std::span<const std::byte> span() const { return std::as_bytes(std::span(out_)); }

  private:
    std::string out_;
};

/// Returns the header of a GeoPackage geometry without an envelope, followed by its well-known binary.
Bytes compute_geometry(const MapFeature& feature, MapGeometry geometry, int system) {
    constexpr std::uint8_t kLittleEndian = 1;
    constexpr std::uint32_t kPointZ = 1001, kPolygon = 3;
    Bytes out;
    for (const char c : {'G', 'P', '\0'}) out.add(c);
    out.add(kLittleEndian);
    out.add(std::int32_t{system});
    out.add(kLittleEndian);
    if (geometry == MapGeometry::points) {
        out.add(kPointZ);
        for (int axis = 0; axis < 3; ++axis) out.add(feature.corners.front()[axis]);
        return out;
    }
    out.add(kPolygon);
    out.add(std::uint32_t{1});
    out.add(static_cast<std::uint32_t>(feature.corners.size() + 1));
    for (std::size_t i = 0; i <= feature.corners.size(); ++i) {
        const Vec3d p = feature.corners[i % feature.corners.size()];
        out.add(p.x);
        out.add(p.y);
    }
    return out;
}

std::string quoted(std::string name) {
    for (std::size_t at = 0; (at = name.find('"', at)) != std::string::npos; at += 2) name.insert(at, 1, '"');
    return fmt::format("\"{}\"", name);
}

/// Returns the SQL type of the first value that is not null.
std::string_view get_type(const MapLayer& layer, std::size_t column) {
    constexpr std::array<std::string_view, 4> kTypes{"TEXT", "INTEGER", "REAL", "TEXT"};
    for (const MapFeature& feature : layer.features)
        if (feature.values[column].index() > 0) return kTypes[feature.values[column].index()];
    return kTypes[0];
}

std::string_view get_type(MapGeometry geometry) {
    return geometry == MapGeometry::points ? "POINT" : "POLYGON";
}

void create_table(const Sqlite& database, const MapLayer& layer) {
    std::string sql = fmt::format("CREATE TABLE {} (fid INTEGER PRIMARY KEY NOT NULL, geom {}",
                                  quoted(layer.name), get_type(layer.geometry));
    for (std::size_t c = 0; c < layer.columns.size(); ++c)
        sql += fmt::format(", {} {}", quoted(layer.columns[c]), get_type(layer, c));
    database.execute(fmt::format("{})", sql).c_str());
}

/// Inserts the rows of the catalogue tables, which list the tables and their contents.
void describe_table(const Sqlite& database, const MapLayer& layer, int system) {
    Vec3d low, high;
    bool any = false;
    for (const MapFeature& feature : layer.features) {
        for (const Vec3d p : feature.corners) {
            low = any ? Vec3d{std::min(low.x, p.x), std::min(low.y, p.y), 0} : p;
            high = any ? Vec3d{std::max(high.x, p.x), std::max(high.y, p.y), 0} : p;
            any = true;
        }
    }
    Statement content(
        database,
        "INSERT INTO gpkg_contents VALUES (?1, 'features', ?1, '', '1970-01-01T00:00:00.000Z', ?2, "
        "?3, ?4, ?5, ?6)");
    content.bind(1, std::string_view(layer.name));
    if (any) {
        content.bind(2, low.x);
        content.bind(3, low.y);
        content.bind(4, high.x);
        content.bind(5, high.y);
    }
    content.bind(6, std::int64_t{system});
    content.run();
    Statement geometry(database, "INSERT INTO gpkg_geometry_columns VALUES (?, 'geom', ?, ?, ?, 0)");
    geometry.bind(1, std::string_view(layer.name));
    geometry.bind(2, get_type(layer.geometry));
    geometry.bind(3, std::int64_t{system});
    geometry.bind(4, std::int64_t{layer.geometry == MapGeometry::points});
    geometry.run();
}

/// Binds a value to a parameter of a statement.
struct Bind {
    Statement& statement;
    int parameter;

    void operator()(std::monostate) const { statement.bind_null(parameter); }
    void operator()(const std::string& text) const { statement.bind(parameter, std::string_view(text)); }
    template <class Number>
    void operator()(Number number) const {
        statement.bind(parameter, number);
    }
};

void fill_table(const Sqlite& database, const MapLayer& layer, int system) {
    std::string sql = fmt::format("INSERT INTO {} VALUES (NULL, ?", quoted(layer.name));
    for (std::size_t c = 0; c < layer.columns.size(); ++c) sql += ", ?";
    Statement insert(database, sql + ")");
    for (const MapFeature& feature : layer.features) {
        database.throw_if_cancelled();
        const Bytes geometry = compute_geometry(feature, layer.geometry, system);
        insert.bind(1, geometry.span());
        for (std::size_t c = 0; c < layer.columns.size(); ++c)
            std::visit(Bind{insert, static_cast<int>(c) + 2}, feature.values[c]);
        insert.run();
    }
}

}  // namespace

std::string encode_geopackage(std::span<const MapLayer> layers, const MapCrs& crs, const Context& ctx) {
    const Sqlite database(":memory:", SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_MEMORY, ctx);
    database.execute(kTables);
    Transaction transaction(database);
    const int system = add_system(database, crs);
    for (const MapLayer& layer : layers) {
        create_table(database, layer);
        describe_table(database, layer, system);
        fill_table(database, layer, system);
    }
    transaction.commit();
    sqlite3_int64 size = 0;
    const std::unique_ptr<unsigned char, decltype(&sqlite3_free)> bytes(
        sqlite3_serialize(database.handle(), "main", &size, 0), sqlite3_free);
    if (bytes == nullptr) throw std::bad_alloc();
    return {reinterpret_cast<const char*>(bytes.get()), static_cast<std::size_t>(size)};
}

}  // namespace coppice::io_internal
