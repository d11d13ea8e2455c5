#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/vec.h"

namespace coppice::e57 {

/// A field of the points of a scan and the packing of its values.
struct Field {
    enum class Type : std::uint8_t { float32, float64, integer };

    std::string name;
    Type type = Type::integer;
    std::uint64_t minimum = 0;  ///< of integers, in two's complement: added to the stored value
    unsigned bits = 64;         ///< number of bits of a value; 0 if all values equal the minimum
    double scale = 1, offset = 0;
};

/// A scan: the points from one position of a scanner.
struct Scan {
    std::array<double, 4> rotation{
        1, 0, 0, 0};    ///< quaternion w x y z, from the frame of the scanner to that of the file
    Vec3d translation;  ///< [m] position of the scanner
    bool has_points = false;
    std::uint64_t offset = 0;  ///< [bytes] offset of the points in the file
    std::uint64_t count = 0;   ///< number of records
    std::vector<Field> fields;
    std::array<double, 3> max_color{};  ///< maximum of red, green and blue; 0 if unspecified
};

struct Document {
    std::vector<Scan> scans;
    std::string system;  ///< coordinate reference system as WKT; may be empty
};

/// Parses the XML of an E57 file. Throws InvalidInput if it is not valid XML, if a number is damaged, a range
/// is empty or the points have a text field.
Document parse_document(std::string_view xml, const std::string& source);

}  // namespace coppice::e57
