#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "coppice/base/error.h"
#include "coppice/io/file_progress.h"
#include "coppice/io/points/las_header_internal.h"
#include "coppice/io/points/read_internal.h"

namespace coppice::io_internal {
namespace {

// Bytes of a record of each format, at least.
constexpr std::array<std::uint16_t, 11> kRecordBytes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
constexpr std::uint8_t kCompressed = 0xc0;  // LASzip sets bit 7, older ones bit 6

LasHeader parse_header(std::string_view bytes, const std::string& source) {
    if (bytes.size() < kOldLasHeader) las_trouble(source, "the file ends within its LAS header");
    LasHeader h;
    h.major = number_at<std::uint8_t>(bytes, 24);
    h.minor = number_at<std::uint8_t>(bytes, 25);
    if (h.major != 1 || h.minor > 4) {
        throw Unsupported(
            fmt::format("{}: it is LAS {}.{}, but only 1.0 to 1.4 can be read; convert it to LAS 1.4", source,
                        h.major, h.minor));
    }
    h.data = number_at<std::uint32_t>(bytes, 96);
    const auto format = number_at<std::uint8_t>(bytes, 104);
    h.compressed = (format & kCompressed) != 0;
    h.format = format & static_cast<std::uint8_t>(~kCompressed);
    h.record = number_at<std::uint16_t>(bytes, 105);
    h.count = number_at<std::uint32_t>(bytes, 107);
    if (h.minor == 4 && bytes.size() >= kNewLasHeader) {
        const auto count = number_at<std::uint64_t>(bytes, 247);
        if (count > 0) h.count = count;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t place = std::size_t{8} * static_cast<std::size_t>(axis);
        h.scale[axis] = number_at<double>(bytes, 131 + place);
        h.offset[axis] = number_at<double>(bytes, 155 + place);
    }
    if (!is_finite(h.scale) || !is_finite(h.offset) || h.scale.x == 0 || h.scale.y == 0 || h.scale.z == 0) {
        las_trouble(source, "its LAS header has scales or offsets that are zero or not finite");
    }
    if (h.format >= kRecordBytes.size()) {
        throw Unsupported(
            fmt::format("{}: its point format {} is unknown; 0 to 10 can be read", source, h.format));
    }
    if (h.record < kRecordBytes[h.format]) {
        las_trouble(source,
                    fmt::format("its points have {} bytes, fewer than format {} has", h.record, h.format));
    }
    return h;
}

/// Marked by whoever made the file as not to be used.
bool withheld(std::string_view record, bool recent) {
    return (static_cast<std::uint8_t>(record[15]) & (recent ? 0x04 : 0x80)) != 0;
}

std::vector<Vec3d> read_plain(std::string_view bytes, const LasHeader& h, const std::string& source,
                              const Context& ctx) {
    if (h.data < kOldLasHeader || h.data > bytes.size() || h.count > (bytes.size() - h.data) / h.record) {
        const std::uint64_t held =
            h.data < bytes.size() ? (bytes.size() - h.data) / h.record : std::uint64_t{0};
        las_trouble(source,
                    fmt::format("the file is cut off or damaged: its header names {} points, but it holds {}",
                                h.count, held));
    }
    std::vector<Vec3d> points;
    points.reserve(h.count);
    FileProgress progress(ctx, h.count);
    for (std::uint64_t i = 0; i < h.count; ++i) {
        progress.at(i);
        const std::string_view record = bytes.substr(h.data + i * h.record, h.record);
        if (withheld(record, h.recent())) continue;
        const Vec3d raw(number_at<std::int32_t>(record, 0), number_at<std::int32_t>(record, 4),
                        number_at<std::int32_t>(record, 8));
        add_las_point(points, h, raw, source, i);
    }
    return points;
}

}  // namespace

bool is_las(std::string_view bytes) { return bytes.starts_with("LASF"); }

void las_trouble(const std::string& source, const std::string& what) {
    throw InvalidInput(fmt::format("{}: {}", source, what));
}

void add_las_point(std::vector<Vec3d>& points, const LasHeader& h, Vec3d raw, const std::string& source,
                   std::uint64_t i) {
    const Vec3d p{raw.x * h.scale.x + h.offset.x, raw.y * h.scale.y + h.offset.y,
                  raw.z * h.scale.z + h.offset.z};
    if (!fits_points(p)) las_trouble(source, fmt::format("point {} is not finite or beyond 1e30", i));
    points.push_back(p);
}

PointSet parse_las(std::string_view bytes, const std::string& source, const Context& ctx) {
    const LasHeader header = parse_header(bytes, source);
    return to_point_set(
        header.compressed ? read_laz(bytes, header, source, ctx) : read_plain(bytes, header, source, ctx),
        source);
}

}  // namespace coppice::io_internal
