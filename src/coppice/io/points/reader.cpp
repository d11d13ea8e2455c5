#include "coppice/io/points/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/io/file.h"
#include "coppice/io/mesh/format.h"
#include "coppice/io/mesh/read_internal.h"
#include "coppice/io/ply_header.h"
#include "coppice/io/points/read_internal.h"

namespace coppice {
namespace {

constexpr double kLargestCoordinate = 1e30;

using io_internal::fits_points;
using io_internal::to_point_set;

/// The properties of a vertex that are kept.
struct Columns {
    std::array<std::size_t, 3> place;
    std::optional<std::size_t> distance;
    std::optional<std::array<std::size_t, 3>> color;

    Columns(const PlyElement& element, const std::string& source) {
        const auto x = element.find({"x"}), y = element.find({"y"}), z = element.find({"z"});
        if (!x || !y || !z)
            throw InvalidInput(fmt::format("{}: the vertices lack a property x, y or z", source));
        place = {*x, *y, *z};
        for (const std::size_t property : place) {
            if (element.properties[property].is_list())
                throw InvalidInput(fmt::format("{}: the coordinates of the vertices are lists", source));
        }
        distance = element.find({"distance"});
        if (distance && element.properties[*distance].is_list()) distance.reset();
        const auto red = element.find({"red"}), green = element.find({"green"}),
                   blue = element.find({"blue"});
        const auto is_byte = [&](std::optional<std::size_t> property) {
            return property && !element.properties[*property].is_list() &&
                   element.properties[*property].type == PlyType::uint8;
        };
        if (is_byte(red) && is_byte(green) && is_byte(blue)) color = {*red, *green, *blue};
    }
};

PaintedPoints read_vertices(PlyRows& rows, const PlyElement& element, const std::string& source) {
    const Columns columns(element, source);
    std::vector<Vec3d> points;
    points.reserve(element.count);
    PaintedPoints out;
    PlyRow row;
    for (std::uint64_t i = 0; i < element.count; ++i) {
        rows.read(row);
        const auto [x, y, z] = columns.place;
        points.push_back({row.scalar(x), row.scalar(y), row.scalar(z)});
        if (!fits_points(points.back())) {
            throw InvalidInput(fmt::format("{}: point {} is not finite or beyond 1e30", source, i));
        }
        if (columns.distance) out.distances.push_back(static_cast<float>(row.scalar(*columns.distance)));
        if (!columns.color) continue;
        const auto byte = [&](std::size_t k) {
            return static_cast<std::uint8_t>(row.scalar((*columns.color)[k]));
        };
        out.colors.push_back({byte(0), byte(1), byte(2)});
    }
    out.points = to_point_set(points, source);
    return out;
}

PaintedPoints parse_ply_points(std::string_view bytes, const std::string& source, const Context& ctx) {
    const PlyHeader header = parse_ply_header(bytes, source);
    PlyRows rows(bytes, header, source, ctx);
    for (const PlyElement& element : header.elements) {
        rows.begin_element(element);
        if (element.name == "vertex") return read_vertices(rows, element, source);
        rows.skip_element();
    }
    throw InvalidInput(fmt::format("{}: it has no element vertex", source));
}

PaintedPoints parse_painted_points(std::string_view bytes, const std::string& source, const Context& ctx) {
    if (is_ply(bytes)) return parse_ply_points(bytes, source, ctx);
    PaintedPoints out;
    if (io_internal::is_las(bytes)) {
        out.points = io_internal::parse_las(bytes, source, ctx);
    } else if (io_internal::is_pcd(bytes)) {
        out.points = io_internal::parse_pcd(bytes, source, ctx);
    } else if (mesh_format_of_content(bytes) == MeshFormat::off) {
        out.points = to_point_set(io_internal::parse_off_points(bytes, source, ctx), source);
    } else {
        out.points = to_point_set(io_internal::parse_xyz(bytes, source, ctx), source);
    }
    return out;
}

}  // namespace

bool io_internal::fits_points(Vec3d p) {
    return std::abs(p.x) <= kLargestCoordinate && std::abs(p.y) <= kLargestCoordinate &&
           std::abs(p.z) <= kLargestCoordinate;
}

PointSet io_internal::to_point_set(const std::vector<Vec3d>& points, const std::string& source) {
    if (points.empty()) throw InvalidInput(fmt::format("{}: it holds no points", source));
    PointSet set;
    set.origin = choose_origin(points);
    set.positions.reserve(points.size());
    for (const Vec3d& p : points) set.positions.push_back(Vec3(p - set.origin));
    return set;
}

std::optional<PointFormat> point_format_of_name(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    if (extension == ".ply") return PointFormat::ply;
    for (const std::string_view text : {".xyz", ".txt", ".csv", ".asc"}) {
        if (extension == text) return PointFormat::xyz;
    }
    return {};
}

PaintedPoints read_painted_points(const std::filesystem::path& path, const Context& ctx) {
    return parse_painted_points(read_file(path, kLargestFile, ctx), path.string(), ctx);
}

PointSet parse_points(std::string_view bytes, const std::string& source, const Context& ctx) {
    return parse_painted_points(bytes, source, ctx).points;
}

PointSet read_points(const std::filesystem::path& path, const Context& ctx) {
    return read_painted_points(path, ctx).points;
}

}  // namespace coppice
