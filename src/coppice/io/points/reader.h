#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/points/painted_points.h"

namespace coppice {

/// The point files that are written; LAS, LAZ and PCD are read only.
enum class PointFormat {
    xyz,  ///< text: one point a line, its coordinates first; also .txt, .csv and .asc
    ply   ///< written binary little endian; read in all three encodings
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
/// PLY: x, y and z of the element `vertex`; everything else is passed over.
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
/// `g` and `b`), and of PLY `distance`. Colours of 16 bits are brought to 8.
PaintedPoints read_painted_points(const std::filesystem::path& path, const PointColumns& columns = {},
                                  const Context& ctx = {});

/// The same from memory; `source` names it in messages.
PointSet parse_points(std::string_view bytes, const std::string& source, const Context& ctx = {});
/// The same from memory, with columns.
PaintedPoints parse_painted_points(std::string_view bytes, const std::string& source,
                                   const PointColumns& columns = {}, const Context& ctx = {});

}  // namespace coppice
