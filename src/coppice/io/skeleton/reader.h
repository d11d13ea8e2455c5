#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/io/file_up.h"
#include "coppice/io/skeleton/format.h"
#include "coppice/io/skeleton/length_unit.h"
#include "coppice/io/skeleton/node_attribute.h"
#include "coppice/skeleton/raw.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// How a skeleton file is understood.
struct ReadSkeletonOptions {
    SkeletonFormat format = SkeletonFormat::automatic;  ///< what the file is taken for
    float scale = 1;        ///< multiplies positions and radii: 1e-6 for a file in micrometres; > 0
    FileUp up = FileUp::z;  ///< axis of the file that points up
    LengthUnit units = LengthUnit::automatic;  ///< what a unit of length is, after scaling
    int model = 0;  ///< which model of a file with several, from 1; 0 = the only one
    float default_radius =
        0;  ///< [m] of every node when the file has no radii, after scaling; 0 = estimate it
};

template <class Self, class Visitor>
requires SameOptions<Self, ReadSkeletonOptions>
constexpr void visit_fields(Self& options, Visitor&& visit) {
    visit(Field{"format", "kind of the skeleton file"}, options.format);
    visit(
        common_field("scale", "Factor that converts positions and radii from the units of the file to metres",
                     Unit::none, 1e-12, 1e12),
        options.scale);
    visit(common_field("up", "Axis of the file that points up; y for OBJ files from Blender and games"),
          options.up);
    visit(
        Field{"units",
              "what a unit of length is, after scaling: figures and written files say so; automatic goes by "
              "what the file says, takes large neurons to be in um, others in m"},
        options.units);
    visit(Field{"model", "which model of a file with several, from 1; 0 takes the only one", Unit::none, 0,
                1e6},
          options.model);
    visit(Field{"default_radius", "radius when the file has none; 0 estimates it", Unit::metre, 0, 1e6},
          options.default_radius);
}

/// What the cylinders of a file add up to as they stand there, gaps and overlaps and all: the figures that
/// the programs which made them state. In the units of the skeleton.
struct CylinderTotals {
    std::size_t cylinders = 0;  ///< how many
    double length = 0;          ///< of all
    double area = 0;            ///< lateral, without the discs at the ends
    double volume = 0;          ///< of all
};

/// A skeleton from a file, and what had to be repaired.
struct SkeletonFile {
    Skeleton skeleton;                 ///< in `units`
    RepairReport report;               ///< what was repaired
    std::string format;                ///< name of the SkeletonFormat it was read as
    LengthUnit units = LengthUnit::m;  ///< what all lengths here are in; never automatic
    std::vector<std::string> notes;    ///< what else the user should know, one sentence each
    /// What JSON, PLY, RSML and MTG, SWC as `type`, and cylinders as `order`, `axis` and `tree`, say of each
    /// node besides, where that is a finite number and well named (see is_attribute_name()). Of SWC also the
    /// ids, as `id`, unless they are 1, 2, 3 and so on, or not all from 1 to 2^24.
    std::vector<NodeAttribute> attributes;
    std::optional<CylinderTotals> declared = std::nullopt;  ///< of files of cylinders
    std::size_t models = 1;                                 ///< how many the file holds, this one included

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
