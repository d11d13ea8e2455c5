#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/implicit/solid/solid.h"
#include "coppice/scene/scene.h"
#include "options.h"
#include "run.h"

namespace coppice::cli {

/// [bytes] maximum size of a scene or a file of edits
inline constexpr std::uint64_t kLargestScene = std::uint64_t{64} << 20;

/// Settings of a scene from the command line.
struct SceneFlags {
    std::vector<std::string> set;  ///< NAME=VALUE
    int seed = 0;
};
void add_scene_options(OptionList& options, SceneFlags& flags);

struct SceneFile {
    std::filesystem::path path;
    std::string text;
};

/// Returns the text of a file with commands; `subject` names the kind of file, such as "a scene". Throws
/// IoError; and UsageError for a file of another kind, with the command that accepts it.
std::string read_commands(const std::filesystem::path& path, std::string_view subject);

/// Reads all files before any is run, and each only once, as a pipe can be read only once. Throws as
/// read_commands().
std::vector<SceneFile> read_scenes(Run& run, std::span<const std::filesystem::path> paths);

/// Returns the settings of the scenes. Throws UsageError if a setting is not NAME=VALUE, or no scene has such
/// a variable.
SceneSettings scene_settings(Run& run, const SceneFlags& flags, std::span<const SceneFile> scenes);

/// Runs the commands of a scene file, each as a stage of the run (a block as one stage), and prints their
/// output. Files that it reads are searched in its folder.
void run_scene(Run& run, Scene& scene, const SceneFile& file);

/// Returns the commands of scenes before they run; empty for lines that cannot be parsed. Their errors are
/// reported when they run.
std::optional<std::vector<const SceneCommand*>> commands_of_scenes(std::span<const SceneFile> scenes);

/// Runs a scene and returns the solid that "FILE:NAME" names, or the last solid that the scene in FILE
/// creates. Throws InvalidInput if there is none.
Solid solid_of_scene(Run& run, const std::string& named);

/// Reports the number of objects of a scene as counts of the run.
void count_objects(Run& run, const Scene& scene);

}  // namespace coppice::cli
