#pragma once

#include <filesystem>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/points/painted_points.h"

namespace coppice {

/// Writes points as XYZ (.xyz, .txt, .csv with commas, .asc) or PLY (.ply, binary little endian), as the name
/// ends; the file appears whole or not at all (`AtomicFile`). Text holds the shortest digits that give back
/// the same number; the origin is added in double precision, and PLY then holds doubles. Same bytes for any
/// number of threads.
///
/// Throws `IoError` for trouble with the file, `Unsupported` for other names, `InvalidInput` for positions
/// that are not finite, `Cancelled`.
void write_points(const std::filesystem::path& path, const PointSet& points, const Context& ctx = {});

/// The same as PLY, of which the name must have the ending, with the property `distance` and 8 bits each of
/// `red`, `green` and `blue`, where there are any: other programs show them. `note` is a comment in the head,
/// one line.
void write_painted_points(const std::filesystem::path& path, const PaintedPoints& painted,
                          std::string_view note, const Context& ctx = {});

}  // namespace coppice
