#include "coppice/io/points/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "coppice/base/ascii.h"
#include "coppice/base/error.h"
#include "coppice/io/file.h"
#include "coppice/io/mesh/format.h"
#include "coppice/io/mesh/read_internal.h"
#include "coppice/io/ply_header.h"
#include "coppice/io/points/read_internal.h"
#include "coppice/io/unread_format.h"

namespace coppice {
namespace io_internal {

bool fits_points(Vec3d p) {
    constexpr double kLargest = 1e30;
    return std::abs(p.x) <= kLargest && std::abs(p.y) <= kLargest && std::abs(p.z) <= kLargest;
}

std::optional<Rgb> color_of(double red, double green, double blue) {
    Rgb color;
    std::size_t i = 0;
    for (const double c : {red, green, blue}) {
        if (!(c >= 0 && c <= 255)) return {};
        color[i++] = static_cast<std::uint8_t>(std::lround(c));
    }
    return color;
}

std::uint8_t class_of(double number) {
    return number >= 0 && number <= 255 ? static_cast<std::uint8_t>(number) : std::uint8_t{0};
}

PaintedPoints finish_points(FoundPoints found, const PointColumns& wanted, const std::string& source) {
    if (found.places.empty()) throw InvalidInput(fmt::format("{}: it holds no points", source));
    PaintedPoints out = std::move(found.known);
    PointSet& set = out.points;
    set.origin = choose_origin(found.places);
    set.positions.resize(found.places.size());
    std::ranges::transform(found.places, set.positions.begin(),
                           [&](const Vec3d& p) { return Vec3(p - set.origin); });
    const auto drop = [&](auto& column, bool is_wanted) {
        if (!is_wanted || column.size() != set.size()) column = {};
    };
    drop(out.distances, wanted.distances);
    drop(out.colors, wanted.colors);
    drop(out.classes, wanted.classes);
    drop(out.intensities, wanted.intensities);
    drop(out.return_numbers, wanted.returns);
    drop(out.return_counts, wanted.returns);
    return out;
}

}  // namespace io_internal

namespace {

using io_internal::finish_points;
using io_internal::FoundPoints;
using io_internal::ScannerText;

/// The properties of a vertex that are kept.
struct Columns {
    std::array<std::size_t, 3> place;
    std::optional<std::size_t> distance, classification, intensity;
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
        const auto scalar = [&](std::initializer_list<std::string_view> names) {
            const auto property = element.find(names);
            return property && !element.properties[*property].is_list() ? property : std::nullopt;
        };
        distance = scalar({"distance"});
        classification =
            scalar({"classification", "scalar_Classification", "scalar_classification", "class"});
        intensity = scalar({"intensity", "scalar_Intensity", "scalar_intensity", "reflectance",
                            "scalar_Reflectance", "scalar_reflectance"});
        const auto red = scalar({"red"}), green = scalar({"green"}), blue = scalar({"blue"});
        const auto is_byte = [&](std::optional<std::size_t> property) {
            return property && element.properties[*property].type == PlyType::uint8;
        };
        if (is_byte(red) && is_byte(green) && is_byte(blue)) color = {*red, *green, *blue};
    }
};

FoundPoints read_vertices(PlyRows& rows, const PlyElement& element, const std::string& source) {
    const Columns columns(element, source);
    FoundPoints found;
    found.places.reserve(element.count);
    PaintedPoints& known = found.known;
    PlyRow row;
    for (std::uint64_t i = 0; i < element.count; ++i) {
        rows.read(row);
        const auto [x, y, z] = columns.place;
        found.places.push_back({row.scalar(x), row.scalar(y), row.scalar(z)});
        if (!io_internal::fits_points(found.places.back())) {
            throw InvalidInput(fmt::format("{}: point {} is not finite or beyond 1e30", source, i));
        }
        if (columns.distance) known.distances.push_back(static_cast<float>(row.scalar(*columns.distance)));
        if (columns.classification)
            known.classes.push_back(io_internal::class_of(row.scalar(*columns.classification)));
        if (columns.intensity)
            known.intensities.push_back(static_cast<float>(row.scalar(*columns.intensity)));
        if (!columns.color) continue;
        const auto byte = [&](std::size_t k) {
            return static_cast<std::uint8_t>(row.scalar((*columns.color)[k]));
        };
        known.colors.push_back({byte(0), byte(1), byte(2)});
    }
    return found;
}

FoundPoints parse_ply_points(std::string_view bytes, const std::string& source, const Context& ctx) {
    const PlyHeader header = parse_ply_header(bytes, source);
    PlyRows rows(bytes, header, source, ctx);
    for (const PlyElement& element : header.elements) {
        rows.begin_element(element);
        if (element.name == "vertex") return read_vertices(rows, element, source);
        rows.skip_element();
    }
    throw InvalidInput(fmt::format("{}: it has no element vertex", source));
}

FoundPoints find_points(std::string_view bytes, const std::string& source, const Context& ctx) {
    if (is_ply(bytes)) return parse_ply_points(bytes, source, ctx);
    if (io_internal::is_pcd(bytes)) return {io_internal::parse_pcd(bytes, source, ctx), {}};
    if (mesh_format_of_content(bytes) == MeshFormat::off)
        return {io_internal::parse_off_points(bytes, source, ctx), {}};
    if (const auto unread = unread_format(bytes))
        throw Unsupported(fmt::format("{}: it is {}", source, *unread));
    switch (io_internal::scanner_text(bytes)) {
        case ScannerText::pts:
            return io_internal::parse_pts(bytes, source, ctx);
        case ScannerText::ptx:
            return io_internal::parse_ptx(bytes, source, ctx);
        default:
            return io_internal::parse_xyz(bytes, source, ctx);
    }
}

}  // namespace

std::optional<PointFormat> point_format_of_name(const std::filesystem::path& path) {
    const std::string extension = to_lower(path.extension().string());
    if (extension == ".ply") return PointFormat::ply;
    for (const std::string_view text : {".xyz", ".txt", ".csv", ".asc"}) {
        if (extension == text) return PointFormat::xyz;
    }
    return {};
}

PaintedPoints read_painted_points(const std::filesystem::path& path, const PointColumns& columns,
                                  const Context& ctx) {
    return parse_painted_points(read_file(path, kLargestFile, ctx), path.string(), columns, ctx);
}

PaintedPoints parse_painted_points(std::string_view bytes, const std::string& source,
                                   const PointColumns& columns, const Context& ctx) {
    if (io_internal::is_las(bytes)) return io_internal::parse_las(bytes, columns, source, ctx);
    return finish_points(find_points(bytes, source, ctx), columns, source);
}

PointSet parse_points(std::string_view bytes, const std::string& source, const Context& ctx) {
    return parse_painted_points(bytes, source, kNoColumns, ctx).points;
}

PointSet read_points(const std::filesystem::path& path, const Context& ctx) {
    return read_painted_points(path, kNoColumns, ctx).points;
}

}  // namespace coppice
