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
#include "coppice/io/points/read_internal.h"
#include "coppice/io/points/reader.h"
#include "coppice/points/painted_points.h"

namespace coppice::io_internal {

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

inline constexpr std::size_t kOldLasHeader = 227, kNewLasHeader = 375;  // [bytes] up to LAS 1.2, and of 1.4

/// A number that the records of a file have besides those of their format.
struct LasDimension {
    std::string name;
    std::size_t at = 0;     ///< [bytes] from the first byte that the format does not have
    std::uint8_t type = 0;  ///< as LAS numbers them, 1 to 10
    double scale = 1, offset = 0;
    std::optional<double> no_data;  ///< stands for an unknown value, before scale and offset

    /// Nothing where it is unknown.
    std::optional<double> value(std::string_view extra) const;
};

/// What is needed of the header of LAS and LAZ files; checked by `parse_las`.
struct LasHeader {
    int major = 1, minor = 0;
    std::uint64_t data = 0;    ///< offset of the first record
    std::uint8_t format = 0;   ///< 0 to 10
    std::uint16_t record = 0;  ///< [bytes] not less than the format's
    std::uint64_t count = 0;
    bool compressed = false;
    Vec3d scale, offset;
    std::vector<LasDimension> dimensions = {};

    const LasDimension* tree_id() const;         ///< the dimension of the ids of trees; null where none is
    bool recent() const { return format >= 6; }  ///< records as LAS 1.4 has them
    std::size_t color() const;                   ///< [bytes] where in a record it begins; 0 = it has none
    std::size_t extra() const;                   ///< [bytes] where in a record what the format has not begins
};

using Rgb16 = std::array<std::uint16_t, 3>;

/// What is used of a record.
struct LasPoint {
    std::array<std::int32_t, 3> place{};  ///< in steps of the header's scale
    bool withheld = false;                ///< marked by whoever made the file as not to be used
    std::uint16_t intensity = 0;
    std::uint8_t return_number = 0, return_count = 0, classification = 0;
    Rgb16 color{};
    std::string_view extra = {};  ///< what the record has beyond its format, where it is wanted
};

/// Points of a file in the making, in their order. Columns that are not wanted, or that the format has not,
/// are empty.
struct LasColumns {
    Buffer<std::array<std::int32_t, 3>> places;
    Buffer<std::uint16_t> intensities;
    Buffer<std::uint8_t> return_numbers, return_counts, classes;
    Buffer<Rgb16> colors;
    Buffer<std::uint32_t> tree_ids;
    const LasDimension* tree_id = nullptr;  ///< where they are taken from
    std::span<const LasDimension> ranged;   ///< of which the range is wanted

    /// Whether anything is taken from what records have beyond their format.
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

/// The least and the greatest of some numbers.
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

/// A run of records that is read by itself: it fills the columns from its first record on, without gaps.
struct LasPart {
    LasPart() = default;
    LasPart(LasColumns& to, std::uint64_t begin, std::uint64_t end)
        : columns(&to), first(begin), count(end - begin), ranges(to.ranged.size()) {}

    LasColumns* columns = nullptr;
    std::uint64_t first = 0;
    std::uint64_t count = 0;       ///< of records
    std::uint64_t kept = 0;        ///< of them, the first places from `first` on
    std::vector<LasRange> ranges;  ///< of `ranged`

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
            columns->tree_ids[i] = tree_id_of(columns->tree_id->value(p.extra).value_or(0));
        for (std::size_t d = 0; d < columns->ranged.size(); ++d)
            if (const auto value = columns->ranged[d].value(p.extra)) ranges[d].extend(*value);
    }
};

/// A variable length record: what else a file says.
struct LasRecord {
    std::string_view user;  ///< who defines what ids mean
    std::uint16_t id = 0;
    std::string_view data;
};

inline constexpr std::string_view kLasSpecification = "LASF_Spec", kLasProjection = "LASF_Projection";
inline constexpr std::uint16_t kExtraBytes = 4, kWkt = CoordinateSystem::kWkt;  ///< ids of records
inline constexpr std::size_t kVlrHeader = 54, kDimension = 192;                 ///< [bytes]

/// The records before and after the points, as far as they lie within the file.
std::vector<LasRecord> las_records(std::string_view bytes, const LasHeader& h);

/// What the record about extra bytes says; those of other kinds than one number, or beyond the records of
/// points, are passed over.
std::vector<LasDimension> las_dimensions(std::span<const LasRecord> records, const LasHeader& h);
CoordinateSystem coordinate_system(std::span<const LasRecord> records);

/// Throws `InvalidInput` of `source`.
[[noreturn]] void las_trouble(const std::string& source, const std::string& what);

/// Red, green and blue of a record that has them at `at`.
inline Rgb16 color_at(std::string_view record, std::size_t at) {
    return {number_at<std::uint16_t>(record, at), number_at<std::uint16_t>(record, at + 2),
            number_at<std::uint16_t>(record, at + 4)};
}

/// How records are read.
struct LasReading {
    PointColumns wanted;
    bool allow_truncated = false;
    const std::string& source;
};

/// Points of a file that says it has more than there are.
[[noreturn]] void las_cut_off(const std::string& source, const std::string& what);

/// The points of a LAZ file, with the columns that are wanted. Of one that is truncated the whole chunks.
std::vector<LasPart> read_laz(std::string_view bytes, const LasHeader& h, const LasReading& reading,
                              LasColumns& columns, const Context& ctx);

}  // namespace coppice::io_internal
