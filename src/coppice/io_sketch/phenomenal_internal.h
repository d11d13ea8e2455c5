#pragma once

#include <filesystem>
#include <string>

#include "coppice/sketch/view.h"

namespace coppice {

/// Reads a camera in front of a turntable, as calibrated by Phenomenal of OpenAlea
/// (`calibration_cameras.json`, in millimetres): `camera` is its name there, such as `side`, and `angle`
/// [rad] the rotation of the table. The world rotates with the plant; its axes are those at angle 0. Throws
/// IoError for a missing file, InvalidInput for an unknown camera and for fields that are missing or invalid.
SketchView read_phenomenal_view(const std::filesystem::path& path, const std::string& camera, double angle);

}  // namespace coppice
