#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "coppice/base/error.h"
#include "coppice/base/local_origin.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/io_points/las_internal.h"
#include "coppice/io_points/read_internal.h"

namespace coppice::io_internal {
namespace {

// Minimum size of a record of each format in bytes.
constexpr std::array<std::uint16_t, 11> kRecordBytes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
constexpr std::uint64_t kPart = 65536;      // records in a parallel task
constexpr std::uint8_t kCompressed = 0xc0;  // LASzip sets bit 7, old versions bit 6

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

LasPoint parse_record(std::string_view record, const LasHeader& h) {
    const bool recent = h.recent();
    const auto returns = number_at<std::uint8_t>(record, 14), flags = number_at<std::uint8_t>(record, 15);
    LasPoint p;
    p.place = {number_at<std::int32_t>(record, 0), number_at<std::int32_t>(record, 4),
               number_at<std::int32_t>(record, 8)};
    p.withheld = (flags & (recent ? 0x04 : 0x80)) != 0;
    p.intensity = number_at<std::uint16_t>(record, 12);
    p.return_number = returns & (recent ? 15 : 7);
    p.return_count = recent ? returns >> 4 : returns >> 3 & 7;
    p.classification = recent ? number_at<std::uint8_t>(record, 16) : flags & 31;
    if (const std::size_t color = h.color()) p.color = color_at(record, color);
    p.extra = record.substr(h.extra());
    return p;
}

/// Returns the number of records: that of the header, unless the file is truncated.
std::uint64_t count_of_records(std::string_view bytes, const LasHeader& h, const LasReading& reading) {
    const bool begins = h.data >= kOldLasHeader && h.data <= bytes.size();
    const std::uint64_t held = begins ? (bytes.size() - h.data) / h.record : 0;
    if (begins && h.count <= held) return h.count;
    if (reading.allow_truncated && held > 0) return held;
    const std::string subject =
        fmt::format("its header specifies {} points, but it contains {}", h.count, held);
    if (held == 0) las_trouble(reading.source, fmt::format("the file is cut off or damaged: {}", subject));
    las_cut_off(reading.source, subject);
}

std::vector<LasRecordRange> read_plain(std::string_view bytes, const LasHeader& h, const LasReading& reading,
                                       LasColumns& columns, const Context& ctx) {
    const std::uint64_t count = count_of_records(bytes, h, reading);
    columns.resize(count, reading.wanted, h);
    std::vector<LasRecordRange> parts((count + kPart - 1) / kPart);
    parallel_with_progress(ctx, count, kPart, [&](IndexRange range) {
        LasRecordRange part(columns, range.begin, range.end);
        for (std::uint64_t i = range.begin; i < range.end; ++i)
            part.put(parse_record(bytes.substr(h.data + i * h.record, h.record), h));
        parts[range.begin / kPart] = std::move(part);
    });
    return parts;
}

using Place = std::array<std::int32_t, 3>;

Vec3d world(const Place& p, const LasHeader& h) {
    return {p[0] * h.scale.x + h.offset.x, p[1] * h.scale.y + h.offset.y, p[2] * h.scale.z + h.offset.z};
}

/// Two opposite corners of the bounding box of the points, in the frame of the file.
std::array<Vec3d, 2> corners(const LasColumns& columns, const std::vector<LasRecordRange>& parts,
                             const LasHeader& h, const Context& ctx) {
    struct Range {
        Place low, high;
        void extend(const Place& a, const Place& b) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], a[axis]);
                high[axis] = std::max(high[axis], b[axis]);
            }
        }
    };
    constexpr std::int32_t kMin = std::numeric_limits<std::int32_t>::min();
    constexpr std::int32_t kMax = std::numeric_limits<std::int32_t>::max();
    const Range nothing{{kMax, kMax, kMax}, {kMin, kMin, kMin}};
    const Range range = parallel_reduce(
        ctx, parts.size(), 1, nothing,
        [&](IndexRange r) {
            Range of_part = nothing;
            const LasRecordRange& part = parts[r.begin];
            for (std::uint64_t i = part.first; i < part.first + part.kept; ++i)
                of_part.extend(columns.places[i], columns.places[i]);
            return of_part;
        },
        [](Range a, const Range& b) {
            a.extend(b.low, b.high);
            return a;
        });
    return {world(range.low, h), world(range.high, h)};
}

/// Concatenates the kept values of the parts in their order.
class Gathering {
  public:
    Gathering(const std::vector<LasRecordRange>& parts, const Context& ctx) : parts_(parts), ctx_(ctx) {
        begin_.reserve(parts.size());
        for (const LasRecordRange& part : parts) begin_.push_back(part.kept);
        count_ = exclusive_scan(std::span(begin_));
    }
    std::uint64_t count() const { return count_; }

