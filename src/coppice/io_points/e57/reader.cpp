// E57: scans as packets of bits in pages with checksums, described by XML at the end of the file.

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "coppice/base/error.h"
#include "coppice/io_points/e57/document_internal.h"
#include "coppice/io_points/e57/pages_internal.h"
#include "coppice/io_points/las_internal.h"
#include "coppice/io_points/read_internal.h"
#include "coppice/system/file_progress.h"

namespace coppice::e57 {
namespace {

using io_internal::FoundPoints;
using io_internal::number_at;

constexpr std::string_view kSignature = "ASTM-E57";
constexpr std::uint64_t kHeader = 48, kSection = 32, kPacketHead = 4, kDataHead = 6;  // [bytes]

/// A queue of the values of a field from packets; a value may begin within a byte and end in the next packet.
class BitQueue {
  public:
    explicit BitQueue(const Field& field) : field_(field) {}

    void append(std::string_view bytes) {
        bytes_.erase(0, at_ / 8);
        at_ %= 8;
        bytes_ += bytes;
    }
    /// Returns the number of complete values.
    std::uint64_t size() const {
        if (field_.bits == 0) return std::numeric_limits<std::uint64_t>::max();
        return (8 * bytes_.size() - at_) / field_.bits;
    }
    double take() {
        const std::uint64_t bits = take_bits();
        if (field_.type == Field::Type::float64) return std::bit_cast<double>(bits);
        if (field_.type == Field::Type::float32)
            return double{std::bit_cast<float>(static_cast<std::uint32_t>(bits))};
        return static_cast<double>(static_cast<std::int64_t>(field_.minimum + bits)) * field_.scale +
               field_.offset;
    }

  private:
    std::uint64_t take_bits() {
        if (field_.bits == 0) return 0;
        const std::size_t byte = at_ / 8, shift = at_ % 8, left = bytes_.size() - byte;
        std::uint64_t value = 0;
        std::memcpy(&value, bytes_.data() + byte, std::min<std::size_t>(left, sizeof value));
        value >>= shift;
        if (shift + field_.bits > 64)
            value |= std::uint64_t{static_cast<std::uint8_t>(bytes_[byte + 8])} << (64 - shift);
        at_ += field_.bits;
        return field_.bits == 64 ? value : value & ((std::uint64_t{1} << field_.bits) - 1);
    }

    const Field& field_;
    std::string bytes_;
    std::size_t at_ = 0;  ///< [bits] offset of the next value
};

/// The fields of a scan that are used.
struct Columns {
    std::array<std::size_t, 3> place{}, color{};
    bool spherical = false, colored = false;
    std::optional<std::size_t> invalid, intensity, return_index, return_count;

    Columns(const Scan& scan, const std::string& source) {
        const auto find = [&](std::string_view name) -> std::optional<std::size_t> {
            const auto found = std::ranges::find(scan.fields, name, &Field::name);
            if (found == scan.fields.end()) return {};
            return static_cast<std::size_t>(found - scan.fields.begin());
        };
        const auto find_three = [&](const std::array<std::string_view, 3>& names, auto& to) {
            for (std::size_t i = 0; i < 3; ++i) {
                const auto found = find(names[i]);
                if (!found) return false;
                to[i] = *found;
            }
            return true;
        };
        if (!find_three({"cartesianX", "cartesianY", "cartesianZ"}, place)) {
            spherical = find_three({"sphericalRange", "sphericalAzimuth", "sphericalElevation"}, place);
            if (!spherical)
                throw InvalidInput(fmt::format("{}: the points of a scan have no coordinates", source));
        }
        invalid = find(spherical ? "sphericalInvalidState" : "cartesianInvalidState");
        colored = find_three({"colorRed", "colorGreen", "colorBlue"}, color);
        intensity = find("intensity");
        return_index = find("returnIndex");
        return_count = find("returnCount");
    }
};

/// Transforms from the frame of the scanner to that of the file.
class Pose {
  public:
    Pose(const Scan& scan, const std::string& source) : translation_(scan.translation) {
        const auto [w, x, y, z] = scan.rotation;
        const double norm = w * w + x * x + y * y + z * z;
        if (!(norm > 0) || !std::isfinite(norm))
            throw InvalidInput(fmt::format("{}: the rotation of a scan is not a rotation", source));
        const double s = 2 / norm;
        rows_ = {Vec3d{1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
                 Vec3d{s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)},
                 Vec3d{s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)}};
    }
    Vec3d world(Vec3d p) const {
        return Vec3d{dot(rows_[0], p), dot(rows_[1], p), dot(rows_[2], p)} + translation_;
    }

