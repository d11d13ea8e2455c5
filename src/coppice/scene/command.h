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
#include "coppice/io/jail.h"
#include "coppice/scene/argument.h"
#include "coppice/scene/object.h"

namespace coppice {

/// What a scene may do and take.
struct SceneSettings {
    int max_memory = 4096;  ///< [MiB] of all objects and what is being made; more is refused beforehand
    bool files = true;      ///< whether files may be read and written
    bool outputs = true;    ///< whether save and render write; if not, they only check
    std::filesystem::path folder = {};  ///< where files to read are looked for; empty: the current one
    int seed = 0;                       ///< of commands that are given none, until set seed gives another
    std::map<std::string, std::string> variables = {};  ///< as typed, instead of what their first let says
    /// Where given, files are read and written within it alone, by names relative to its folder, and `folder`
    /// does not matter; what commands keep of files stays as it was typed.
    std::shared_ptr<const Jail> jail = {};
    int most_lines = 100'000;  ///< that one block of loops may run, counted as often as they run
    GrowthWatch watch = {};    ///< told of what `grow` and `sprout` have so far, or none
};

/// The objects of a scene by kind and name.
using SceneObjects = std::map<std::pair<ObjectKind, std::string>, ObjectPtr>;

/// All that a scene holds between two commands.
struct SceneState {
    SceneObjects objects;              ///< what names stand for now
    std::vector<std::string> history;  ///< commands that made them, with every option spelled out
    std::string last_grown;            ///< name of the skeleton that was grown last
    std::vector<std::pair<ObjectKind, std::string>> made;  ///< in the order of making, the last one last
    int seed = 0;                                          ///< of commands that are given none
    std::uint64_t bytes = 0;                               ///< of the objects, about
};

struct SceneCommand;

/// A command with its arguments, checked against the table; what was left out has its default. Objects that
/// are named exist.
class SceneCall {
  public:
    /// A call without values: see bind_command. The arguments must outlive it.
    SceneCall(const SceneCommand& command, const SceneState& state, const SceneSettings& settings,
              const Context& ctx);

    const SceneCommand& command() const { return command_; }     ///< the row of the table
    const SceneState& state() const { return state_; }           ///< of the scene before the call
    const SceneSettings& settings() const { return settings_; }  ///< of the scene
    const Context& context() const { return ctx_; }              ///< for the library's functions
    std::string typed() const;                                   ///< the whole line, every option spelled out

    /// All values of an argument; none where it was left out and has no default.
    std::span<const ArgumentValue> values(std::string_view name) const;
    bool has(std::string_view name) const { return !values(name).empty(); }  ///< whether it has a value
    const std::string& text(std::string_view name) const;  ///< of the first value, which must exist
    double number(std::string_view name) const;            ///< in the library's unit
    bool flag(std::string_view name) const { return text(name) == "true"; }  ///< whether it is "true"
    Vec3 point(std::string_view name) const;                                 ///< of a tuple of three numbers
    std::vector<Vec3> points(std::string_view name) const;                   ///< one for every value

    /// The object that an argument's text names; it must exist.
    const Solid& solid(const std::string& name) const { return get<Solid>(ObjectKind::solid, name); }
    /// Of a solid, in coordinates that begin at `origin`; throws as `reserve` does.
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
    /// The numbers that the nodes of a skeleton have beside their radii.
    std::span<const NodeAttribute> attributes(const std::string& name) const {
        return state_.objects.at({ObjectKind::skeleton, name})->attributes;
    }
    /// As solid().
    const Surface& surface(const std::string& name) const { return get<Surface>(ObjectKind::mesh, name); }
    /// The object that is meant by a name of any kind, or of the kind called `kind` where that is not empty.
    /// Throws InvalidInput when there is none or several.
    ObjectPtr any(const std::string& name, const std::string& kind) const;

    /// An option struct whose members are arguments: "grow" for those with fields "grow.step" and so on.
    template <class Options>
    Options options(const std::string& path, Options out = {}) const {
        visit_members(out, path, [&](const std::string& at, const Field&, auto& value) {
            if (const Argument* a = by_field(at)) read(*a, value);
        });
        return out;
    }

