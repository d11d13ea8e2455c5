#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#ifdef COPPICE_HAVE_LASZIP
#include <laszip/laszip_api.h>

#include <memory>
#include <sstream>
#endif

#include "coppice/base/error.h"
#include "coppice/io/point_read_internal.h"

namespace coppice::io_internal {
namespace {

// Bytes of a record of each format, at least.
constexpr std::array<std::uint16_t, 11> kRecordBytes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
constexpr std::size_t kOldHeader = 227, kNewHeader = 375;
constexpr std::uint8_t kCompressed = 0xc0;  // LASzip sets bit 7, older ones bit 6

/// Little-endian numbers at fixed places, for whatever machine.
template <class T>
T number_at(std::string_view bytes, std::size_t at) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
        bits |= std::uint64_t{static_cast<std::uint8_t>(bytes[at + i])} << (8 * i);
    }
    if constexpr (sizeof(T) == 8) {
        T value;
        std::memcpy(&value, &bits, sizeof(T));
        return value;
    } else {
        return static_cast<T>(bits);
    }
}

struct LasHeader {
    int major = 1, minor = 0;
    std::uint64_t data = 0;    ///< offset of the first record
    std::uint8_t format = 0;   ///< with the bits of compression
    std::uint16_t record = 0;  ///< [bytes]
    std::uint64_t count = 0;
    Vec3d scale, offset;

    bool compressed() const { return (format & kCompressed) != 0; }
};

[[noreturn]] void fail(const std::string& source, const std::string& what) {
    throw InvalidInput(fmt::format("{}: {}", source, what));
}

LasHeader parse_header(std::string_view bytes, const std::string& source) {
    if (bytes.size() < kOldHeader) fail(source, "the file ends within its LAS header");
    LasHeader h;
    h.major = number_at<std::uint8_t>(bytes, 24);
    h.minor = number_at<std::uint8_t>(bytes, 25);
    if (h.major != 1 || h.minor > 4) {
        throw Unsupported(
            fmt::format("{}: it is LAS {}.{}, but only 1.0 to 1.4 can be read; convert it to LAS 1.4", source,
                        h.major, h.minor));
    }
    h.data = number_at<std::uint32_t>(bytes, 96);
    h.format = number_at<std::uint8_t>(bytes, 104);
    h.record = number_at<std::uint16_t>(bytes, 105);
    h.count = number_at<std::uint32_t>(bytes, 107);
    if (h.minor == 4 && bytes.size() >= kNewHeader) {
        const auto count = number_at<std::uint64_t>(bytes, 247);
        if (count > 0) h.count = count;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t place = std::size_t{8} * static_cast<std::size_t>(axis);
        h.scale[axis] = number_at<double>(bytes, 131 + place);
        h.offset[axis] = number_at<double>(bytes, 155 + place);
    }
    if (!is_finite(h.scale) || !is_finite(h.offset) || h.scale.x == 0 || h.scale.y == 0 || h.scale.z == 0) {
        fail(source, "its LAS header has scales or offsets that are zero or not finite");
    }
    const int format = h.format & ~kCompressed;
    if (format >= static_cast<int>(kRecordBytes.size())) {
        throw Unsupported(
            fmt::format("{}: its point format {} is unknown; 0 to 10 can be read", source, format));
    }
    if (h.record < kRecordBytes[static_cast<std::size_t>(format)]) {
        fail(source, fmt::format("its points have {} bytes, fewer than format {} has", h.record, format));
    }
    return h;
}

/// Marked by whoever made the file as not to be used.
bool withheld(std::string_view record, int format) {
    return format < 6 ? (static_cast<std::uint8_t>(record[15]) & 0x80) != 0
                      : (static_cast<std::uint8_t>(record[15]) & 0x04) != 0;
}