  private:
    std::array<Vec3d, 3> rows_;
    Vec3d translation_;
};

Vec3d from_spherical(Vec3d s) {
    const double level = s.x * std::cos(s.z);
    return {level * std::cos(s.y), level * std::sin(s.y), s.x * std::sin(s.z)};
}

/// Converts the records of a scan to points.
class PointTaker {
  public:
    PointTaker(const Scan& scan, FoundPoints& found, const std::string& source)
        : columns_(scan, source), pose_(scan, source), found_(found), source_(source) {
        for (std::size_t i = 0; i < 3 && columns_.colored; ++i) {
            const Field& field = scan.fields[columns_.color[i]];
            double most = scan.max_color[i];
            if (most == 0 && field.type == Field::Type::integer && field.bits > 8 && field.bits <= 16)
                most = (1u << field.bits) - 1;
            if (most > 255 || (most > 0 && most <= 1)) to_byte_[i] = 255 / most;
        }
    }

    void take(const std::vector<double>& record) {
        if (columns_.invalid && record[*columns_.invalid] != 0) return pass_over();
        const auto [x, y, z] = columns_.place;
        const Vec3d raw{record[x], record[y], record[z]};
        const Vec3d p = pose_.world(columns_.spherical ? from_spherical(raw) : raw);
        if (std::isnan(p.x) || std::isnan(p.y) || std::isnan(p.z)) return pass_over();
        if (!io_internal::fits_points(p))
            throw InvalidInput(fmt::format("{}: point {} is not finite or beyond 1e30", source_,
                                           found_.places.size() + found_.without_return));
        found_.places.push_back(p);
        PointCloud& known = found_.known;
        if (columns_.intensity)
            found_.note(known.intensities, static_cast<float>(record[*columns_.intensity]));
        // Returns are numbered from 0.
        if (columns_.return_index)
            found_.note(known.return_numbers, io_internal::to_byte(record[*columns_.return_index] + 1));
        if (columns_.return_count)
            found_.note(known.return_counts, io_internal::to_byte(record[*columns_.return_count]));
        if (!columns_.colored) return;
        const auto [r, g, b] = columns_.color;
        const auto color =
            io_internal::to_color(record[r] * to_byte_[0], record[g] * to_byte_[1], record[b] * to_byte_[2]);
        if (color) found_.note(known.colors, *color);
    }

  private:
    void pass_over() { ++found_.without_return; }

    Columns columns_;
    Pose pose_;
    FoundPoints& found_;
    const std::string& source_;
    std::array<double, 3> to_byte_{1, 1, 1};
};

/// Remaining amounts that scans may use, so that time and memory are bounded by the size of the file.
struct Budget {
    std::uint64_t bits;     ///< number of records; each needs at least one bit
    std::uint64_t packets;  ///< [bytes] size of the packets; scans may not share them
};

/// Reads the packets of a scan.
class ScanReader {
  public:
    ScanReader(Pages& pages, const Scan& scan, Budget& budget, const std::string& source)
        : pages_(pages),
          scan_(scan),
          budget_(budget),
          source_(source),
          queues_(scan.fields.begin(), scan.fields.end()) {}

    void read(FoundPoints& found, FileProgress& progress) {
        spend_records();
        PointTaker points(scan_, found, source_);
        std::vector<double> record(scan_.fields.size());
        std::uint64_t at = begin();
        for (std::uint64_t left = scan_.count; left > 0;) {
            progress.at(at);
            at = take_packet(at);
            std::uint64_t whole = left;
            for (const BitQueue& queue : queues_) whole = std::min(whole, queue.size());
            left -= whole;
            for (; whole > 0; --whole) {
                for (std::size_t f = 0; f < queues_.size(); ++f) record[f] = queues_[f].take();
                points.take(record);
            }
        }
    }

