#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/edit/animate/pose.h"
#include "coppice/scene/command.h"

namespace coppice {

/// A motion of a tree by keys: edits of the tree at rest, and the times at which they are complete. One key
/// per line,
///
///     0: rest
///     1.5 out: rotate near(2,0,3) 30; bend 19 20
///     3: rest
///
/// consists of seconds, the easing of the motion to the key (see Easing; smooth by default), and edits as for
/// `coppice edit`, or `rest`. Between two keys, the edits of the first fade out while those of the second
/// fade in, by their angles, displacements and factors, so that branches rotate without shrinking; edits of
/// other kinds are interpolated by the positions of the nodes. Before the first key, the tree starts at rest
/// at second 0.
///
/// Selections are evaluated in the tree at rest. Edits must keep the nodes and their parents.
class Keyframes {
  public:
    /// Throws InvalidInput that begins with source and line, for times that do not increase, an unknown
    /// easing, errors of the edits, edits that add or remove nodes, and if there are no keys.
    Keyframes(const Skeleton& tree, std::string_view text, const std::string& source,
              const SceneSettings& settings = {}, const Context& ctx = {});
    ~Keyframes();                                ///< releases its memory
    Keyframes(Keyframes&&) noexcept;             ///< transfers ownership
    Keyframes& operator=(Keyframes&&) noexcept;  ///< transfers ownership

    double end() const;          ///< [s] time of the last key
    std::size_t size() const;    ///< number of keys
    Pose at(double time) const;  ///< pose at a time [s]; O(n) for each active edit

  private:
    class Body;
    std::unique_ptr<Body> body_;
};

}  // namespace coppice
