#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/base/quote.h"
#include "coppice/edit/selection.h"
#include "coppice/scene/commands/tables_internal.h"

namespace coppice::table {

// Shared code of commands that edit a tree.

/// [bytes] of the edited tree, the original one, and the result
inline constexpr double kBytesOfEditedNode = 200;

inline Argument selection(std::string name, std::string help, std::string initial = {}) {
    Argument a{.name = std::move(name), .help = std::move(help), .type = ArgumentType::selection};
    a.positional = true;
    a.required = initial.empty();
    a.initial = std::move(initial);
    return a;
}

inline Argument flag(std::string name, bool initial, std::string help) {
    Argument a{.name = std::move(name), .help = std::move(help), .type = ArgumentType::flag};
    a.initial = initial ? "true" : "false";
    return a;
}

inline SolidLookup find_solids(const SceneCall& call) {
    return [&call](const std::string& name) -> const Solid* {
        const auto found = call.state().objects.find({ObjectKind::solid, name});
        return found == call.state().objects.end() ? nullptr : &std::get<Solid>(found->second->value);
    };
}

inline NodeSet find_nodes(const SceneCall& call, const EditableTree& tree,
                          std::string_view argument = "nodes") {
    const std::string& text = call.text(argument);
    NodeSet nodes = selected(tree, parse_selection(text), find_solids(call));
    if (nodes.empty()) {
        throw InvalidInput(fmt::format("{} contains no node of the tree; try other bounds with: select {}",
                                       quote(text), shortened(text)));
    }
    return nodes;
}

inline StableId find_node(const SceneCall& call, const EditableTree& tree, std::string_view argument) {
    return selected_node(tree, parse_selection(call.text(argument)), find_solids(call));
}

}  // namespace coppice::table
