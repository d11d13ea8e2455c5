#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/options/json.h"
#include "coppice/scene/command.h"

namespace coppice {

/// Returns all commands by group, one per line.
std::string help_overview();

/// Returns the help of a command with its arguments, or of all commands of a family ("pointset"). Throws
/// InvalidInput with the closest spelling.
std::string format_help(std::span<const SceneWord> words);

/// Returns the reference page of all commands in Markdown, docs/user/scene-reference.md, or of one group.
std::string scene_reference(std::string_view group = {});

/// Returns the table as JSON: commands with their arguments, types, units, ranges and defaults.
Json scene_schema();

/// Returns the completions of the last word of an unfinished line, in order: commands, option names with "=",
/// choices, names of objects. Words are complete: "crown", "pattern=jittered".
std::vector<std::string> completions(std::string_view line, const SceneState& state);

/// Returns the syntax of the first words of a command: NAME, [NAME], NAME...
std::string format_usage(const SceneCommand& command);

}  // namespace coppice
