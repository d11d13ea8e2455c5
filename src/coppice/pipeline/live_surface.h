#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/mesh_options.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// The range of numbers first .. first + count - 1.
struct NumberRange {
    std::uint32_t first = 0;                                                   ///< smallest number
    std::uint32_t count = 0;                                                   ///< number of numbers
    friend bool operator==(const NumberRange&, const NumberRange&) = default;  ///< memberwise
};

/// The ranges that an update of a LiveSurface wrote: everything that a copy of the buffers, as in a GPU, has
/// to fetch.
struct SurfaceChange {
    bool is_whole = false;              ///< whether everything changed; then the ranges cover all buffers
    std::vector<NumberRange> vertices;  ///< ranges of positions(), ascending, disjoint
    std::vector<NumberRange> quads;     ///< ranges of quads(), ascending, disjoint
    std::uint32_t meshed = 0;           ///< number of nodes of the rebuilt part of the tree
};

/// The surface of quads of a tree that is being edited. The cost of an update depends on the size of the
/// edit: the surface of the surrounding part of the tree is rebuilt, with a margin that contains everything
/// that its middle depends on, and replaces the previous surface there. The result is bit-identical to a
/// complete rebuild: the reach of an edit is detected where the surface no longer changes; if it does not end
/// within the part, a larger part is used, and finally the whole tree.
///
/// Patches of the surface keep their vertices and quads in fixed ranges while others change, so that little
/// data has to be sent to the renderer. Free ranges contain quads of four equal corners.
///
/// The supported methods are quads and bmesh, with local weights, the same number of quads around all
/// branches, and fit `surface`: with fit `volume` or global weights, the result at one location depends on
/// all others.
class LiveSurface {
  public:
    /// Builds the whole surface. Throws the exceptions of mesh_skeleton(), and InvalidInput naming `method`,
    /// `weights` or `fit` if they are not supported.
    LiveSurface(const Skeleton& tree, const MeshOptions& options, const Context& ctx = {});
    ~LiveSurface();
    LiveSurface(LiveSurface&&) noexcept;             ///< leaves the source empty
    LiveSurface& operator=(LiveSurface&&) noexcept;  ///< leaves the source empty

    /// Updates the surface after an edit. `changed` contains the stable ids of all nodes that were added,
    /// removed, moved, resized or given another parent since the last update. Throws the exceptions of the
    /// constructor; the surface is then unchanged, and the next update has to include the ids of this one.
    /// O(n) with a small constant to find the affected nodes, otherwise as described above.
    SurfaceChange update(const Skeleton& now, std::span<const StableId> changed, const Context& ctx = {});

    std::span<const Vec3> positions() const;  ///< [m] relative to origin()
    std::span<const Quad> quads() const;      ///< including free ranges
    Vec3d origin() const;                     ///< [m] origin of the tree

    /// Returns the surface without free ranges, tube by tube by stable id: bit-identical for equal trees,
    /// independent of the sequence of edits. Vertices and quads are those of mesh_skeleton(), in another
    /// order. O(n).
    QuadMesh mesh() const;

  private:
    class State;
    std::unique_ptr<State> state_;
};

}  // namespace coppice
