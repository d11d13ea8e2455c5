#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/base/vec.h"

namespace coppice::rsml {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// A root of the file: an axis that may have laterals.
struct Root {
    std::uint32_t parent = kNoIndex;  ///< index of the enclosing root
    std::uint32_t plant = 0;          ///< number of its plant, from 0
    std::uint32_t order = 0;          ///< number of enclosing roots
    std::uint32_t first_point = 0;
    std::uint32_t point_count = 0;
    std::uint32_t line = 0;
    double parent_node = kUnknown;  ///< number of the parent's point at its start, as in the file
    double diameter = kUnknown;     ///< of the whole root, in pixels, if its properties specify one
};

/// Positions of the samples of a function along the polyline of its root.
enum class Domain : std::uint8_t {
    polyline,  ///< one at each point
    uniform,   ///< equally spaced from end to end
    length     ///< each at a specified distance, in pixels
};

/// A quantity along a root.
struct Function {
    std::uint32_t root = 0;
    std::uint32_t name = 0;  ///< index into Document::names
    std::uint32_t first_sample = 0;
    std::uint32_t sample_count = 0;
    Domain domain = Domain::polyline;
    bool from_tip = false;  ///< distances are measured from the tip
};

struct Sample {
    double value = kUnknown;
    double place = kUnknown;  ///< its distance, if specified
};

/// Content of a file, in its own units and axes.
struct Document {
    std::string unit;      ///< as in the file; empty if missing
    std::string software;  ///< as in the file
    double resolution = kUnknown;
    bool is_flat = true;  ///< whether z is 0 for all points
    std::vector<Root> roots;
    std::vector<Vec3d> points;
    std::vector<std::uint32_t> lines;  ///< line numbers of the points
    std::vector<Function> functions;
    std::vector<std::string> names;  ///< names of functions, in lower case with _ for - and blanks
    std::vector<Sample> samples;
};

/// Parses the elements of RSML that define a skeleton and skips the others, at any depth. Throws InvalidInput
/// if it is not XML or not RSML, has points without coordinates or declares entities. O(n).
Document parse_document(std::string_view text, const std::string& source, const Context& ctx);

}  // namespace coppice::rsml
