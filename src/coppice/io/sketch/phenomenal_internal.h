#pragma once

#include <filesystem>
#include <string>

#include "coppice/sketch/view.h"

namespace coppice {

/// A camera before a turntable, as OpenAlea's Phenomenal calibrates it (`calibration_cameras.json`, in
/// millimetres): `camera` is its name there, `side` say, `angle` [rad] what the table had been turned by. The
/// world turns with the plant and lies as with angle 0. Throws IoError for a file that is missing,
/// InvalidInput for a camera that it does not have and for fields that are missing or wrong.
SketchView read_phenomenal_view(const std::filesystem::path& path, const std::string& camera, double angle);

}  // namespace coppice
