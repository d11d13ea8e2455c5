#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "coppice/animate/pose.h"
#include "coppice/base/context.h"
#include "coppice/scene/command.h"

namespace coppice {

/// A motion of a tree by keys: edits of the tree at rest, and moments at which they are made in full. One key
/// a line,
///
///     0: rest
///     1.5 out: rotate near(2,0,3) 30; bend 19 20
///     3: rest
///
/// seconds, how the motion to the key runs (see Easing; smooth where nothing is said), and edits as for
/// `coppice edit`, or `rest`. Between two keys the edits of the one fade while those of the other come, by
/// their angles, ways and factors, so that branches turn and do not shrink; edits of other kinds fade by the
/// places of the nodes. Before the first key the tree rises from rest, at second 0.
///
/// Selections are looked up in the tree at rest. Edits have to keep the nodes and what they hang on.
class Keyframes {
  public:
    /// Throws InvalidInput that begins with source and line: times that do not rise, an easing that is
    /// unknown, what the edits throw, edits that add or remove nodes, no keys.
    Keyframes(const Skeleton& tree, std::string_view text, const std::string& source,
              const SceneSettings& settings = {}, const Context& ctx = {});
    ~Keyframes();                                ///< gives its memory back
    Keyframes(Keyframes&&) noexcept;             ///< takes over
    Keyframes& operator=(Keyframes&&) noexcept;  ///< takes over

    double end() const;          ///< [s] of the last key
    std::size_t size() const;    ///< number of keys
    Pose at(double time) const;  ///< the pose at a time [s]; O(n) for each edit that is on its way

  private:
    class Body;
    std::unique_ptr<Body> body_;
};

}  // namespace coppice
