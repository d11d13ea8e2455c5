#include "coppice/io/points/writer.h"

#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/io/mesh/write_internal.h"
#include "coppice/io/points/reader.h"

namespace coppice {
namespace {

using io_internal::Chunk;

template <class T>
void put_line(Chunk& chunk, BasicVec3<T> p, char separator) {
    chunk.reserve(3 * (1 + Chunk::kNumber));
    chunk.put_number(p.x);
    chunk.put(separator);
    chunk.put_number(p.y);
    chunk.put(separator);
    chunk.put_number(p.z);
    chunk.put('\n');
}

/// As floats, or as doubles where there is an origin to add.
void write_xyz(AtomicFile& file, const PointSet& points, char separator, const Context& ctx) {
    const bool far = points.origin != Vec3d{};
    io_internal::write_items(file, points.size(), {}, ctx, [&](std::size_t i, Chunk& chunk) {
        far ? put_line(chunk, points.world(i), separator) : put_line(chunk, points.positions[i], separator);
    });
}

void write_ply(AtomicFile& file, const PointSet& points, std::span<const float> distances,
               std::span<const Rgb> colors, std::string_view note, const Context& ctx) {
    const bool far = points.origin != Vec3d{};
    file.write(fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment Coppice, metres, Z up\n{2}"
        "element vertex {0}\nproperty {1} x\nproperty {1} y\nproperty {1} z\n{3}{4}end_header\n",
        points.size(), far ? "double" : "float", note.empty() ? "" : fmt::format("comment {}\n", note),
        !distances.empty() ? "property float distance\n" : "",
        !colors.empty() ? "property uchar red\nproperty uchar green\nproperty uchar blue\n" : ""));
    io_internal::write_items(file, points.size(), {}, ctx, [&](std::size_t i, Chunk& chunk) {
        chunk.reserve(sizeof(Vec3d) + sizeof(float) + sizeof(Rgb));
        far ? chunk.put_raw(points.world(i)) : chunk.put_raw(points.positions[i]);
        if (!distances.empty()) chunk.put_raw(distances[i]);
        if (!colors.empty()) chunk.put_raw(colors[i]);
    });
}

void check_positions(const std::filesystem::path& path, const PointSet& points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (is_finite(points.world(i))) continue;
        throw InvalidInput(fmt::format("cannot write {}: point {} is not finite", path.string(), i));
    }
}

}  // namespace

void write_points(const std::filesystem::path& path, const PointSet& points, const Context& ctx) {
    const auto format = point_format_of_name(path);
    if (!format) {
        throw Unsupported(fmt::format(
            "cannot write {}: a file of points ends in .xyz, .txt, .csv, .asc or .ply", path.string()));
    }
    check_positions(path, points);
    AtomicFile file(path);
    if (*format == PointFormat::ply) {
        write_ply(file, points, {}, {}, {}, ctx);
    } else {
        const std::string extension = path.extension().string();
        write_xyz(file, points, extension == ".csv" || extension == ".CSV" ? ',' : ' ', ctx);
    }
    file.commit();
    ctx.report(1);
}

void write_painted_points(const std::filesystem::path& path, const PaintedPoints& painted,
                          std::string_view note, const Context& ctx) {
    COPPICE_ASSERT(painted.distances.empty() || painted.distances.size() == painted.points.size());
    COPPICE_ASSERT(painted.colors.empty() || painted.colors.size() == painted.points.size());
    if (point_format_of_name(path) != PointFormat::ply) {
        throw Unsupported(
            fmt::format("cannot write {}: a file of points with colours ends in .ply", path.string()));
    }
    check_positions(path, painted.points);
    AtomicFile file(path);
    write_ply(file, painted.points, painted.distances, painted.colors, note, ctx);
    file.commit();
    ctx.report(1);
}

}  // namespace coppice
