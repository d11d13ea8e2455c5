#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/edit/editable_tree.h"
#include "coppice/growth/watch.h"
#include "coppice/implicit/solid/solid_field.h"
#include "coppice/scene/argument.h"
#include "coppice/scene/object.h"
#include "coppice/system/folder_sandbox.h"

namespace coppice {

/// Limits and settings of a scene.
struct SceneSettings {
    int max_memory = 4096;  ///< [MiB] maximum memory of all objects and of the current command, checked
                            ///< before the command runs
    bool files = true;      ///< whether files may be read and written
    bool outputs = true;  ///< whether save and render write files; otherwise they only check their arguments
    std::filesystem::path folder = {};  ///< folder of input files; empty: the current one
    int seed = 0;                       ///< seed of commands without one, until set seed changes it
    /// values as entered, which replace those of the first let
    std::map<std::string, std::string> variables = {};
    /// If given, files are read and written only in this sandbox, with names relative to its folder, and
    /// `folder` is ignored; recorded commands keep file names as entered.
    std::shared_ptr<const FolderSandbox> sandbox = {};
    int max_lines = 100'000;  ///< maximum number of lines that a block of loops may run
    bool judge = false;       ///< whether `mesh` compares surfaces with their skeletons: Surface::verdict
    GrowthWatch watch = {};   ///< receives intermediate results of `grow` and `sprout`; may be empty
};

/// Objects of a scene by kind and name.
using SceneObjects = std::map<std::pair<ObjectKind, std::string>, ObjectPtr>;

/// State of a scene between two commands.
struct SceneState {
    SceneObjects objects;                                  ///< current objects
    std::vector<std::string> history;                      ///< commands that created them, with all options
    std::string last_grown;                                ///< name of the last grown skeleton
    std::vector<std::pair<ObjectKind, std::string>> made;  ///< in order of creation
    int seed = 0;                                          ///< seed of commands without one
    std::uint64_t bytes = 0;                               ///< approximate memory of the objects
};

struct SceneCommand;

/// A command with its arguments, checked against the table; omitted arguments have their defaults. All named
/// objects exist.
class SceneCall {
  public:
    /// Creates a call without values: see bind_command. The arguments must outlive it.
    SceneCall(const SceneCommand& command, const SceneState& state, const SceneSettings& settings,
              const Context& ctx);

    const SceneCommand& command() const { return command_; }     ///< the entry of the table
    const SceneState& state() const { return state_; }           ///< state of the scene before the call
    const SceneSettings& settings() const { return settings_; }  ///< settings of the scene
    const Context& context() const { return ctx_; }              ///< context for library functions
    std::string typed() const;                                   ///< the complete line, with all options

    /// Returns all values of an argument; empty if it was omitted and has no default.
    std::span<const ArgumentValue> values(std::string_view name) const;
    bool has(std::string_view name) const { return !values(name).empty(); }  ///< whether it has a value
    const std::string& text(std::string_view name) const;  ///< text of the first value, which must exist
    double number(std::string_view name) const;            ///< in the unit of the library
    bool flag(std::string_view name) const { return text(name) == "true"; }  ///< whether it is "true"
    Vec3 point(std::string_view name) const;                                 ///< for a tuple of three numbers
    std::vector<Vec3> points(std::string_view name) const;                   ///< one point per value

    /// Returns the object named by the text of an argument; it must exist.
    const Solid& solid(const std::string& name) const { return get<Solid>(ObjectKind::solid, name); }
    /// Returns the field of a solid in coordinates relative to `origin`; throws as `reserve` does.
    SolidField field(const std::string& name, Vec3d origin = {}) const;
    /// As solid().
    const Curve& path(const std::string& name) const { return get<Curve>(ObjectKind::path, name); }
    /// As solid().
    const Profile& profile(const std::string& name) const { return get<Profile>(ObjectKind::profile, name); }
    /// As solid().
    const PointSet& point_set(const std::string& name) const {
        return get<PointSet>(ObjectKind::points, name);
    }
    /// As solid().
    const Skeleton& skeleton(const std::string& name) const {
        return get<Skeleton>(ObjectKind::skeleton, name);
    }
    /// Returns the attributes of the nodes of a skeleton, in addition to their radii.
    std::span<const NodeAttribute> attributes(const std::string& name) const {
        return state_.objects.at({ObjectKind::skeleton, name})->attributes;
    }
    /// As solid().
    const Surface& surface(const std::string& name) const { return get<Surface>(ObjectKind::mesh, name); }
    /// As solid().
    const SurfaceMaterial& material(const std::string& name) const {
        return get<SurfaceMaterial>(ObjectKind::material, name);
    }
    /// Returns the object of a name, of any kind, or of the kind called `kind` if that is not empty. Throws
    /// InvalidInput if there is no such object or several.
    ObjectPtr any(const std::string& name, const std::string& kind) const;

