#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"
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

/// What is needed of the header of LAS and LAZ files; checked by `parse_las`.
struct LasHeader {
    int major = 1, minor = 0;
    std::uint64_t data = 0;    ///< offset of the first record
    std::uint8_t format = 0;   ///< 0 to 10
    std::uint16_t record = 0;  ///< [bytes] not less than the format's
    std::uint64_t count = 0;
    bool compressed = false;
    Vec3d scale, offset;

    bool recent() const { return format >= 6; }  ///< records as LAS 1.4 has them
    std::size_t color() const;                   ///< [bytes] where in a record it begins; 0 = it has none
};

using Rgb16 = std::array<std::uint16_t, 3>;

/// What is used of a record.
struct LasPoint {
    std::array<std::int32_t, 3> place{};  ///< in steps of the header's scale
    bool withheld = false;                ///< marked by whoever made the file as not to be used
    std::uint16_t intensity = 0;
    std::uint8_t return_number = 0, return_count = 0, classification = 0;
    Rgb16 color{};
};

/// Points of a file in the making, in their order. Columns that are not wanted, or that the format has not,
/// are empty.
struct LasColumns {
    Buffer<std::array<std::int32_t, 3>> places;
    Buffer<std::uint16_t> intensities;
    Buffer<std::uint8_t> return_numbers, return_counts, classes;
    Buffer<Rgb16> colors;

    void resize(std::uint64_t count, const PointColumns& wanted, const LasHeader& h) {
        places.resize(count);
        if (wanted.intensities) intensities.resize(count);
        if (wanted.returns) return_numbers.resize(count);
        if (wanted.returns) return_counts.resize(count);
        if (wanted.classes) classes.resize(count);
        if (wanted.colors && h.color() > 0) colors.resize(count);
    }
};

/// A run of records that is read by itself: it fills the columns from its first record on, without gaps.
struct LasPart {
    LasColumns* columns = nullptr;
    std::uint64_t first = 0, kept = 0;

    void put(const LasPoint& p) {
        if (p.withheld) return;
        const std::uint64_t i = first + kept++;
        columns->places[i] = p.place;
        if (!columns->intensities.empty()) columns->intensities[i] = p.intensity;
        if (!columns->return_numbers.empty()) columns->return_numbers[i] = p.return_number;
        if (!columns->return_counts.empty()) columns->return_counts[i] = p.return_count;
        if (!columns->classes.empty()) columns->classes[i] = p.classification;
        if (!columns->colors.empty()) columns->colors[i] = p.color;
    }
};

/// Throws `InvalidInput` of `source`.
[[noreturn]] void las_trouble(const std::string& source, const std::string& what);

/// Red, green and blue of a record that has them at `at`.
inline Rgb16 color_at(std::string_view record, std::size_t at) {
    return {number_at<std::uint16_t>(record, at), number_at<std::uint16_t>(record, at + 2),
            number_at<std::uint16_t>(record, at + 4)};
}

/// The points of a LAZ file, with the columns that are wanted.
std::vector<LasPart> read_laz(std::string_view bytes, const LasHeader& h, const PointColumns& wanted,
                              LasColumns& columns, const std::string& source, const Context& ctx);

}  // namespace coppice::io_internal
