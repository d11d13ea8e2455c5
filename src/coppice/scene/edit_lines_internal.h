#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "coppice/scene/command.h"

namespace coppice::scene_internal {

/// Returns the command that edits or inspects a tree and is written `edit NAME` in scenes; null if there is
/// no such command.
const SceneCommand* edit_called(const std::string& name);

/// Splits a line into commands at semicolons outside of quotes and comments.
std::vector<std::string> parted(std::string_view line);

}  // namespace coppice::scene_internal
