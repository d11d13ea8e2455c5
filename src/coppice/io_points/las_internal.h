#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/io_points/read_internal.h"
#include "coppice/io_points/reader.h"
#include "coppice/points/point_cloud.h"

namespace coppice::io_internal {

/// Returns the little-endian number at an offset, independent of the byte order of the machine.
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

inline constexpr std::size_t kOldLasHeader = 227;
inline constexpr std::size_t kNewLasHeader = 375;  // [bytes] header size up to LAS 1.2 and of LAS 1.4

/// An extra dimension: a number of the records in addition to those of their format.
struct LasDimension {
    std::string name;
    std::size_t at = 0;     ///< [bytes] offset from the end of the fields of the format
    std::uint8_t type = 0;  ///< type code of LAS, 1 to 10
    double scale = 1, offset = 0;
    std::optional<double> no_data;  ///< denotes an unknown value, before scale and offset

    /// Returns the value of a record, given its extra bytes; nullopt if it is unknown.
    std::optional<double> value(std::string_view extra) const;
};

/// Required values of the header of LAS and LAZ files; checked by `parse_las`.
struct LasHeader {
    int major = 1, minor = 0;
    std::uint64_t data = 0;    ///< offset of the first record
    std::uint8_t format = 0;   ///< 0 to 10
    std::uint16_t record = 0;  ///< [bytes] size of a record, at least that of the format
    std::uint64_t count = 0;
    bool compressed = false;
    Vec3d scale, offset;
    std::vector<LasDimension> dimensions = {};

    const LasDimension* tree_id() const;         ///< dimension of the tree ids; null if there is none
    bool recent() const { return format >= 6; }  ///< whether records have the layout of LAS 1.4
    std::size_t color() const;  ///< [bytes] offset in a record; 0 if the format has no colour
    std::size_t extra() const;  ///< [bytes] offset of the extra bytes in a record
};

using Rgb16 = std::array<std::uint16_t, 3>;

/// Values of a record that are used.
struct LasPoint {
    std::array<std::int32_t, 3> place{};  ///< in multiples of the scale of the header
    bool withheld = false;                ///< marked as withheld by the producer of the file
    std::uint16_t intensity = 0;
    std::uint8_t return_number = 0, return_count = 0, classification = 0;
    Rgb16 color{};
    std::string_view extra = {};  ///< extra bytes of the record, if requested
};

/// Points of a file in their order while it is read. Columns that are not requested or not in the format are
/// empty.
struct LasColumns {
    Buffer<std::array<std::int32_t, 3>> places;
    Buffer<std::uint16_t> intensities;
    Buffer<std::uint8_t> return_numbers, return_counts, classes;
    Buffer<Rgb16> colors;
    Buffer<std::uint32_t> tree_ids;
    const LasDimension* tree_id = nullptr;  ///< source of `tree_ids`
    std::span<const LasDimension> ranged;   ///< dimensions with a requested range

    /// Returns whether any extra bytes are used.
    bool need_extra() const { return tree_id != nullptr || !ranged.empty(); }

    void resize(std::uint64_t count, const PointColumns& wanted, const LasHeader& h) {
        places.resize(count);
        if (wanted.tree_ids) tree_id = h.tree_id();
        if (tree_id != nullptr) tree_ids.resize(count);
        if (wanted.ranges) ranged = h.dimensions;
        if (wanted.intensities) intensities.resize(count);
        if (wanted.returns) return_numbers.resize(count);
        if (wanted.returns) return_counts.resize(count);
        if (wanted.classes) classes.resize(count);
        if (wanted.colors && h.color() > 0) colors.resize(count);
    }
};

/// Minimum and maximum of numbers.
struct LasRange {
    double low = std::numeric_limits<double>::infinity(), high = -low;

    void extend(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    void extend(const LasRange& other) {
        low = std::min(low, other.low);
        high = std::max(high, other.high);
    }
};

/// A range of records that is read independently: it fills the columns from its first record on, without
/// gaps.
struct LasRecordRange {
    LasRecordRange() = default;
    LasRecordRange(LasColumns& to, std::uint64_t begin, std::uint64_t end)
        : columns(&to), first(begin), count(end - begin), ranges(to.ranged.size()) {}

    LasColumns* columns = nullptr;
    std::uint64_t first = 0;
    std::uint64_t count = 0;       ///< number of records
    std::uint64_t kept = 0;        ///< number of kept records; they are stored from `first` on
    std::vector<LasRange> ranges;  ///< one for each dimension of `ranged`

    void put(const LasPoint& p) {
        if (p.withheld) return;
        const std::uint64_t i = first + kept++;
        columns->places[i] = p.place;
        if (!columns->intensities.empty()) columns->intensities[i] = p.intensity;
        if (!columns->return_numbers.empty()) columns->return_numbers[i] = p.return_number;
        if (!columns->return_counts.empty()) columns->return_counts[i] = p.return_count;
        if (!columns->classes.empty()) columns->classes[i] = p.classification;
        if (!columns->colors.empty()) columns->colors[i] = p.color;
        if (columns->tree_id != nullptr)
            columns->tree_ids[i] = to_tree_id(columns->tree_id->value(p.extra).value_or(0));
        for (std::size_t d = 0; d < columns->ranged.size(); ++d)
            if (const auto value = columns->ranged[d].value(p.extra)) ranges[d].extend(*value);
    }
};

/// A variable length record with metadata.
struct LasRecord {
    std::string_view user;  ///< namespace of the id
    std::uint16_t id = 0;
    std::string_view data;
};

inline constexpr std::string_view kLasSpecification = "LASF_Spec", kLasProjection = "LASF_Projection";
inline constexpr std::uint16_t kExtraBytes = 4, kWkt = CoordinateSystem::kWkt;  ///< record ids
inline constexpr std::size_t kVlrHeader = 54, kDimension = 192;                 ///< [bytes]

/// Returns the records before and after the points that are within the file.
std::vector<LasRecord> las_records(std::string_view bytes, const LasHeader& h);

/// Returns the dimensions of the record about extra bytes; ignores types other than a single number and
/// dimensions beyond the size of a point record.
std::vector<LasDimension> las_dimensions(std::span<const LasRecord> records, const LasHeader& h);
CoordinateSystem coordinate_system(std::span<const LasRecord> records);

/// Throws `InvalidInput` that names `source`.
[[noreturn]] void las_trouble(const std::string& source, const std::string& subject);

/// Returns red, green and blue at offset `at` of a record.
inline Rgb16 color_at(std::string_view record, std::size_t at) {
    return {number_at<std::uint16_t>(record, at), number_at<std::uint16_t>(record, at + 2),
            number_at<std::uint16_t>(record, at + 4)};
}

/// Options for reading records.
struct LasReading {
    PointColumns wanted;
    bool allow_truncated = false;
    const std::string& source;
};

/// Throws for a file that specifies more points than it contains.
[[noreturn]] void las_cut_off(const std::string& source, const std::string& subject);

/// Reads the requested columns of a LAZ file; of a truncated file, the complete chunks.
std::vector<LasRecordRange> read_laz(std::string_view bytes, const LasHeader& h, const LasReading& reading,
                                     LasColumns& columns, const Context& ctx);

}  // namespace coppice::io_internal
