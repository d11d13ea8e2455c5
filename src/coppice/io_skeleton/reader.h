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
#include "coppice/io_skeleton/format.h"
#include "coppice/io_skeleton/length_unit.h"
#include "coppice/io_skeleton/node_attribute.h"
#include "coppice/skeleton/raw.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Options for reading a skeleton file.
struct ReadSkeletonOptions {
    SkeletonFormat format = SkeletonFormat::automatic;  ///< format of the file
    float scale = 1;        ///< factor of positions and radii: 1e-6 for a file in micrometres; > 0
    FileUp up = FileUp::z;  ///< up axis of the file
    LengthUnit units = LengthUnit::automatic;  ///< unit of length after scaling
    int model = 0;  ///< number of the model in a file with several, from 1; 0: the only one
    /// [m] radius of every node after scaling if the file has no radii; 0: estimated
    float default_radius = 0;
};

/// Lists the members for front ends.
void list_fields(ReadSkeletonOptions& options, FieldList& list);

/// Totals of the cylinders of a file before conversion, including gaps and overlaps: the figures that the
/// programs which wrote them report. In the units of the skeleton.
struct CylinderTotals {
    std::size_t cylinders = 0;  ///< number of cylinders
    double length = 0;          ///< total length
    double area = 0;            ///< total lateral area, without the end discs
    double volume = 0;          ///< total volume
};

/// A skeleton from a file, and the repairs that were needed.
struct SkeletonFile {
    Skeleton skeleton;                 ///< in `units`
    RepairReport report;               ///< repairs
    std::string format;                ///< name of the SkeletonFormat as which it was read
    LengthUnit units = LengthUnit::m;  ///< unit of all lengths here; never automatic
    std::vector<std::string> notes;    ///< further information for the user, one sentence each
    /// Additional values of nodes in JSON, PLY, RSML and MTG, in SWC as `type`, and of cylinders as `order`,
    /// `axis` and `tree`, if they are finite numbers and have a valid name (see is_attribute_name()). For SWC
    /// also the ids, as `id`, unless they are 1, 2, 3 and so on, or not all from 1 to 2^24.
    std::vector<NodeAttribute> attributes;
    std::optional<CylinderTotals> declared = std::nullopt;  ///< of cylinder files
    std::size_t models = 1;  ///< number of models in the file, including this one

    /// Returns the values of an attribute, one for each node; empty if the file has no such attribute.
    std::span<const float> attribute(std::string_view name) const;
};

/// Reads a skeleton of any SkeletonFormat and repairs it; cylinders become segments (see raw.h). The format
/// is detected by unambiguous content, then by the extension of the name, then by the first line. Throws
/// IoError if the file cannot be read, InvalidInput with file and line if it is invalid, Unsupported if its
/// format is unknown; Cancelled. O(n log n).
SkeletonFile read_skeleton(const std::filesystem::path& path, const ReadSkeletonOptions& options = {},
                           const Context& ctx = {});

/// Reads a skeleton from memory; `source` names it in messages, and its extension helps to detect the format.
SkeletonFile parse_skeleton(std::string_view text, const std::string& source,
                            const ReadSkeletonOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
