#pragma once

#include <cstdint>
#include <deque>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/pipeline/live_surface.h"
#include "coppice/scene/object.h"

namespace coppice {

/// Returns the stable ids of all nodes that exist in only one tree, or differ in position, radius or parent.
/// Ascending. O(n).
std::vector<StableId> changed_nodes(const Skeleton& before, const Skeleton& after);

/// The surfaces of displayed skeletons. Each follows its skeleton from state to state (a preview, an edit or
/// an undo) by updating the differences. The states are numbered, so that a client with an earlier state
/// receives only the changes since then.
class LiveSurfaces {
  public:
    /// A displayed surface.
    struct Shown {
        std::string name;          ///< of the skeleton
        MeshOptions options;       ///< options of the surface
        std::string options_text;  ///< the options as requested
        ObjectPtr object;          ///< the current skeleton
        LiveSurface surface;       ///< its surface
        std::uint64_t number;      ///< number of this state
        std::deque<std::pair<std::uint64_t, SurfaceChange>>
            changes;  ///< changes with the previous state of each
    };

    /// Limits the estimated memory of all surfaces.
    explicit LiveSurfaces(std::uint64_t max_bytes = std::uint64_t{1} << 30) : max_bytes_(max_bytes) {}

    /// Returns the current surface of a skeleton. `options_text` identifies the options. Throws as
    /// LiveSurface, or InvalidInput if the surface would exceed the memory limit; the existing surface is
    /// then unchanged. The four most recently used ones are kept, within the memory limit.
    Shown& follow(const std::string& name, const ObjectPtr& object, const MeshOptions& options,
                  const std::string& options_text, const Context& ctx);

    /// Returns all changes since a state; nullopt if the state is unknown or everything changed.
    static std::optional<SurfaceChange> since(const Shown& shown, std::uint64_t number);

    std::uint64_t bytes() const;                        ///< approximate size of all surfaces
    std::size_t size() const { return shown_.size(); }  ///< number of surfaces

  private:
    void make_room(std::uint64_t bytes, std::size_t most);

    std::uint64_t max_bytes_;
    std::list<Shown> shown_;  ///< the most recently used one first
    std::uint64_t number_ = 0;
};

}  // namespace coppice
