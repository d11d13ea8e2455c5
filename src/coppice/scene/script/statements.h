#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/scene/scene.h"

namespace coppice {

/// A piece of a scene's text that runs by itself: a line with those that it goes on in, a whole block, or a
/// line that is empty or holds a comment.
struct ScenePiece {
    std::uint32_t line = 0;  ///< of its first line in the text, from 1
    std::string text;        ///< as it stands there, without the last line end
};

/// The text in pieces: joined by line ends they are the text again. What is wrong with one is said by running
/// it. O(n).
std::vector<ScenePiece> pieces_of(std::string_view text);

/// Runs a piece in the scene, which says what running its lines says. `line` is that of its first line and
/// `source` names the text in messages. Throws what Scene::run throws, and InvalidInput for a block that is
/// not closed; what a block did before stays.
std::string run_piece(Scene& scene, std::string_view text, std::uint32_t line, const std::string& source,
                      const Context& ctx = {});

}  // namespace coppice
