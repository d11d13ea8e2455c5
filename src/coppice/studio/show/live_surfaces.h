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

/// The stable ids of all nodes that one tree has and the other one has not, or has otherwise: position,
/// radius or parent. Ascending. O(n).
std::vector<StableId> changed_nodes(const Skeleton& before, const Skeleton& after);

/// The surfaces of skeletons that are looked at. Each follows its skeleton from one state to another, be it a
/// preview, an edit or one that is taken back, by what differs between the two. Its states are numbered, so
/// that a client which has one of them can be sent what changed since.
class LiveSurfaces {
  public:
    /// One of them.
    struct Shown {
        std::string name;                                             ///< of the skeleton
        MeshOptions options;                                          ///< how it is made
        std::string wish;                                             ///< the options as they were asked for
        ObjectPtr object;                                             ///< the skeleton that it shows
        LiveSurface surface;                                          ///< of it
        std::uint64_t number;                                         ///< of this state
        std::deque<std::pair<std::uint64_t, SurfaceChange>> changes;  ///< with the state before each
    };

    /// Keeps up to so many bytes of them, by estimate.
    explicit LiveSurfaces(std::uint64_t most_bytes = std::uint64_t{1} << 30) : most_bytes_(most_bytes) {}

    /// The surface of a skeleton as it is now. `wish` tells options apart. Throws what LiveSurface throws;
    /// then what was shown stays as it was. Throws InvalidInput for one that would take too much memory. The
    /// four that were used last are kept, as far as there is room.
    Shown& follow(const std::string& name, const ObjectPtr& object, const MeshOptions& options,
                  const std::string& wish, const Context& ctx);

    /// All that changed since the state of that number; none where that is not known or everything did.
    static std::optional<SurfaceChange> since(const Shown& shown, std::uint64_t number);

    std::uint64_t bytes() const;                        ///< of all that are kept, about
    std::size_t size() const { return shown_.size(); }  ///< number of them

  private:
    void make_room(std::uint64_t bytes, std::size_t most);

    std::uint64_t most_bytes_;
    std::list<Shown> shown_;  ///< the one used last in front
    std::uint64_t number_ = 0;
};

}  // namespace coppice
