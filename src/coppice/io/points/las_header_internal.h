#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"

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

/// Throws `InvalidInput` of `source`.
[[noreturn]] void las_trouble(const std::string& source, const std::string& what);

/// Adds the point whose integers are `raw`, which must be the `i`-th; throws `InvalidInput` when it is beyond
/// 1e30.
void add_las_point(std::vector<Vec3d>& points, const LasHeader& h, Vec3d raw, const std::string& source,
                   std::uint64_t i);

/// The points of a LAZ file; `Unsupported` where the build found no LASzip library.
std::vector<Vec3d> read_laz(std::string_view bytes, const LasHeader& h, const std::string& source,
                            const Context& ctx);

}  // namespace coppice::io_internal