    /// Returns an option struct with members from the arguments: "grow" for arguments with the fields
    /// "grow.step" and so on.
    template <OptionStruct Options>
    Options options(const std::string& path, Options out = {}) const {
        read_members(option_fields(out), path);
        return out;
    }

    /// Throws InvalidInput if `bytes` more would exceed the memory limit.
    void reserve(double bytes) const;
    double memory_left() const;  ///< bytes below the limit; >= 0
    /// Returns the path of an input file; throws IoError if files are forbidden, or this one by the sandbox.
    std::filesystem::path input(std::string_view name) const;
    /// Returns the path of an output file; throws IoError if files are forbidden, or this one by the sandbox,
    /// or its folder does not exist.
    std::filesystem::path output(std::string_view name) const;
    /// Returns the sandbox for files named within files; null if they may be anywhere.
    const FolderSandbox* sandbox() const { return settings_.sandbox.get(); }

    void set(const Argument& argument, std::vector<ArgumentValue> values);  ///< sets parsed values
    void unset(const Argument& argument) {
        values_.erase(argument.name);
    }  ///< removes the values of an argument

  private:
    template <class T>
    const T& get(ObjectKind kind, const std::string& name) const {
        return std::get<T>(state_.objects.at({kind, name})->value);
    }
    /// Sets the members that have arguments; see options().
    void read_members(std::span<const OptionField> members, const std::string& path) const;
    void read(const Argument& argument, const OptionRef& member) const;
    const Argument* by_field(const std::string& field) const;

    const SceneCommand& command_;
    const SceneState& state_;
    const SceneSettings& settings_;
    const Context& ctx_;
    std::map<std::string, std::vector<ArgumentValue>, std::less<>> values_;
};

/// Effect of a command on a scene; not applied if the command fails.
struct SceneOutcome {
    /// An object that is added or removed.
    struct Change {
        ObjectKind kind;   ///< kind of the object
        std::string name;  ///< name of the object
        ObjectPtr object;  ///< null: the object is removed
    };
    std::vector<Change> changes;  ///< in order
    std::string text;             ///< text output of the command
    std::string grown;            ///< name of a grown skeleton, or empty
    std::optional<int> seed;      ///< new seed for commands without one
    int undo = 0;                 ///< number of commands to undo
};

/// An entry of the command table, as used by parsing, help and the reference page.
struct SceneCommand {
    std::string name;                  ///< "sphere", "pointset thin"
    std::vector<std::string> aliases;  ///< other names
    std::string group;                 ///< heading in the reference page
    std::string help;                  ///< one sentence with a capital and a full stop
    std::string example;               ///< a line that works after the examples of the commands before it
    std::vector<Argument> arguments;   ///< positional ones first
    bool records = true;              ///< whether it creates or changes objects, so that a recipe contains it
    std::optional<ObjectKind> makes;  ///< kind of the result, if it is always the same
    std::function<SceneOutcome(const SceneCall&)>
        run;  ///< executes the command; throws as the library functions do
    /// For commands that edit a tree, which `run` copies from the scene and back: applies the edit to a
    /// persistent tree.
    std::function<EditChange(const SceneCall&, EditableTree&)> edit;
    std::function<std::string(const SceneCall&, const EditableTree&)>
        show;  ///< the same for commands that only inspect it
};

/// Returns the table of all commands, in the order of the reference page.
std::span<const SceneCommand> scene_commands();

/// Returns the command named by the first one or two words; stores their number in `used`. Throws
/// InvalidInput with the closest spelling.
const SceneCommand& find_command(std::span<const SceneWord> words, std::size_t& used);

/// Returns the commands in the lines of a scene, including those in blocks; none if a line cannot be parsed:
/// running it reports the error.
std::optional<std::vector<const SceneCommand*>> find_commands(std::span<const SceneLine> lines);

/// Checks a line against the table. Throws InvalidInput with a sentence that names the word.
SceneCall bind_command(std::span<const SceneWord> words, const SceneState& state,
                       const SceneSettings& settings, const Context& ctx);

/// The same for a command that need not be in the table; `words` are those after its name. All arguments
/// except `words` must outlive the call.
SceneCall bind_command(const SceneCommand& command, std::span<const SceneWord> words, const SceneState& state,
                       const SceneSettings& settings, const Context& ctx);

}  // namespace coppice
