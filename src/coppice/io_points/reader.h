#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/error.h"
#include "coppice/base/fields.h"
#include "coppice/points/point_cloud.h"

namespace coppice {

/// Formats in which points are written; LAZ, PCD and others are read only.
enum class PointFormat {
    xyz,  ///< text: one point per line, coordinates first; also .txt, .csv and .asc
    ply,  ///< written binary little endian; read in all three encodings
    las   ///< written as LAS 1.4
};

/// Options for reading points.
struct ReadPointsOptions {
    bool allow_truncated = false;  ///< reads the existing points of LAS and LAZ files that are cut off
};

/// Lists the members for front ends.
void list_fields(ReadPointsOptions& options, FieldList& list);

/// An extra dimension of LAS: a number of the points in addition to those that LAS prescribes.
struct PointDimension {
    std::string name;                                      ///< as in the file, in ASCII
    double low = std::numeric_limits<double>::infinity();  ///< minimum of all points; greater than `high` if
                                                           ///< no point has a value
    double high = -std::numeric_limits<double>::infinity();  ///< maximum of all points
};

/// A LAS or LAZ file is cut off; `ReadPointsOptions::allow_truncated` reads the existing points.
class TruncatedFile : public InvalidInput {
  public:
    using InvalidInput::InvalidInput;
};

/// Coordinate reference system of a file, as variable length records of LAS.
struct CoordinateSystem {
    /// A variable length record of LAS.
    struct Record {
        std::uint16_t id = 0;  ///< 34735 to 34737 for the GeoTIFF keys, or `kWkt`
        std::string data;      ///< as in the file
        friend bool operator==(const Record&, const Record&) = default;  ///< memberwise
    };
    static constexpr std::uint16_t kWkt = 2112;  ///< id of the record with WKT
    std::vector<Record> records;                 ///< empty if the file names no system

    bool has_wkt() const;      ///< whether there is a record with WKT
    std::string name() const;  ///< "EPSG:25832", or the name in the records; empty if they have no name
};

/// Points of a file with metadata.
struct PointFile {
    PointCloud point_cloud;            ///< the points with their attributes
    std::string format;                ///< "LAS 1.4, point format 7", "PLY", "ray cloud (PLY)"
    std::uint64_t without_return = 0;  ///< number of omitted rays of a ray cloud that have no return
    std::uint64_t missing = 0;  ///< number of points that the header specifies but a truncated file lacks
    std::vector<PointDimension> dimensions = {};  ///< of LAS, if PointColumns::ranges is set
    CoordinateSystem system = {};                 ///< of LAS
};

/// Returns the format by the last extension of the name, case-insensitively; nullopt if it is not a point
/// format.
std::optional<PointFormat> point_format_of_name(const std::filesystem::path& path);

/// Reads points from an XYZ, PTS, PTX, PLY, LAS, LAZ, PCD or OFF file. The format is detected by the first
/// bytes, independent of the name; any other content is read as XYZ.
///
/// XYZ: lines of numbers, separated by blanks, commas or semicolons. The first line, or a comment before the
/// first point, may name the columns, with or without quotes: then x, y and z are found by their names, in
/// upper or lower case, also as x_coord, coord_x, pos_x, Points:0 or easting, northing and elevation. Without
/// names they are the first three numbers. Other columns are ignored, as are empty lines, text after `#` or
/// `//`, and row names as written by R. Decimal commas are refused. PTS: the number of points, then x y z,
/// intensity, red, green and blue of each; any number of such blocks. PTX: scans, transformed as their header
/// specifies; pulses without echo are ignored. PLY: x, y and z of the element `vertex`; everything else is
/// ignored. A file is a ray cloud of raycloudtools if its vertices have `time`, 8-bit `alpha` and vectors `nx
/// ny nz` that, unlike normals, are not all of length 1: then vertices with alpha 0 are rays without return
/// and are omitted. LAS: 1.0 to 1.4, point formats 0 to 10; withheld points are ignored. LAZ: all versions of
/// [Isenburg2013], chunks are decompressed in parallel. PCD: x, y and z in ascii, binary or
/// binary_compressed; points that are not a number are ignored. OFF: the vertices of a text without faces.
///
/// If coordinates are large relative to the extent of the points, `origin` stores the offset in double
/// precision; otherwise it is zero.
///
/// Throws, each with one sentence that names the file and the line or point: `IoError` (see `read_file`),
/// `InvalidInput` for damaged files, files without points, column names without x, y or z, and coordinates
/// that are not finite or exceed 1e30, `Unsupported` for unknown kinds of LAS and E57 and for compressed
/// files, with the remedy; `Cancelled`. Linear; memory is bounded by a small multiple of the size of the
/// file.
PointSet read_points(const std::filesystem::path& path, const Context& ctx = {});

/// Reads points with the requested columns that the file has: all of LAS except those that are zero
/// throughout; intensity and colour of PTS and PTX; of PLY and of text with column names `classification`,
/// `intensity` or `reflectance` (also with the prefix `scalar_`), `red`, `green` and `blue` (in text also
/// `r`, `g` and `b`), `return_number` and `number_of_returns`, and of PLY `distance`. 16-bit colours are
/// reduced to 8 bits. Tree ids are read from the column, property or extra dimension of LAS that is named
/// treeID, tree_id, PredInstance, instance, label or similar, in any case; values other than integers from 1
/// to 2^32 - 1 mean no tree.
PointFile read_point_file(const std::filesystem::path& path, const PointColumns& columns = {},
                          const ReadPointsOptions& options = {}, const Context& ctx = {});
/// Returns the points of `read_point_file`.
PointCloud read_point_cloud(const std::filesystem::path& path, const PointColumns& columns = {},
                            const Context& ctx = {});

/// Reads points with columns from memory; `source` names them in messages.
PointFile parse_point_file(std::string_view bytes, const std::string& source,
                           const PointColumns& columns = {}, const ReadPointsOptions& options = {},
                           const Context& ctx = {});
/// Reads the positions only, from memory.
PointSet parse_points(std::string_view bytes, const std::string& source, const Context& ctx = {});
/// Returns the points of `parse_point_file`.
PointCloud parse_point_cloud(std::string_view bytes, const std::string& source,
                             const PointColumns& columns = {}, const Context& ctx = {});

}  // namespace coppice
