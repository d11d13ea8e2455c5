#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/scene/scene.h"

namespace coppice {

/// A section of the text of a scene that can run separately: a line with its continuation lines, a block, an
/// empty line or a comment.
struct SceneSection {
    std::uint32_t line = 0;  ///< number of its first line in the text, from 1
    std::string text;        ///< as in the text, without the last line end
};

/// Splits the text into sections: joined by line ends they are the original text. Errors are reported by
/// running a section. O(n).
std::vector<SceneSection> find_sections(std::string_view text);

/// Runs a section in the scene and returns the output of its lines. `line` is the number of its first line,
/// and `source` names the text in messages. Throws as Scene::run does, and InvalidInput for a block that is
/// not closed; the effects of a block before the error remain.
std::string run_section(Scene& scene, std::string_view text, std::uint32_t line, const std::string& source,
                        const Context& ctx = {});

}  // namespace coppice
