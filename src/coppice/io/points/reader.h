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
#include "coppice/points/painted_points.h"

namespace coppice {

/// The point files that are written; LAZ, PCD and others are read only.
enum class PointFormat {
    xyz,  ///< text: one point a line, its coordinates first; also .txt, .csv and .asc
    ply,  ///< written binary little endian; read in all three encodings
    las   ///< written as LAS 1.4
};

/// How a file of points is understood.
struct ReadPointsOptions {
    bool allow_truncated = false;  ///< of LAS and LAZ files that are cut off, takes what is there
};

template <class Self, class Visitor>
requires SameOptions<Self, ReadPointsOptions>
constexpr void visit_fields(Self& options, Visitor&& visit) {
    visit(Field{"allow_truncated",
                "Read the points that are there of a LAS or LAZ file that holds fewer than its header names"},
          options.allow_truncated);
}

/// A number that the points of a file have besides those that LAS prescribes: an extra dimension of LAS.
struct PointDimension {
    std::string name;                                        ///< as the file has it, in ASCII
    double low = std::numeric_limits<double>::infinity();    ///< of all points; beyond `high` if none has it
    double high = -std::numeric_limits<double>::infinity();  ///< of all points
};

/// A LAS or LAZ file is cut off: `ReadPointsOptions::allow_truncated` reads the points that are there.
class TruncatedFile : public InvalidInput {
  public:
    using InvalidInput::InvalidInput;
};

/// The system of the coordinates of a file, as the variable length records of LAS have it.
struct CoordinateSystem {
    /// One of the records, as LAS has it.
    struct Record {
        std::uint16_t id = 0;  ///< 34735 to 34737 for the keys of GeoTIFF, or `kWkt`
        std::string data;      ///< as in the file
        friend bool operator==(const Record&, const Record&) = default;  ///< bit by bit
    };
    static constexpr std::uint16_t kWkt = 2112;  ///< id of the record with WKT
    std::vector<Record> records;                 ///< none where the file names no system

    bool has_wkt() const;  ///< whether WKT is among the records
    std::string name()
        const;  ///< "EPSG:25832", or the name that the records give; empty where they give none
};

/// Points from a file, and what else it says.
struct PointFile {
    PaintedPoints painted;             ///< the points, with what is known of each
    std::string format;                ///< "LAS 1.4, point format 7", "PLY", "ray cloud (PLY)"
    std::uint64_t without_return = 0;  ///< rays of a ray cloud that met nothing, left out
    std::uint64_t missing = 0;         ///< points that the header names, but a truncated file has not
    std::vector<PointDimension> dimensions = {};  ///< of LAS, where PointColumns::ranges asks for them
    CoordinateSystem system = {};                 ///< of LAS
};

/// By the last extension of the name, upper or lower case; nothing when it belongs to no format of points.
std::optional<PointFormat> point_format_of_name(const std::filesystem::path& path);

/// Reads points from an XYZ, PTS, PTX, PLY, LAS, LAZ, PCD or OFF file. A file that starts as one of the
/// others is one, whatever its name; anything else is taken for XYZ.
///
/// XYZ: lines of numbers, separated by blanks, commas or semicolons. The first line, or a comment before the
/// first point, may name the columns, in quotes or not: x, y and z are taken by their names then, in upper or
/// lower case, also as x_coord, coord_x, pos_x, Points:0 or easting, northing and elevation. Without names
/// they are the first three numbers. Other columns are passed over, as are empty lines and what stands behind
/// `#` or `//`, and names of rows as R writes them. Decimal commas are refused.
/// PTS: the number of points, then x y z, intensity, red, green and blue of each; any number of such blocks.
/// PTX: scans, moved by the transformation in their head; pulses without echo are passed over.
/// PLY: x, y and z of the element `vertex`; everything else is passed over. A file is a ray cloud of
/// raycloudtools if its vertices have `time`, `alpha` of 8 bits and vectors `nx ny nz` that are not all of
/// length 1, as normals would be: the vertices whose alpha is 0 are then rays without return, left out.
/// LAS: 1.0 to 1.4, point formats 0 to 10; what is marked as withheld is passed over. LAZ: all that
/// [Isenburg2013] knows, chunks unpacked in parallel. PCD: x, y and z, in ascii, binary or binary_compressed;
/// points that are not a number are passed over. OFF: the vertices of a text without faces.
///
/// Where coordinates are large against the size of the set, `origin` takes the offset in double precision;
/// else it is zero.
///
/// Throws, each with one sentence that names the file and the line or point: `IoError` (see `read_file`),
/// `InvalidInput` for damaged files, files without points, names of columns that lack x, y or z, and
/// coordinates that are not finite or beyond 1e30, `Unsupported` for LAS of a kind that is not known, and for
/// E57 and packed files, with what to do; `Cancelled`.
/// Linear; memory is bounded by a small multiple of the file.
PointSet read_points(const std::filesystem::path& path, const Context& ctx = {});

/// The same with the columns that are wanted and that the file has: all of LAS but those that are zero
/// throughout; intensity and colour of PTS and PTX; of PLY and of text with names `classification`,
/// `intensity` or `reflectance` (also with `scalar_` before it), `red`, `green` and `blue` (in text also `r`,
/// `g` and `b`), `return_number` and `number_of_returns`, and of PLY `distance`. Colours of 16 bits are
/// brought to 8. Ids of trees are those of the column, property or extra dimension of LAS that is called
/// treeID, tree_id, PredInstance, instance, label or the like, in any case; what is no number from 1 to 2^32
/// - 1 is of no tree.
PointFile read_point_file(const std::filesystem::path& path, const PointColumns& columns = {},
                          const ReadPointsOptions& options = {}, const Context& ctx = {});
/// The points of `read_point_file`.
PaintedPoints read_painted_points(const std::filesystem::path& path, const PointColumns& columns = {},
                                  const Context& ctx = {});

/// The same from memory, with columns; `source` names it in messages.
PointFile parse_point_file(std::string_view bytes, const std::string& source,
                           const PointColumns& columns = {}, const ReadPointsOptions& options = {},
                           const Context& ctx = {});
/// The places alone, from memory.
PointSet parse_points(std::string_view bytes, const std::string& source, const Context& ctx = {});
/// The points of `parse_point_file`.
PaintedPoints parse_painted_points(std::string_view bytes, const std::string& source,
                                   const PointColumns& columns = {}, const Context& ctx = {});

}  // namespace coppice
