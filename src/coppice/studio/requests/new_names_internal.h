#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "coppice/scene/scene.h"

namespace coppice::studio_internal {

/// A line in which the names of new objects were chosen.
struct NamedLine {
    std::string line;
    std::vector<std::string> names;  ///< that were chosen, each once, in the order of the line
};

/// Replaces each `${new NAME}` of a line by NAME where no object has it, else by the first of NAME2, NAME3,
/// ... that is free, counted on from digits at the end of NAME. The engine chooses when the line runs, so
/// that lines that were sent at once, or by several pages, never take the same name.
NamedLine with_new_names(std::string_view line, const SceneObjects& objects);

}  // namespace coppice::studio_internal
