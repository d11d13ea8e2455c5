#include "coppice/io_points/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "coppice/base/ascii.h"
#include "coppice/base/error.h"
#include "coppice/base/local_origin.h"
#include "coppice/base/option_fields.h"
#include "coppice/io/ply_header.h"
#include "coppice/io/text.h"
#include "coppice/io/unread_format.h"
#include "coppice/io_mesh/format.h"
#include "coppice/io_mesh/reader.h"
#include "coppice/io_points/read_internal.h"
#include "coppice/system/file.h"

namespace coppice {
namespace io_internal {

bool fits_points(Vec3d p) {
    constexpr double kLargest = 1e30;
    return std::abs(p.x) <= kLargest && std::abs(p.y) <= kLargest && std::abs(p.z) <= kLargest;
}

std::optional<Rgb> to_color(double red, double green, double blue) {
    Rgb color;
    std::size_t i = 0;
    for (const double c : {red, green, blue}) {
        if (!(c >= 0 && c <= 255)) return {};
        color[i++] = static_cast<std::uint8_t>(std::lround(c));
    }
    return color;
}

std::uint8_t to_byte(double number) {
    return number >= 0 && number <= 255 ? static_cast<std::uint8_t>(number) : std::uint8_t{0};
}

std::uint32_t to_tree_id(double number) {
    constexpr double kMax = 4294967295;
    return number >= 1 && number <= kMax ? static_cast<std::uint32_t>(number) : 0;
}

std::optional<std::size_t> find_tree_ids(std::span<const std::string> names) {
    constexpr std::array<std::string_view, 9> kKnown{"treeid",        "predtreeid",   "predinstance",
                                                     "predinstances", "instancepred", "instanceid",
                                                     "treeinstance",  "instance",     "label"};
    std::vector<std::string> plain;
    for (const std::string& name : names) {
        plain.push_back(plain_name(name));
        constexpr std::string_view kScalar = "scalar";  // prefix of names written by CloudCompare
        if (plain.back().starts_with(kScalar)) plain.back().erase(0, kScalar.size());
    }
    for (const std::string_view known : kKnown) {
        const auto found = std::ranges::find(plain, known);
        if (found != plain.end()) return static_cast<std::size_t>(found - plain.begin());
    }
    return {};
}

PointFile finish_points(FoundPoints found, const PointColumns& wanted, const std::string& source) {
    if (found.places.empty()) throw InvalidInput(fmt::format("{}: it contains no points", source));
    PointFile out{.point_cloud = std::move(found.known),
                  .format = std::move(found.format),
                  .without_return = found.without_return,
                  .system = std::move(found.system)};
    PointCloud& known = out.point_cloud;
    PointSet& set = known.points;
    set.origin = local_origin(found.places);
    set.positions.resize(found.places.size());
    std::ranges::transform(found.places, set.positions.begin(),
                           [&](const Vec3d& p) { return Vec3(p - set.origin); });
    visit_columns(known, [&](auto& column) {
        if (column.size() != set.size()) column = {};
    });
    if (!wanted.distances) known.distances = {};
    if (!wanted.colors) known.colors = {};
    if (!wanted.classes) known.classes = {};
    if (!wanted.intensities) known.intensities = {};
    if (!wanted.returns) known.return_numbers = known.return_counts = {};
    if (!wanted.tree_ids) known.tree_ids = {};
    return out;
}

}  // namespace io_internal

namespace {

using io_internal::finish_points;
using io_internal::FoundPoints;
using io_internal::ScannerText;

FoundPoints find_points(std::string_view bytes, const std::string& source, const Context& ctx) {
    if (is_ply(bytes)) return io_internal::parse_ply_points(bytes, source, ctx);
    if (io_internal::is_e57(bytes)) return io_internal::parse_e57(bytes, source, ctx);
    if (io_internal::is_pcd(bytes))
        return {.places = io_internal::parse_pcd(bytes, source, ctx), .format = "PCD"};
    if (mesh_format_of_content(bytes) == MeshFormat::off)
        return {.places = parse_off_points(bytes, source, ctx), .format = "OFF"};
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
    if (extension == ".las") return PointFormat::las;
    for (const std::string_view text : {".xyz", ".txt", ".csv", ".asc"}) {
        if (extension == text) return PointFormat::xyz;
    }
    return {};
}

PointFile parse_point_file(std::string_view bytes, const std::string& source, const PointColumns& columns,
                           const ReadPointsOptions& options, const Context& ctx) {
    if (io_internal::is_las(bytes)) return io_internal::parse_las(bytes, columns, options, source, ctx);
    return finish_points(find_points(bytes, source, ctx), columns, source);
}

PointFile read_point_file(const std::filesystem::path& path, const PointColumns& columns,
                          const ReadPointsOptions& options, const Context& ctx) {
    return parse_point_file(read_file(path, kLargestFile, ctx), path.string(), columns, options, ctx);
}

PointCloud read_point_cloud(const std::filesystem::path& path, const PointColumns& columns,
                            const Context& ctx) {
    return read_point_file(path, columns, {}, ctx).point_cloud;
}

PointCloud parse_point_cloud(std::string_view bytes, const std::string& source, const PointColumns& columns,
                             const Context& ctx) {
    return parse_point_file(bytes, source, columns, {}, ctx).point_cloud;
}

PointSet parse_points(std::string_view bytes, const std::string& source, const Context& ctx) {
    return parse_point_cloud(bytes, source, kNoColumns, ctx).points;
}

PointSet read_points(const std::filesystem::path& path, const Context& ctx) {
    return read_point_cloud(path, kNoColumns, ctx).points;
}

void list_fields(ReadPointsOptions& options, FieldList& list) {
    list.add(Field{"allow_truncated",
                   "Read the existing points of a LAS or LAZ file that contains fewer points than its header "
                   "specifies."},
             options.allow_truncated);
}

}  // namespace coppice
