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
#include "coppice/points/point_set.h"

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
};

/// What is used of a record.
struct LasPoint {
    std::array<std::int32_t, 3> place{};  ///< in steps of the header's scale
    bool withheld = false;                ///< marked by whoever made the file as not to be used
};

/// Points of a file in the making, in their order.
struct LasColumns {
    Buffer<std::array<std::int32_t, 3>> places;
};

/// A run of records that is read by itself: it fills the columns from its first record on, without gaps.
struct LasPart {
    LasColumns* columns = nullptr;
    std::uint64_t first = 0, kept = 0;

    void put(const LasPoint& p) {
        if (!p.withheld) columns->places[first + kept++] = p.place;
    }
};

/// Throws `InvalidInput` of `source`.
[[noreturn]] void las_trouble(const std::string& source, const std::string& what);

/// The points of a LAZ file, whose columns have room for all.
std::vector<LasPart> read_laz(std::string_view bytes, const LasHeader& h, LasColumns& columns,
                              const std::string& source, const Context& ctx);

}  // namespace coppice::io_internal
