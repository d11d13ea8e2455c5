#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "coppice/mesh/height_texture.h"
#include "coppice/render/image.h"
#include "coppice/render/png_reader.h"
#include "coppice/skeleton/skeleton.h"
#include "run.h"

namespace coppice::cli {

/// Throws UsageError if the name is not that of an image, IoError if its folder does not exist; accepts an
/// empty name.
void check_picture_output(const std::filesystem::path& path);

/// Renders a square image of each skeleton, as a stage of the run.
std::vector<Image> draw_each(Run& run, std::span<const Skeleton* const> trees, int size);

/// Returns PREFIX_height.png.
std::filesystem::path height_file(const std::filesystem::path& prefix);
/// Returns the extent of an image on a surface, if its file states it. Throws IoError if it cannot be read.
std::optional<TileSize> load_tile_size(const std::filesystem::path& image);
/// Loads height_file(). Throws IoError if there is no such file, and InvalidInput if it has
/// no scale and `scale` [m] is 0.
HeightTexture load_heights(Run& run, const std::filesystem::path& prefix, float scale);

void write_picture(const std::filesystem::path& path, const Image& image);
/// Arranges all images on one approximately square sheet.
void write_sheet(const std::filesystem::path& path, std::span<const Image> pictures);

}  // namespace coppice::cli
