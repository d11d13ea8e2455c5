#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Numbers first .. first + count - 1.
struct NumberRange {
    std::uint32_t first = 0;                                                   ///< the least
    std::uint32_t count = 0;                                                   ///< how many
    friend bool operator==(const NumberRange&, const NumberRange&) = default;  ///< the same numbers
};

/// What an update of a LiveSurface wrote: all that a copy elsewhere, as in a graphics card, has to fetch.
struct SurfaceChange {
    bool is_whole = false;              ///< everything; then the ranges are all there is
    std::vector<NumberRange> vertices;  ///< of positions(), ascending, apart
    std::vector<NumberRange> quads;     ///< of quads(), ascending, apart
    std::uint32_t meshed = 0;           ///< nodes of the part of the tree of which a surface was made
};

/// The surface of quads of a tree that is being edited. An update costs what the edit touches: the surface of
/// the part of the tree about it is made anew, with all that its middle depends on around it, and put in
/// the place of what was there. It has the same bits as if the whole had been made: how far an edit reaches
/// is seen where nothing changes any more, and where that is not so, a larger part is taken, and the whole at
/// last.
///
/// Patches of the surface keep their vertices and quads in fixed ranges while others change, so that little
/// has to be sent to where it is drawn. Ranges that are free hold quads of four equal corners.
///
/// The methods are quads and bmesh, with local weights and as many quads around all branches, fitted to the
/// surface: what `fit` volume and global weights do to one place depends on all others.
class LiveSurface {
  public:
    /// Makes the whole surface. Throws what mesh_skeleton() throws, and InvalidInput naming `method`,
    /// `weights` or `fit` where they are others.
    LiveSurface(const Skeleton& tree, const MeshOptions& options, const Context& ctx = {});
    ~LiveSurface();
    LiveSurface(LiveSurface&&) noexcept;             ///< leaves nothing
    LiveSurface& operator=(LiveSurface&&) noexcept;  ///< leaves nothing

    /// Follows an edit. `changed` has the stable ids of all nodes that were added, removed, moved, resized or
    /// given another parent since the last update. Throws what the constructor throws; then the surface is as
    /// it was, and the next update has to name what this one did. O(n) with a small constant for finding what
    /// is near, else as above.
    SurfaceChange update(const Skeleton& now, std::span<const StableId> changed, const Context& ctx = {});

    std::span<const Vec3> positions() const;  ///< [m] relative to origin()
    std::span<const Quad> quads() const;      ///< with free ranges
    Vec3d origin() const;                     ///< [m] that of the tree

    /// The surface without free ranges, tube by tube by stable id: the same bits for the same tree, whatever
    /// edits led there. Vertices and quads are those of mesh_skeleton(), in another order. O(n).
    QuadMesh mesh() const;

  private:
    class State;
    std::unique_ptr<State> state_;
};

}  // namespace coppice
