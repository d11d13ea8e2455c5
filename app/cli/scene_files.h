#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coppice/scene/scene.h"
#include "run.h"

namespace coppice::cli {

/// Runs the commands of a scene file, each as a stage of the run, and prints what they say. Files that it
/// reads are looked for beside it.
void run_scene_file(Run& run, Scene& scene, const std::filesystem::path& path);

/// The commands of scene files that are to be run, as far as is known before: none where a file or a line
/// cannot be read, which running it tells of.
std::optional<std::vector<const SceneCommand*>> commands_of_files(
    std::span<const std::filesystem::path> scenes);

/// What a scene holds, as counts of the run.
void count_objects(Run& run, const Scene& scene);

}  // namespace coppice::cli
