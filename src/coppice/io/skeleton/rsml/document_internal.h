#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice::rsml {

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// A root of the file: an axis, which may bear others.
struct Root {
    std::uint32_t parent = kNone;  ///< index of the root it stands in
    std::uint32_t plant = 0;       ///< number of its plant, from 0
    std::uint32_t order = 0;       ///< how many roots it stands in
    std::uint32_t first_point = 0;
    std::uint32_t point_count = 0;
    std::uint32_t line = 0;
    double parent_node = kUnknown;  ///< number of the parent's point where it starts, as written
    double diameter = kUnknown;     ///< of the whole root, in pixels, where its properties tell one
};

/// How the samples of a function lie along the polyline of its root.
enum class Domain : std::uint8_t {
    polyline,  ///< one for each point
    uniform,   ///< at even distances from end to end
    length     ///< each at a distance of its own, in pixels
};

/// A quantity along a root.
struct Function {
    std::uint32_t root = 0;
    std::uint32_t name = 0;  ///< index into Document::names
    std::uint32_t first_sample = 0;
    std::uint32_t sample_count = 0;
    Domain domain = Domain::polyline;
    bool from_tip = false;  ///< distances count from the tip
};

struct Sample {
    double value = kUnknown;
    double place = kUnknown;  ///< its distance, where it is written
};

/// What a file says, in its own units and axes.
struct Document {
    std::string unit;      ///< as written; empty where none is
    std::string software;  ///< as written
    double resolution = kUnknown;
    bool is_flat = true;  ///< no point has a z that differs from 0
    std::vector<Root> roots;
    std::vector<Vec3d> points;
    std::vector<std::uint32_t> lines;  ///< of the points
    std::vector<Function> functions;
    std::vector<std::string> names;  ///< of functions, in small letters with _ for - and blanks
    std::vector<Sample> samples;
};

/// Reads the elements of RSML that make a skeleton and passes over the others, whatever their depth. Throws
/// InvalidInput for what is no XML, no RSML, has points without coordinates or declares entities. O(n).
Document parse_document(std::string_view text, const std::string& source, const Context& ctx);

}  // namespace coppice::rsml
