#pragma once

#include <filesystem>
#include <string>

#include "coppice/sketch/view.h"

namespace coppice {

/// Reads the camera of an image from a COLMAP model exported as text: `cameras.txt` and `images.txt` in a
/// folder. The scale is that of the model. Throws IoError for missing files, InvalidInput for an image that
/// is not in the model and for lines that cannot be read, Unsupported for cameras with distortion parameters
/// other than the first five of OpenCV.
SketchView read_colmap_view(const std::filesystem::path& folder, const std::string& image);

}  // namespace coppice