    /// Stores convert(value) of every kept value.
    template <class From, class To, class Convert>
    void gather(const From& from, To& to, const Convert& convert) const {
        to.resize(count_);
        parallel_for(ctx_, parts_.size(), 1, [&](std::size_t k) {
            const LasRecordRange& part = parts_[k];
            for (std::uint64_t i = 0; i < part.kept; ++i) to[begin_[k] + i] = convert(from[part.first + i]);
        });
    }
    /// Stores the kept values; nothing if the column is empty or zero throughout, which writers use for
    /// unknown values.
    template <class From, class To>
    void gather_known(const From& from, std::vector<To>& to) const {
        if (from.empty()) return;
        gather(from, to, [](auto value) { return static_cast<To>(value); });
        if (std::ranges::all_of(to, [](To value) { return value == 0; })) to = {};
    }
    /// Converts colours to 8 bits; some writers store 8 bits in the 16 bits of LAS.
    void gather_colors(const Buffer<Rgb16>& from, std::vector<Rgb>& to) const {
        if (from.empty()) return;
        std::uint16_t most = 0;
        for (const LasRecordRange& part : parts_) {
            for (std::uint64_t i = part.first; i < part.first + part.kept; ++i)
                most = std::max(most, *std::ranges::max_element(from[i]));
        }
        if (most == 0) return;
        const int shift = most > 255 ? 8 : 0;
        gather(from, to, [&](const Rgb16& c) {
            const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(c[i] >> shift); };
            return Rgb{byte(0), byte(1), byte(2)};
        });
    }

  private:
    const std::vector<LasRecordRange>& parts_;
    const Context& ctx_;
    std::vector<std::uint64_t> begin_;
    std::uint64_t count_ = 0;
};

PointCloud make_points(const LasColumns& columns, const std::vector<LasRecordRange>& parts,
                       const LasHeader& h, const std::string& source, const Context& ctx) {
    const Gathering kept(parts, ctx);
    if (kept.count() == 0) throw InvalidInput(fmt::format("{}: it contains no points", source));
    const auto [a, b] = corners(columns, parts, h, ctx);
    if (!fits_points(a) || !fits_points(b))
        las_trouble(source, "the coordinates of its points are not finite or beyond 1e30");
    PointCloud out;
    PointSet& set = out.points;
    set.origin = local_origin(a, b);
    kept.gather(columns.places, set.positions,
                [&](const Place& p) { return Vec3(world(p, h) - set.origin); });
    kept.gather_known(columns.classes, out.classes);
    kept.gather_known(columns.intensities, out.intensities);
    kept.gather_known(columns.return_numbers, out.return_numbers);
    kept.gather_known(columns.return_counts, out.return_counts);
    kept.gather_colors(columns.colors, out.colors);
    kept.gather_known(columns.tree_ids, out.tree_ids);
    return out;
}

std::vector<PointDimension> list_dimensions(const LasColumns& columns,
                                            const std::vector<LasRecordRange>& parts) {
    std::vector<PointDimension> out;
    for (std::size_t d = 0; d < columns.ranged.size(); ++d) {
        LasRange range;
        for (const LasRecordRange& part : parts) range.extend(part.ranges[d]);
        out.push_back({columns.ranged[d].name, range.low, range.high});
    }
    return out;
}

std::string describe_format(const LasHeader& h) {
    return fmt::format("{} {}.{}, point format {}", h.compressed ? "LAZ" : "LAS", h.major, h.minor, h.format);
}

}  // namespace

bool is_las(std::string_view bytes) { return bytes.starts_with("LASF"); }

void las_trouble(const std::string& source, const std::string& subject) {
    throw InvalidInput(fmt::format("{}: {}", source, subject));
}

void las_cut_off(const std::string& source, const std::string& subject) {
    throw TruncatedFile(fmt::format("{}: the file is cut off or damaged: {}", source, subject));
}

std::size_t LasHeader::color() const {
    constexpr std::array<std::size_t, 11> kPlace{0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30};
    return kPlace[format];
}

std::size_t LasHeader::extra() const { return kRecordBytes[format]; }

PointFile parse_las(std::string_view bytes, const PointColumns& wanted, const ReadPointsOptions& options,
                    const std::string& source, const Context& ctx) {
    LasHeader header = parse_header(bytes, source);
    const std::vector<LasRecord> records = las_records(bytes, header);
    header.dimensions = las_dimensions(records, header);
    const LasReading reading{wanted, options.allow_truncated, source};
    LasColumns columns;
    const std::vector<LasRecordRange> parts = header.compressed
                                                  ? read_laz(bytes, header, reading, columns, ctx)
                                                  : read_plain(bytes, header, reading, columns, ctx);
    std::uint64_t held = 0;
    for (const LasRecordRange& part : parts) held += part.count;
    return {.point_cloud = make_points(columns, parts, header, source, ctx),
            .format = describe_format(header),
            .missing = header.count - held,
            .dimensions = list_dimensions(columns, parts),
            .system = coordinate_system(records)};
}

}  // namespace coppice::io_internal
