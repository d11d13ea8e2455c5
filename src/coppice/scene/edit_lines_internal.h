#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "coppice/scene/command.h"

namespace coppice::scene_internal {

/// The edit, or the command that only looks at a tree, that is written `edit NAME` in scenes; null where
/// there is none.
const SceneCommand* edit_called(const std::string& name);

/// Commands of a line: semicolons outside of quotes and comments part them.
std::vector<std::string> parted(std::string_view line);

}  // namespace coppice::scene_internal
