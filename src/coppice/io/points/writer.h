#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/io/points/reader.h"
#include "coppice/points/painted_points.h"

namespace coppice {

/// What to name instead of a file whose ending is none of those that points are written with, as the end of
/// a sentence: "use .las, .ply, ...".
std::string_view remedy_for_points_name(const std::filesystem::path& path);

/// Whether a file of this name keeps what is known of points besides their places: .xyz does not.
bool keeps_columns(const std::filesystem::path& path);

/// What is written besides the points.
struct WritePointsOptions {
    std::string note = {};         ///< a comment in the head of PLY, one line
    CoordinateSystem system = {};  ///< kept in LAS alone
};

/// Writes points as XYZ (.xyz, .txt, .csv with commas, .asc), PLY (.ply, binary little endian) or LAS 1.4
/// (.las), as the name ends; the file appears whole or not at all (`AtomicFile`). Text holds the shortest
/// digits that give back the same number; the origin is added in double precision, and PLY then holds
/// doubles. LAS holds steps of 0.1 mm, or of the least power of ten of them that 32 bits can count. Same
/// bytes for any number of threads.
///
/// Throws `IoError` for trouble with the file, `Unsupported` for other names, `InvalidInput` for positions
/// that are not finite, `Cancelled`.
void write_points(const std::filesystem::path& path, const PointSet& points, const Context& ctx = {});

/// The same with what is known of the points. PLY gets properties `distance`, `red`, `green`, `blue` (8 bits
/// each), `intensity`, `classification`, `return_number`, `number_of_returns` and `tree_id`; .txt, .csv and
/// .asc columns of these names, which the first line says; .xyz keeps the places alone, as programs that read
/// it expect. LAS has point format 6, or 7 for colours, which are brought to 16 bits, and extra dimensions
/// `tree_id` and `distance`. Its intensities are whole numbers from 0 to 65535: others are stretched linearly
/// from their least to their greatest.
void write_painted_points(const std::filesystem::path& path, const PaintedPoints& painted,
                          const WritePointsOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
