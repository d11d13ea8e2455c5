#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/io/skeleton/format.h"
#include "coppice/io/skeleton/node_attribute.h"
#include "coppice/skeleton/raw.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// How a skeleton file is understood.
struct ReadSkeletonOptions {
    SkeletonFormat format = SkeletonFormat::automatic;  ///< what the file is taken for
    float scale = 1;  ///< multiplies positions and radii: 1e-6 for a file in micrometres; > 0
    int model = 0;    ///< which model of a file with several, from 1; 0 = the only one
    float default_radius =
        0;  ///< [m] of every node when the file has no radii, after scaling; 0 = estimate it
};

template <class Self, class Visitor>
requires SameOptions<Self, ReadSkeletonOptions>
constexpr void visit_fields(Self& options, Visitor&& visit) {
    visit(Field{"format", "kind of the skeleton file"}, options.format);
    visit(Field{"scale", "multiplies positions and radii, to turn the units of the file into metres",
                Unit::none, 1e-12, 1e12},
          options.scale);
    visit(Field{"model", "which model of a file with several, from 1; 0 takes the only one", Unit::none, 0,
                1e6},
          options.model);
    visit(Field{"default_radius", "radius when the file has none; 0 estimates it", Unit::metre, 0, 1e6},
          options.default_radius);
}

/// A skeleton from a file, and what had to be repaired.
struct SkeletonFile {
    Skeleton skeleton;               ///< [m]
    RepairReport report;             ///< what was repaired
    std::string format;              ///< name of the SkeletonFormat it was read as
    std::vector<std::string> notes;  ///< what else the user should know, one sentence each
    /// What JSON and PLY say of each node besides, where that is a finite number and well named (see
    /// is_attribute_name()).
    std::vector<NodeAttribute> attributes;

    /// The values of an attribute, one per node; none where the file has no such attribute.
    std::span<const float> attribute(std::string_view name) const;
};

/// Reads a skeleton of any SkeletonFormat and repairs it; cylinders become segments (see raw.h). The format
/// follows from what the file says of itself, then from the ending of its name, then from its first line.
/// Throws IoError when the file cannot be read, InvalidInput naming file and line when it is wrong,
/// Unsupported when its kind is unknown; Cancelled. O(n log n).
SkeletonFile read_skeleton(const std::filesystem::path& path, const ReadSkeletonOptions& options = {},
                           const Context& ctx = {});

/// The same for the bytes of a file in memory, `source` being what messages call it and whose ending helps to
/// tell the format.
SkeletonFile parse_skeleton(std::string_view text, const std::string& source,
                            const ReadSkeletonOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
