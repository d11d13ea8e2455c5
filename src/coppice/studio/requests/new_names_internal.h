#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "coppice/scene/scene.h"

namespace coppice::studio_internal {

/// A line with chosen names of new objects.
struct NamedLine {
    std::string line;
    std::vector<std::string> names;  ///< the chosen names, each once, in the order of the line
};

/// Replaces each `${new NAME}` of a line by NAME if no object has this name, or else by the first free name
/// of NAME2, NAME3, ..., continuing digits at the end of NAME. The engine chooses the names when the line
/// runs, so that lines sent at once, or by several pages, never get the same name.
NamedLine with_new_names(std::string_view line, const SceneObjects& objects);

}  // namespace coppice::studio_internal