  private:
    void spend_records() {
        std::uint64_t bits = 0;
        for (const Field& field : scan_.fields) bits += field.bits;
        bits = std::max<std::uint64_t>(bits, 1);
        if (scan_.count > budget_.bits / bits) damaged("its XML specifies more points than it can contain");
        budget_.bits -= scan_.count * bits;
    }

    /// Returns the offset of the first packet.
    std::uint64_t begin() {
        const std::string section = pages_.read(pages_.logical(scan_.offset), kSection);
        if (section[0] != 1)
            damaged("the points of a scan do not begin at the offset that its XML specifies");
        return pages_.logical(number_at<std::uint64_t>(section, 16));
    }

    /// Queues the values of a packet; returns the offset of the next packet.
    std::uint64_t take_packet(std::uint64_t at) {
        enum Kind : std::uint8_t { kIndex = 0, kData = 1, kEmpty = 2 };
        const std::string head = pages_.read(at, kPacketHead);
        const auto kind = number_at<std::uint8_t>(head, 0);
        const std::uint64_t size = number_at<std::uint16_t>(head, 2) + std::uint64_t{1};
        if (size < kPacketHead || kind > kEmpty) damaged("a packet of points has an unknown type or size");
        if (size > budget_.packets) damaged("scans share packets of points");
        budget_.packets -= size;
        if (kind == kData) take_streams(pages_.read(at, size));
        return at + size;
    }

    void take_streams(std::string_view packet) {
        const std::size_t table = 2 * queues_.size();
        if (packet.size() < kDataHead + table || number_at<std::uint16_t>(packet, 4) != queues_.size())
            damaged("the fields of a packet of points differ from those that its XML specifies");
        std::string_view rest = packet.substr(kDataHead + table);
        for (std::size_t f = 0; f < queues_.size(); ++f) {
            const std::size_t size = number_at<std::uint16_t>(packet, kDataHead + 2 * f);
            if (size > rest.size()) damaged("a packet of points ends too early");
            queues_[f].append(rest.substr(0, size));
            rest.remove_prefix(size);
        }
    }

    [[noreturn]] void damaged(std::string_view subject) const {
        throw InvalidInput(fmt::format("{}: the E57 file is damaged: {}", source_, subject));
    }

    Pages& pages_;
    const Scan& scan_;
    Budget& budget_;
    const std::string& source_;
    std::vector<BitQueue> queues_;
};

/// Returns the XML, which the header locates.
std::string read_document(Pages& pages, std::string_view bytes, const std::string& source) {
    if (bytes.size() < kHeader)
        throw InvalidInput(fmt::format("{}: the file ends within its E57 header", source));
    const auto major = number_at<std::uint32_t>(bytes, 8), minor = number_at<std::uint32_t>(bytes, 12);
    const auto length = number_at<std::uint64_t>(bytes, 16), page = number_at<std::uint64_t>(bytes, 40);
    if (major != 1 || page != 1024) {
        throw Unsupported(
            fmt::format("{}: it is E57 {}.{} with pages of {} bytes, but only 1.0 with 1024 can "
                        "be read; save it as LAZ, LAS or PLY",
                        source, major, minor, page));
    }
    if (length > bytes.size()) {
        throw InvalidInput(fmt::format(
            "{}: the file is cut off: it has {} of {} bytes, and the description of its points is at its end",
            source, bytes.size(), length));
    }
    return pages.read(pages.logical(number_at<std::uint64_t>(bytes, 24)),
                      number_at<std::uint64_t>(bytes, 32));
}

}  // namespace
}  // namespace coppice::e57

namespace coppice::io_internal {

bool is_e57(std::string_view bytes) { return bytes.starts_with(e57::kSignature); }

FoundPoints parse_e57(std::string_view bytes, const std::string& source, const Context& ctx) {
    e57::Pages pages(bytes, source);
    const e57::Document document = e57::parse_document(e57::read_document(pages, bytes, source), source);
    FoundPoints found{.format = "E57"};
    if (document.system.find('[') != std::string::npos)
        found.system.records.push_back({kWkt, document.system});
    FileProgress progress(ctx, pages.size());
    e57::Budget budget{8 * pages.size(), pages.size()};
    for (const e57::Scan& scan : document.scans)
        if (scan.has_points && scan.count > 0)
            e57::ScanReader(pages, scan, budget, source).read(found, progress);
    return found;
}

}  // namespace coppice::io_internal