    /// Throws InvalidInput when `bytes` more would be beyond the limit of memory.
    void reserve(double bytes) const;
    double memory_left() const;  ///< bytes until then; >= 0
    /// Where a file to read lies; throws IoError where files are forbidden, or this one by the jail.
    std::filesystem::path input(std::string_view name) const;
    /// Where a file may be written; throws IoError where files are forbidden, or this one by the jail, or its
    /// folder does not exist.
    std::filesystem::path output(std::string_view name) const;
    /// Where files named within files are to lie; null where they may lie anywhere.
    const Jail* jail() const { return settings_.jail.get(); }

    void set(const Argument& argument, std::vector<ArgumentValue> values);  ///< what parsing found
    void unset(const Argument& argument) { values_.erase(argument.name); }  ///< as if it were not given

  private:
    template <class T>
    const T& get(ObjectKind kind, const std::string& name) const {
        return std::get<T>(state_.objects.at({kind, name})->value);
    }
    template <class T>
    void read(const Argument& a, T& value) const {
        if (!has(a.name)) return;
        if constexpr (std::is_same_v<T, bool>) {
            value = flag(a.name);
        } else if constexpr (std::is_same_v<T, std::vector<std::string>>) {
            for (const ArgumentValue& v : values(a.name)) value.push_back(v.text);
        } else if constexpr (std::is_same_v<T, std::optional<Vec3d>>) {
            const std::vector<double>& n = values(a.name).front().numbers;
            value = Vec3d(n.at(0), n.at(1), n.at(2));
        } else if constexpr (NamedEnum<T>) {
            const auto found = std::ranges::find(EnumNames<T>::names, text(a.name));
            value = static_cast<T>(found - EnumNames<T>::names.begin());
        } else {
            value = static_cast<T>(number(a.name));
        }
    }
    const Argument* by_field(const std::string& field) const;

    const SceneCommand& command_;
    const SceneState& state_;
    const SceneSettings& settings_;
    const Context& ctx_;
    std::map<std::string, std::vector<ArgumentValue>, std::less<>> values_;
};

/// What a command does to a scene: nothing of it happens when the command fails.
struct SceneOutcome {
    /// An object that comes, or goes.
    struct Change {
        ObjectKind kind;   ///< of the object
        std::string name;  ///< of the object
        ObjectPtr object;  ///< none: it goes
    };
    std::vector<Change> changes;  ///< in order
    std::string text;             ///< what the command has to say
    std::string grown;            ///< name of a skeleton that was grown, or nothing
    std::optional<int> seed;      ///< from now on, for commands that are given none
    int undo = 0;                 ///< commands to take back
};

/// A row of the table: all that parsing, help and the reference page know of a command.
struct SceneCommand {
    std::string name;                  ///< "sphere", "pointset thin"
    std::vector<std::string> aliases;  ///< other names
    std::string group;                 ///< heading on the reference page
    std::string help;                  ///< one sentence without a full stop
    std::string example;  ///< a line that works after those in the examples of the commands before it
    std::vector<Argument> arguments;  ///< positional ones first
    bool records = true;              ///< whether it makes or changes objects: a recipe keeps it
    std::optional<ObjectKind> makes;  ///< the kind of what it makes, where that is always the same
    std::function<SceneOutcome(const SceneCall&)> run;  ///< does the work; throws what the library throws
    /// Of commands that edit a tree, which `run` takes from the scene and gives back: the same on a tree that
    /// is kept.
    std::function<EditChange(const SceneCall&, EditableTree&)> edit;
    std::function<std::string(const SceneCall&, const EditableTree&)>
        show;  ///< of those that only look at it
};

/// The one table of all commands, in the order of the reference page.
std::span<const SceneCommand> scene_commands();

/// The command that the first one or two words name; `used` says how many. Throws InvalidInput with the
/// nearest spelling.
const SceneCommand& find_command(std::span<const SceneWord> words, std::size_t& used);

/// The commands that the lines of a scene name, those in blocks too; none where a line is not understood:
/// running it says why.
std::optional<std::vector<const SceneCommand*>> commands_of(std::span<const SceneLine> lines);

/// Checks a line against the table. Throws InvalidInput, one sentence that names the word.
SceneCall bind_command(std::span<const SceneWord> words, const SceneState& state,
                       const SceneSettings& settings, const Context& ctx);

/// The same of a command that need not be in the table; `words` are those behind its name. All but these
/// must outlive the call.
SceneCall bind_command(const SceneCommand& command, std::span<const SceneWord> words, const SceneState& state,
                       const SceneSettings& settings, const Context& ctx);

}  // namespace coppice