void add_point(std::vector<Vec3d>& points, const LasHeader& h, Vec3d raw, const std::string& source,
               std::uint64_t i) {
    const Vec3d p{raw.x * h.scale.x + h.offset.x, raw.y * h.scale.y + h.offset.y,
                  raw.z * h.scale.z + h.offset.z};
    if (!fits_points(p)) fail(source, fmt::format("point {} is not finite or beyond 1e30", i));
    points.push_back(p);
}

std::vector<Vec3d> read_plain(std::string_view bytes, const LasHeader& h, const std::string& source) {
    if (h.data < kOldHeader || h.data > bytes.size() || h.count > (bytes.size() - h.data) / h.record) {
        const std::uint64_t held =
            h.data < bytes.size() ? (bytes.size() - h.data) / h.record : std::uint64_t{0};
        fail(source,
             fmt::format("the file is cut off or damaged: its header names {} points, but it holds {}",
                         h.count, held));
    }
    std::vector<Vec3d> points;
    points.reserve(h.count);
    for (std::uint64_t i = 0; i < h.count; ++i) {
        const std::string_view record = bytes.substr(h.data + i * h.record, h.record);
        if (withheld(record, h.format)) continue;
        const Vec3d raw(number_at<std::int32_t>(record, 0), number_at<std::int32_t>(record, 4),
                        number_at<std::int32_t>(record, 8));
        add_point(points, h, raw, source, i);
    }
    return points;
}

#ifdef COPPICE_HAVE_LASZIP

class Unzipper {
  public:
    Unzipper(std::istream& stream, const std::string& source) : source_(source) {
        if (laszip_create(&handle_) != 0) throw IoError(fmt::format("{}: LASzip does not start", source));
        laszip_BOOL compressed = 0;
        if (laszip_open_reader_stream(handle_, stream, &compressed) != 0) refuse();
        laszip_get_point_pointer(handle_, &point_);
    }
    ~Unzipper() {
        laszip_close_reader(handle_);
        laszip_destroy(handle_);
    }
    Unzipper(const Unzipper&) = delete;
    Unzipper& operator=(const Unzipper&) = delete;

    const laszip_point_struct& next() {
        if (laszip_read_point(handle_) != 0) refuse();
        return *point_;
    }

  private:
    [[noreturn]] void refuse() {
        laszip_CHAR* text = nullptr;
        laszip_get_error(handle_, &text);
        fail(source_, fmt::format("its compressed points are damaged: {}", text ? text : "unknown reason"));
    }
    const std::string& source_;
    laszip_POINTER handle_ = nullptr;
    laszip_point_struct* point_ = nullptr;
};

std::vector<Vec3d> read_compressed(std::string_view bytes, const LasHeader& h, const std::string& source) {
    // A packed point takes some bits at the least: a file of n bytes cannot hold many more than 64 n.
    if (h.count / 64 > bytes.size()) fail(source, "its header names more points than the file can hold");
    std::istringstream stream{std::string(bytes)};
    Unzipper unzipper(stream, source);
    std::vector<Vec3d> points;
    for (std::uint64_t i = 0; i < h.count; ++i) {
        const laszip_point_struct& p = unzipper.next();
        if (p.withheld_flag != 0) continue;
        add_point(points, h, Vec3d(p.X, p.Y, p.Z), source, i);
    }
    return points;
}

#else

std::vector<Vec3d> read_compressed(std::string_view, const LasHeader&, const std::string& source) {
    throw Unsupported(
        fmt::format("{}: it is compressed (LAZ), which this build cannot read, as no LASzip library was "
                    "found; convert it "
                    "to LAS",
                    source));
}

#endif

}  // namespace

bool is_las(std::string_view bytes) { return bytes.starts_with("LASF"); }

PointSet parse_las(std::string_view bytes, const std::string& source) {
    const LasHeader header = parse_header(bytes, source);
    return to_point_set(
        header.compressed() ? read_compressed(bytes, header, source) : read_plain(bytes, header, source),
        source);
}

}  // namespace coppice::io_internal
