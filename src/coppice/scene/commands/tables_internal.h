#pragma once

#include <string>
#include <utility>
#include <vector>

#include "coppice/scene/command.h"

namespace coppice {

// Sections of the command table, in order.
std::vector<SceneCommand> primitive_commands();
std::vector<SceneCommand> solid_commands();
std::vector<SceneCommand> curve_commands();
std::vector<SceneCommand> point_commands();
std::vector<SceneCommand> material_commands();
std::vector<SceneCommand> tree_commands();
std::vector<SceneCommand> compose_commands();
std::vector<SceneCommand> edit_commands();
std::vector<SceneCommand> session_commands();
SceneCommand slice_command();    ///< used by session_commands
SceneCommand extract_command();  ///< used by tree_commands
SceneCommand sketch_command();   ///< used by tree_commands
SceneCommand leaves_command();   ///< used by tree_commands

namespace table {

inline SceneCommand new_command(std::string name, std::string group, std::string help, std::string example) {
    SceneCommand c{.name = std::move(name), .group = std::move(group), .help = std::move(help)};
    c.example = std::move(example);
    return c;
}

inline Argument new_name(std::string name, std::string help, std::string initial = {}) {
    Argument a{.name = std::move(name), .help = std::move(help), .type = ArgumentType::new_name};
    a.positional = true;
    a.required = initial.empty();
    a.initial = std::move(initial);
    return a;
}

inline Argument object(std::string name, ObjectKind kind, std::string help, bool repeats = false) {
    Argument a{.name = std::move(name), .help = std::move(help), .type = ArgumentType::object};
    a.positional = a.required = true;
    a.repeats = repeats;
    a.kind = kind;
    return a;
}

inline Argument object_option(std::string name, ObjectKind kind, std::string help) {
    Argument a = object(std::move(name), kind, std::move(help));
    a.positional = a.required = false;
    return a;
}

inline Argument any_object(std::string name, std::string help, bool repeats = false) {
    Argument a = object(std::move(name), ObjectKind::solid, std::move(help), repeats);
    a.any_kind = true;
    return a;
}

inline Argument tuple(std::string name, std::string initial, std::string help,
                      std::vector<std::size_t> sizes = {3}, Unit unit = Unit::metre) {
    Argument a{.name = std::move(name), .help = std::move(help), .type = ArgumentType::tuple};
    a.initial = std::move(initial);
    a.unit = unit;
    a.sizes = std::move(sizes);
    return a;
}

inline Argument number(std::string name, std::string initial, double low, double high, Unit unit,
                       std::string help) {
    Argument a{.name = std::move(name), .help = std::move(help), .type = ArgumentType::number};
    a.initial = std::move(initial);
    a.unit = unit;
    a.low = low;
    a.high = high;
    return a;
}

inline Argument positional(Argument a, bool required = true) {
    a.positional = true;
    a.required = required;
    return a;
}

inline Argument named(Argument a) {
    a.positional = a.required = false;
    return a;
}

inline Argument repeated(Argument a) {
    a.repeats = true;
    return a;
}

inline Argument file(std::string name, ArgumentType type, std::string help) {
    Argument a{.name = std::move(name), .help = std::move(help), .type = type};
    a.positional = a.required = true;
    return a;
}

inline Argument choice_of_kind() {
    Argument a{.name = "kind",
               .help = "Kind of the object, required if several objects have the name.",
               .type = ArgumentType::choice};
    a.choices.assign(EnumNames<ObjectKind>::names.begin(), EnumNames<ObjectKind>::names.end());
    return a;
}

}  // namespace table

/// Returns the outcome of a single new or changed object.
template <class T>
SceneOutcome makes(const std::string& name, T value, std::uint64_t bytes,
                   std::vector<NodeAttribute> attributes = {}) {
    auto object =
        std::make_shared<const SceneObject>(SceneObject{std::move(value), bytes, std::move(attributes)});
    const ObjectKind kind = object->kind();
    SceneOutcome out;
    out.changes.push_back({kind, name, std::move(object)});
    return out;
}

inline SceneOutcome makes_tree(const std::string& name, Skeleton skeleton,
                               std::vector<NodeAttribute> attributes = {}) {
    const std::uint64_t bytes = compute_memory(skeleton, attributes);
    return makes(name, std::move(skeleton), bytes, std::move(attributes));
}

/// Memory of a solid in addition to its parts.
inline constexpr std::uint64_t kBytesOfSolid = 512;

inline SceneOutcome makes_solid(const std::string& name, Solid solid, std::uint64_t bytes = kBytesOfSolid) {
    return makes(name, std::move(solid), bytes);
}

}  // namespace coppice
