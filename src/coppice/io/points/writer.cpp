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

/// fill(chunk, position) for each point: as floats, or as doubles where there is an origin to add.
template <class Fill>
void write_each(AtomicFile& file, const PointSet& points, const Context& ctx, const Fill& fill) {
    const bool shifted = points.origin != Vec3d{};
    io_internal::write_items(file, points.size(), {}, ctx, [&](std::size_t i, Chunk& chunk) {
        shifted ? fill(chunk, points.world(i)) : fill(chunk, points.positions[i]);
    });
}

void write_xyz(AtomicFile& file, const PointSet& points, char separator, const Context& ctx) {
    write_each(file, points, ctx, [separator](Chunk& chunk, auto p) { put_line(chunk, p, separator); });
}

void write_ply(AtomicFile& file, const PointSet& points, const Context& ctx) {
    file.write(fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment Coppice, metres, Z up\nelement vertex {0}\n"
        "property {1} x\nproperty {1} y\nproperty {1} z\nend_header\n",
        points.size(), points.origin != Vec3d{} ? "double" : "float"));
    write_each(file, points, ctx, [](Chunk& chunk, auto p) {
        chunk.reserve(sizeof p);
        chunk.put_raw(p);
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
        write_ply(file, points, ctx);
    } else {
        const std::string extension = path.extension().string();
        write_xyz(file, points, extension == ".csv" || extension == ".CSV" ? ',' : ' ', ctx);
    }
    file.commit();
    ctx.report(1);
}

}  // namespace coppice
