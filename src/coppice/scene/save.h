#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "coppice/scene/command.h"

namespace coppice {

/// The object of a name that a file with this ending can hold: with an empty name the one that was made last.
/// Throws InvalidInput when there is none, or when several of one name fit.
ObjectPtr object_for_file(const SceneState& state, const std::string& name,
                          const std::filesystem::path& path);

/// Throws InvalidInput when files with this ending are not written, or hold nothing that one of the commands
/// makes: what can be known before a scene is run.
void check_scene_output(std::span<const SceneCommand* const> commands, const std::filesystem::path& path);

/// Throws InvalidInput when the ending does not suit the object.
void check_file_name(const SceneObject& object, const std::filesystem::path& path);

/// Writes points, a skeleton or a mesh; the file appears whole or not at all. Throws what the writers throw.
void save_object(const SceneObject& object, const std::filesystem::path& path, const Context& ctx = {});

/// A scene that makes the same objects with the same bits.
std::string recipe_of(const SceneState& state);

}  // namespace coppice
