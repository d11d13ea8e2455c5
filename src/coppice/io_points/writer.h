#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/io_points/reader.h"
#include "coppice/points/point_cloud.h"

namespace coppice {

/// Returns advice for a file name that has no supported point extension, as the end of a sentence: "use .las,
/// .ply, ...".
std::string_view remedy_for_points_name(const std::filesystem::path& path);

/// Returns whether the format of this name stores attributes of points in addition to positions: .xyz does
/// not.
bool keeps_columns(const std::filesystem::path& path);

/// Metadata written in addition to the points.
struct WritePointsOptions {
    std::string note = {};         ///< a comment in the header of PLY, one line
    CoordinateSystem system = {};  ///< stored in LAS only
};

/// Writes points as XYZ (.xyz, .txt, .csv with commas, .asc), PLY (.ply, binary little endian) or LAS 1.4
/// (.las), by the extension of the name; the file is written atomically (`AtomicFile`). Text contains the
/// shortest digits that restore the same number; the origin is added in double precision, and PLY then stores
/// doubles. LAS stores multiples of 0.1 mm, or of the smallest power of ten times that for which 32 bits
/// suffice. The result does not depend on the number of threads.
///
/// Throws `IoError` if the file cannot be written, `Unsupported` for other extensions, `InvalidInput` for
/// positions that are not finite, `Cancelled`.
void write_points(const std::filesystem::path& path, const PointSet& points, const Context& ctx = {});

/// Writes points with their attributes. PLY gets properties `distance`, `red`, `green`, `blue` (8 bits each),
/// `intensity`, `classification`, `return_number`, `number_of_returns` and `tree_id`; .txt, .csv and .asc get
/// columns of these names, listed in the first line; .xyz stores positions only, as programs that read it
/// expect. LAS has point format 6, or 7 with colours, which are converted to 16 bits, and extra dimensions
/// `tree_id` and `distance`. Its intensities are integers from 0 to 65535: others are scaled linearly from
/// their minimum to their maximum.
void write_point_cloud(const std::filesystem::path& path, const PointCloud& point_cloud,
                       const WritePointsOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
