#include "coppice/io_points/writer.h"

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "coppice/base/ascii.h"
#include "coppice/base/error.h"
#include "coppice/io/item_writer.h"
#include "coppice/io_points/reader.h"
#include "coppice/io_points/write_internal.h"

namespace coppice {
namespace {

using io_internal::Chunk;

/// Calls visit(names, PLY type, values) for every column that is not empty; its values are numbers, or arrays
/// with one item for each name.
template <class Visitor>
void visit_named_columns(const PointCloud& known, const Visitor& visit) {
    const auto column = [&](std::initializer_list<std::string_view> names, std::string_view type,
                            const auto& values) {
        if (!values.empty()) visit(names, type, values);
    };
    column({"distance"}, "float", known.distances);
    column({"red", "green", "blue"}, "uchar", known.colors);
    column({"intensity"}, "float", known.intensities);
    column({"classification"}, "uchar", known.classes);
    column({"return_number"}, "uchar", known.return_numbers);
    column({"number_of_returns"}, "uchar", known.return_counts);
    column({"tree_id"}, "uint", known.tree_ids);
    column({"wood"}, "uchar", known.wood);
    column({"branch_order"}, "uchar", known.branch_orders);
    column({"evidence"}, "float", known.evidence);
}

/// Returns the maximum number of bytes of a row without the position.
constexpr std::size_t kColumns = 12;

template <class T>
void put_place(Chunk& chunk, BasicVec3<T> p, char separator) {
    chunk.put_number(p.x);
    chunk.put(separator);
    chunk.put_number(p.y);
    chunk.put(separator);
    chunk.put_number(p.z);
}

void put_value(Chunk& chunk, const Rgb& color, char separator) {
    for (const std::uint8_t c : color) {
        chunk.put(separator);
        chunk.put_number(unsigned{c});
    }
}

template <class Number>
void put_value(Chunk& chunk, Number value, char separator) {
    chunk.put(separator);
    chunk.put_number(value);
}

/// Writes the positions as floats, or as doubles if there is an origin to add.
void write_text(AtomicFile& file, const PointSet& points, const PointCloud& known, char separator,
                const Context& ctx) {
    const bool far = points.origin != Vec3d{};
    std::string names;
    visit_named_columns(known, [&](auto of_column, std::string_view, const auto&) {
        for (const std::string_view name : of_column) names.append(1, separator).append(name);
    });
    if (!names.empty()) file.write(fmt::format("x{0}y{0}z{1}\n", separator, names));
    io_internal::write_items(file, points.size(), {}, ctx, [&](std::size_t i, Chunk& chunk) {
        chunk.reserve((3 + kColumns) * (1 + Chunk::kNumber));
        far ? put_place(chunk, points.world(i), separator) : put_place(chunk, points.positions[i], separator);
        visit_named_columns(known, [&](auto, std::string_view, const auto& values) {
            put_value(chunk, values[i], separator);
        });
        chunk.put('\n');
    });
}

void write_ply(AtomicFile& file, const PointSet& points, const PointCloud& known, std::string_view note,
               const Context& ctx) {
    const bool far = points.origin != Vec3d{};
    std::string properties;
    visit_named_columns(known, [&](auto names, std::string_view type, const auto&) {
        for (const std::string_view name : names) properties += fmt::format("property {} {}\n", type, name);
    });
    file.write(
        fmt::format("ply\nformat binary_little_endian 1.0\ncomment Coppice, metres, Z up\n{2}"
                    "element vertex {0}\nproperty {1} x\nproperty {1} y\nproperty {1} z\n{3}end_header\n",
                    points.size(), far ? "double" : "float",
                    note.empty() ? "" : fmt::format("comment {}\n", note), properties));
    io_internal::write_items(file, points.size(), {}, ctx, [&](std::size_t i, Chunk& chunk) {
        chunk.reserve(sizeof(Vec3d) + kColumns * sizeof(float));
        far ? chunk.put_raw(points.world(i)) : chunk.put_raw(points.positions[i]);
        visit_named_columns(known,
                            [&](auto, std::string_view, const auto& values) { chunk.put_raw(values[i]); });
    });
}

void check_points(const std::filesystem::path& path, const PointSet& points, const PointCloud& known) {
    visit_columns(
        known, [&](const auto& column) { COPPICE_ASSERT(column.empty() || column.size() == points.size()); });
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (is_finite(points.world(i))) continue;
        throw InvalidInput(fmt::format("cannot write {}: point {} is not finite", path.string(), i));
    }
}

/// Writes `points` with the columns of `known`; the points of `known` are ignored.
void write(const std::filesystem::path& path, const PointSet& points, const PointCloud& known,
           const WritePointsOptions& options, const Context& ctx) {
    const auto format = point_format_of_name(path);
    if (!format)
        throw Unsupported(fmt::format("cannot write {}: its extension is not that of a point format; {}",
                                      path.string(), remedy_for_points_name(path)));
    check_points(path, points, known);
    AtomicFile file(path);
    const std::string extension = to_lower(path.extension().string());
    if (*format == PointFormat::las) {
        io_internal::write_las(file, points, known, options.system, ctx);
    } else if (*format == PointFormat::ply) {
        write_ply(file, points, known, options.note, ctx);
    } else {
        write_text(file, points, keeps_columns(path) ? known : PointCloud{}, extension == ".csv" ? ',' : ' ',
                   ctx);
    }
    file.commit();
    ctx.report(1);
}

}  // namespace

std::string_view remedy_for_points_name(const std::filesystem::path& path) {
    if (to_lower(path.extension().string()) == ".laz")
        return "LAZ is read only; use .las, and pack that file with laszip";
    return "use .las, .ply, .xyz, .txt, .csv or .asc";
}

bool keeps_columns(const std::filesystem::path& path) {
    return to_lower(path.extension().string()) != ".xyz";
}

void write_points(const std::filesystem::path& path, const PointSet& points, const Context& ctx) {
    write(path, points, {}, {}, ctx);
}

void write_point_cloud(const std::filesystem::path& path, const PointCloud& point_cloud,
                       const WritePointsOptions& options, const Context& ctx) {
    write(path, point_cloud.points, point_cloud, options, ctx);
}

}  // namespace coppice
