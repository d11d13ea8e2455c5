#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "coppice/scene/command.h"

namespace coppice {

/// Returns the object of a name that a file with this extension can store; with an empty name, the last
/// created one. Throws InvalidInput if there is no such object, or if several objects of the name fit.
ObjectPtr object_for_file(const SceneState& state, const std::string& name,
                          const std::filesystem::path& path);

/// Throws InvalidInput if files with this extension are not supported, or cannot store any result of the
/// commands; can be checked before a scene is run.
void check_scene_output(std::span<const SceneCommand* const> commands, const std::filesystem::path& path);

/// Throws InvalidInput if the extension does not suit the object.
void check_file_name(const SceneObject& object, const std::filesystem::path& path);

/// Writes points, a skeleton or a mesh, with its leaves stored as `storage` says; the file appears complete
/// or not at all. Throws as the writers do.
void save_object(const SceneObject& object, const std::filesystem::path& path, InstanceStorage storage,
                 const Context& ctx = {});
/// The same with leaves as instances.
inline void save_object(const SceneObject& object, const std::filesystem::path& path,
                        const Context& ctx = {}) {
    save_object(object, path, InstanceStorage::instanced, ctx);
}

/// Returns a scene that creates bit-identical objects.
std::string make_recipe(const SceneState& state);

}  // namespace coppice
