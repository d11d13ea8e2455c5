#pragma once

#include <filesystem>

#include "coppice/base/context.h"
#include "coppice/points/point_set.h"

namespace coppice {

/// Writes points as XYZ (.xyz, .txt, .csv with commas, .asc) or PLY (.ply, binary little endian), as the name
/// ends; the file appears whole or not at all (`AtomicFile`). Text holds the shortest digits that give back
/// the same number; the origin is added in double precision, and PLY then holds doubles. Same bytes for any
/// number of threads.
///
/// Throws `IoError` for trouble with the file, `Unsupported` for other names, `InvalidInput` for positions
/// that are not finite, `Cancelled`.
void write_points(const std::filesystem::path& path, const PointSet& points, const Context& ctx = {});

}  // namespace coppice
