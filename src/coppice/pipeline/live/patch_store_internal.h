#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/live/patches_internal.h"
#include "coppice/pipeline/live_surface.h"

namespace coppice::pipeline_internal {

/// A surface of a part of a tree, taken apart, and which of its nodes are to be looked at.
struct TracedPart {
    const Skeleton& part;
    const SurfacePatches& patches;
    std::span<const std::uint8_t> wanted;   ///< per node of the part
    std::span<const std::uint8_t> trusted;  ///< per node of the part: whether its surface is right
    bool is_wanted(NodeId n) const { return wanted[n.index()] != 0; }
    bool is_trusted(NodeId n) const { return trusted[n.index()] != 0; }
};

/// What a merge came to.
struct Merged {
    std::optional<SurfaceChange> change;  ///< none: nothing was done, since pieces reach beyond
    std::vector<StableId> missing;        ///< the nodes beyond, as far as they are in the part
};

/// Ranges of one array, of which some are free.
class FreeRanges {
  public:
    /// A free range of this length, else one behind all others, which makes the array longer.
    std::uint32_t take(std::uint32_t count);
    void give(NumberRange range);
    std::uint32_t end() const { return end_; }    ///< of the last range
    std::uint32_t free() const { return free_; }  ///< numbers in free ranges

  private:
    std::map<std::uint32_t, std::vector<std::uint32_t>> by_count_;
    std::uint32_t end_ = 0, free_ = 0;
};

/// The patches of a surface, by the stable ids of the nodes whose tubes they are about, in arrays in which
/// each keeps its place.
class PatchStore {
  public:
    /// Whether the tubes of a node of the part have other vertices than those that are stored.
    bool differs(const TracedPart& traced, NodeId n) const;

    /// Puts the patches of a part that are wanted in the place of those that are there under the same names,
    /// and takes away those of nodes that are gone.
    Merged merge(const TracedPart& traced, std::span<const StableId> removed);

    std::span<const Vec3> positions() const { return positions_; }
    std::span<const Quad> quads() const { return quads_; }
    /// Calls visit(nodes, needs) for every piece that a node's segment is needed for: the nodes whose tubes
    /// it replaces, and all that it was made of.
    template <class Visit>
    void visit_pieces(StableId node, const Visit& visit) const {
        for (const std::uint32_t piece : row(pieces_of_, node))
            visit(std::span<const StableId>(patches_[piece].nodes),
                  std::span<const StableId>(patches_[piece].needs));
    }
    bool is_sparse() const;  ///< whether more is free than used
    QuadMesh compact() const;

  private:
    static constexpr std::uint32_t kNone = 0xffffffffu;
    struct Patch {
        NumberRange vertices, quads;
        std::vector<StableId> nodes;  ///< of a tube: the one that it is about; of a piece: see SurfacePatches
        std::vector<StableId> needs;  ///< of a piece; empty for a tube
    };
    /// What a merge will do.
    struct Plan {
        std::vector<std::uint32_t> kept;      ///< per traced patch: the stored one of the same name, or none
        std::vector<std::uint8_t> is_new;     ///< per traced patch: whether it has to be written
        std::vector<std::uint32_t> removed;   ///< stored ones
        std::vector<std::uint8_t> is_wanted;  ///< per node of the part
        std::vector<StableId> missing;        ///< see Merged; empty: it can be done
    };

    Plan plan(const TracedPart& traced, std::span<const StableId> removed) const;
    void widen(const TracedPart& traced, Plan& plan) const;
    void plan_tubes(const TracedPart& traced, Plan& plan) const;
    void plan_pieces(const TracedPart& traced, std::span<const StableId> removed, Plan& plan) const;
    std::uint32_t stored_tube(StableId node, std::uint32_t place) const;
    bool is_same(const TracedPart& traced, const Plan& plan, std::uint32_t traced_patch,
                 std::uint32_t stored) const;
    std::uint32_t slot(const TracedPart& traced, const Plan& plan, std::uint32_t vertex) const;
    void find_moves_under_others(const TracedPart& traced, Plan& plan) const;
    void remove(std::uint32_t patch, SurfaceChange& change);
    void place(const TracedPart& traced, Plan& plan, std::uint32_t traced_patch, SurfaceChange& change);
    void write_quads(const TracedPart& traced, const Plan& plan, std::uint32_t traced_patch,
                     SurfaceChange& change);
    std::uint32_t add_patch();
    std::vector<std::uint32_t>& row(std::vector<std::vector<std::uint32_t>>& rows, StableId node);
    std::span<const std::uint32_t> row(const std::vector<std::vector<std::uint32_t>>& rows,
                                       StableId node) const;

    std::vector<Vec3> positions_;
    std::vector<Quad> quads_;
    FreeRanges free_vertices_, free_quads_;
    std::vector<Patch> patches_;
    std::vector<std::uint32_t> free_patches_;
    std::vector<std::vector<std::uint32_t>> tubes_of_;   ///< per stable id, by place
    std::vector<std::vector<std::uint32_t>> pieces_of_;  ///< per stable id: those that need it
};

}  // namespace coppice::pipeline_internal
