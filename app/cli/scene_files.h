#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "coppice/scene/scene.h"
#include "run.h"

namespace coppice::cli {

inline constexpr Field kMaxMemory{"max_memory", "MiB that the objects of the scene may take", Unit::none, 1,
                                  1e6};

/// Runs the commands of a scene file, each as a stage of the run, and prints what they say. Files that it
/// reads are looked for beside it.
void run_scene_file(Run& run, Scene& scene, const std::filesystem::path& path);

/// What a scene holds, as counts of the run.
void count_objects(Run& run, const Scene& scene);

}  // namespace coppice::cli
