#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/vec.h"

namespace coppice::e57 {

/// A field of the points of a scan, and how its values are packed.
struct Field {
    enum class Type : std::uint8_t { float32, float64, integer };

    std::string name;
    Type type = Type::integer;
    std::uint64_t minimum = 0;  ///< of integers, in two's complement: added to what is stored
    unsigned bits = 64;         ///< of a value; 0 where all are the minimum
    double scale = 1, offset = 0;
};

/// The points of a scanner at one place.
struct Scan {
    std::array<double, 4> rotation{1, 0, 0, 0};  ///< w x y z, of the scanner's frame into that of the file
    Vec3d translation;                           ///< [m] where the scanner stood
    bool has_points = false;
    std::uint64_t offset = 0;  ///< [bytes] of the points, in the file
    std::uint64_t count = 0;   ///< of records
    std::vector<Field> fields;
    std::array<double, 3> most_color{};  ///< the greatest red, green and blue; 0 where nothing tells it
};

struct Document {
    std::vector<Scan> scans;
    std::string system;  ///< of the coordinates, as WKT; or none
};

/// Reads the XML of an E57 file. Throws InvalidInput where it is none, where a number is damaged or a range
/// is empty, and where a field of text is among those of points.
Document parse_document(std::string_view xml, const std::string& source);

}  // namespace coppice::e57
