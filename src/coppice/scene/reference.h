#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/scene/command.h"

namespace coppice {

/// All commands by group, a line each.
std::string help_overview();

/// What the words name: a command with its arguments, or all commands of a family ("pointset"). Throws
/// InvalidInput with the nearest spelling.
std::string help_of(std::span<const SceneWord> words);

/// The reference page of all commands in Markdown, docs/user/scene-reference.md, or of one group of them.
std::string scene_reference(std::string_view group = {});

/// The table as JSON: commands with their arguments, types, units, ranges and defaults.
Json scene_schema();

/// What the last word of an unfinished line may become, in order: commands, option names with "=", choices,
/// names of objects. Words are whole: "crown", "pattern=jittered".
std::vector<std::string> completions(std::string_view line, const SceneState& state);

/// NAME, [NAME], NAME... as the first words of a command are written.
std::string usage_of(const SceneCommand& command);

}  // namespace coppice
