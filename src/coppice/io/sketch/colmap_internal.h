#pragma once

#include <filesystem>
#include <string>

#include "coppice/sketch/view.h"

namespace coppice {

/// The camera of a picture, as COLMAP writes it: `cameras.txt` and `images.txt` in a folder (a model exported
/// as text). The scale is the model's. Throws IoError for files that are missing, InvalidInput for a picture
/// that is not among them and for lines that cannot be read, Unsupported for cameras with other distortions
/// than OpenCV's first five.
SketchView read_colmap_view(const std::filesystem::path& folder, const std::string& image);

}  // namespace coppice
