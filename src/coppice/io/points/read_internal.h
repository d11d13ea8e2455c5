#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/io/points/reader.h"
#include "coppice/points/painted_points.h"

namespace coppice::io_internal {

/// Points as a reader finds them in a file, before their origin is chosen.
struct FoundPoints {
    std::vector<Vec3d> places = {};    ///< [m] finite, not beyond 1e30
    PaintedPoints known = {};          ///< all but `points`
    std::string format = {};           ///< see PointFile
    std::uint64_t without_return = 0;  ///< see PointFile
    CoordinateSystem system = {};      ///< see PointFile

    /// Before the first point: room for as many as the rest of a text would hold in rows like the first, so
    /// that places are not held twice while they grow. Room that is not used takes no memory.
    void expect(std::size_t remaining, std::size_t row) {
        if (places.empty()) places.reserve(remaining / (row + 1) + 1);
    }

    /// Of the point that was found last. A column that an earlier point lacks stays short.
    template <class T>
    void note(std::vector<T>& column, T value) const {
        if (column.size() + 1 == places.size()) column.push_back(value);
    }
};

/// Chooses the origin and rounds; columns that some points lack are dropped, and those that are not wanted.
/// Throws `InvalidInput` when there is no point.
PointFile finish_points(FoundPoints found, const PointColumns& wanted, const std::string& source);

/// Whether a coordinate is finite and not beyond 1e30, where floats end.
bool fits_points(Vec3d p);

/// Of three numbers from 0 to 255; none where one is not.
std::optional<Rgb> color_of(double red, double green, double blue);
/// A class, or a return, by its number; 0 where it is none from 0 to 255.
std::uint8_t byte_of(double number);
/// The tree of a number; 0, which is none, where it is no number from 1 to 2^32 - 1.
std::uint32_t tree_id_of(double number);

/// Which of these names, in any case, is that of numbers of trees: `tree_id`, `PredInstance`, `label` and so
/// on, the surest one; none where none is. Text, PLY and LAS agree on it.
std::optional<std::size_t> find_tree_ids(std::span<const std::string> names);

bool is_las(std::string_view bytes);  ///< starts with the signature "LASF"; LAZ does too
bool is_e57(std::string_view bytes);  ///< starts with the signature "ASTM-E57"
bool is_pcd(std::string_view bytes);  ///< starts with the comment or the version line of PCD

/// LAS and LAZ 1.0 to 1.4, all point formats from 0 to 10; points marked as withheld are passed over.
PointFile parse_las(std::string_view bytes, const PointColumns& wanted, const ReadPointsOptions& options,
                    const std::string& source, const Context& ctx);

/// The element `vertex` of PLY, see `read_points`.
FoundPoints parse_ply_points(std::string_view bytes, const std::string& source, const Context& ctx);

/// E57 1.0: all scans, moved by their poses; points that are marked as invalid, or are not a number, are
/// pulses without return.
FoundPoints parse_e57(std::string_view bytes, const std::string& source, const Context& ctx);

/// PCD 0.5 to 0.7, data ascii, binary and binary_compressed; points without numbers (NaN) are passed over.
std::vector<Vec3d> parse_pcd(std::string_view bytes, const std::string& source, const Context& ctx);

/// Text, see `read_points`.
FoundPoints parse_xyz(std::string_view text, const std::string& source, const Context& ctx);

/// What text begins with counts of points, and so is not XYZ.
enum class ScannerText {
    none,
    pts,  ///< the number of points, then x y z, intensity and colour of each; once or several times
    ptx  ///< scans: columns, rows, place and axes of the scanner, a transformation, then the points as in PTS
};
ScannerText scanner_text(std::string_view text);

FoundPoints parse_pts(std::string_view text, const std::string& source, const Context& ctx);

/// Points are moved by the transformation of their scan; those in its origin are pulses without echo, passed
/// over.
FoundPoints parse_ptx(std::string_view text, const std::string& source, const Context& ctx);

}  // namespace coppice::io_internal
