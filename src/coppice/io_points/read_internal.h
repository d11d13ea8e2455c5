#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/io_points/reader.h"
#include "coppice/points/point_cloud.h"

namespace coppice::io_internal {

/// Points as read from a file, before their origin is chosen.
struct FoundPoints {
    std::vector<Vec3d> places = {};    ///< [m] finite, at most 1e30
    PointCloud known = {};             ///< all columns except `points`
    std::string format = {};           ///< see PointFile
    std::uint64_t without_return = 0;  ///< see PointFile
    CoordinateSystem system = {};      ///< see PointFile

    /// Before the first point, reserves memory for the points that the rest of a text would contain if its
    /// rows were as long as the first, which avoids copies while growing. Unused reserved memory is not
    /// committed.
    void expect(std::size_t remaining, std::size_t row) {
        if (places.empty()) places.reserve(remaining / (row + 1) + 1);
    }

    /// Adds a value of the last point to a column. A column that a previous point lacks stays short.
    template <class T>
    void note(std::vector<T>& column, T value) const {
        if (column.size() + 1 == places.size()) column.push_back(value);
    }
};

/// Chooses the origin, rounds the positions and drops incomplete columns and columns that are not requested.
/// Throws `InvalidInput` if there is no point.
PointFile finish_points(FoundPoints found, const PointColumns& wanted, const std::string& source);

/// Returns whether the coordinates are finite and at most 1e30, near the limit of float.
bool fits_points(Vec3d p);

/// Returns the colour of three numbers from 0 to 255; nullopt if one is out of range.
std::optional<Rgb> to_color(double red, double green, double blue);
/// Returns a class, return number or part of a colour; 0 if it is out of [0, 255].
std::uint8_t to_byte(double number);
/// Returns a tree id; 0 (no tree) if it is not an integer from 1 to 2^32 - 1.
std::uint32_t to_tree_id(double number);

/// Returns the index of the name, in any case, that most probably denotes tree ids: `tree_id`,
/// `PredInstance`, `label` and so on; nullopt if there is none. Text, PLY and LAS use the same names.
std::optional<std::size_t> find_tree_ids(std::span<const std::string> names);

bool is_las(std::string_view bytes);  ///< starts with the signature "LASF"; LAZ does too
bool is_e57(std::string_view bytes);  ///< starts with the signature "ASTM-E57"
bool is_pcd(std::string_view bytes);  ///< starts with the comment or the version line of PCD

/// Reads LAS and LAZ 1.0 to 1.4, point formats 0 to 10; ignores points marked as withheld.
PointFile parse_las(std::string_view bytes, const PointColumns& wanted, const ReadPointsOptions& options,
                    const std::string& source, const Context& ctx);

/// Reads the element `vertex` of PLY, see `read_points`.
FoundPoints parse_ply_points(std::string_view bytes, const std::string& source, const Context& ctx);

/// Reads E57 1.0: all scans, transformed by their poses; points that are marked as invalid or are not a
/// number are pulses without return.
FoundPoints parse_e57(std::string_view bytes, const std::string& source, const Context& ctx);

/// Reads PCD 0.5 to 0.7 with data ascii, binary or binary_compressed; ignores points with NaN coordinates.
std::vector<Vec3d> parse_pcd(std::string_view bytes, const std::string& source, const Context& ctx);

/// Reads text, see `read_points`.
FoundPoints parse_xyz(std::string_view text, const std::string& source, const Context& ctx);

/// Text formats that begin with counts of points, and so are not XYZ.
enum class ScannerText {
    none,
    pts,  ///< blocks of the number of points, then x y z, intensity and colour of each
    ptx   ///< scans: columns, rows, position and axes of the scanner, a transformation, then the points as in
          ///< PTS
};
ScannerText scanner_text(std::string_view text);

FoundPoints parse_pts(std::string_view text, const std::string& source, const Context& ctx);

/// Applies the transformation of each scan; ignores points at the origin of their scan, which are pulses
/// without echo.
FoundPoints parse_ptx(std::string_view text, const std::string& source, const Context& ctx);

}  // namespace coppice::io_internal
