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

/// [bytes] No scene, and no file of edits, may be larger.
inline constexpr std::uint64_t kLargestScene = std::uint64_t{64} << 20;

/// What a scene is given from outside.
struct SceneFlags {
    std::vector<std::string> set;  ///< NAME=VALUE
    int seed = 0;
};
void add_scene_options(OptionList& options, SceneFlags& flags);

struct SceneFile {
    std::filesystem::path path;
    std::string text;
};

/// The text of a file with commands: `what` is "a scene", for one. Throws IoError; and UsageError for a file
/// of another kind, with the command that takes it.
std::string read_commands(const std::filesystem::path& path, std::string_view what);

/// All are read before any is run, and once: a pipe gives its text but once. Throws as read_commands().
std::vector<SceneFile> read_scenes(Run& run, std::span<const std::filesystem::path> paths);

/// The settings of the scenes that are to be run. Throws UsageError for what is no NAME=VALUE, or names no
/// variable of theirs.
SceneSettings scene_settings(Run& run, const SceneFlags& flags, std::span<const SceneFile> scenes);

/// Runs the commands of a scene file, each as a stage of the run, and a block as one, and prints what they
/// say. Files that it reads are looked for beside it.
void run_scene(Run& run, Scene& scene, const SceneFile& file);

/// The commands of scenes that are to be run, as far as is known before: none where a line cannot be read,
/// which running it tells of.
std::optional<std::vector<const SceneCommand*>> commands_of_scenes(std::span<const SceneFile> scenes);

/// The solid that "FILE:NAME" names, or the one that the scene in FILE makes last; runs the scene. Throws
/// InvalidInput where there is none.
Solid solid_of_scene(Run& run, const std::string& named);

/// What a scene holds, as counts of the run.
void count_objects(Run& run, const Scene& scene);

}  // namespace coppice::cli
