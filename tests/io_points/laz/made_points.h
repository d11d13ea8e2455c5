#pragma once

#include <cstdint>

namespace made {

/// A point of the files in this folder, which `make_laz.cpp` wrote; the tests compare the points read with
/// these.
struct Point {
    std::int32_t x = 0, y = 0, z = 0;  ///< [mm]
    std::uint16_t intensity = 0;
    std::uint8_t return_number = 1, return_count = 1, classification = 0, channel = 0;
    bool withheld = false;
    std::uint16_t red = 0, green = 0, blue = 0;
    double time = 0;
};

inline constexpr std::uint32_t kCount = 200, kChunk = 64;
inline constexpr double kOffset[3] = {1e6, 2e6, 100};  ///< [m]

/// Numbers of points of the first chunks if they vary.
inline constexpr std::uint32_t kVarying[] = {1, 70, 2, 90, 37};

inline std::uint32_t scatter(std::uint32_t i, std::uint32_t salt) {
    std::uint32_t h = (i + 1) * 2654435761u ^ salt * 2246822519u;
    h = (h ^ h >> 15) * 2246822519u;
    h = (h ^ h >> 13) * 3266489917u;
    return h ^ h >> 16;
}

/// Returns the `i`-th point of a file of `format`; the scanner's `channels` alternate.
inline Point point(int format, std::uint32_t i, std::uint32_t channels = 1) {
    const bool recent = format >= 6;
    Point p;
    p.x = static_cast<std::int32_t>(i * 3 + scatter(i, 1) % 4000) - 1000;
    p.y = static_cast<std::int32_t>(i * 5 + scatter(i, 2) % 300) - 70000;
    p.z = static_cast<std::int32_t>(scatter(i / 4, 3) % 20000);
    if (i % 61 == 60) p.x = -20000000 + static_cast<std::int32_t>(i);  // a large step
    p.intensity = static_cast<std::uint16_t>(i % 3 == 0 ? 700 : scatter(i, 4));
    p.return_count = static_cast<std::uint8_t>(1 + scatter(i / 3, 5) % (recent ? 15 : 5));
    p.return_number = static_cast<std::uint8_t>(1 + i % p.return_count);
    p.classification = static_cast<std::uint8_t>(scatter(i / 5, 6) % (recent ? 256 : 32));
    p.channel = static_cast<std::uint8_t>(scatter(i / 6, 7) % channels);
    p.withheld = i % 50 == 49;
    p.red = static_cast<std::uint16_t>(256 * (i % 200) + scatter(i, 8) % 7);
    p.green = static_cast<std::uint16_t>(i % 4 < 2 ? p.red : scatter(i, 9));
    p.blue = static_cast<std::uint16_t>(i % 4 < 2 ? p.red : scatter(i, 10) % 3000);
    p.time = 0.001 * (i / 2) + (i % 7 == 3 ? 1e5 : 0) + (i % 40 == 39 ? 0.3 : 0);
    return p;
}

}  // namespace made
