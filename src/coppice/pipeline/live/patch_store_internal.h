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

/// A surface of a part of a tree, divided into patches, and the nodes to check.
struct TracedPortion {
    const Skeleton& part;
    const SurfacePatches& patches;
    std::span<const std::uint8_t> wanted;   ///< per node of the part
    std::span<const std::uint8_t> trusted;  ///< per node of the part: whether its surface is correct
    bool is_wanted(NodeId n) const { return wanted[n.index()] != 0; }
    bool is_trusted(NodeId n) const { return trusted[n.index()] != 0; }
};

/// Result of a merge.
struct Merged {
    std::optional<SurfaceChange> change;  ///< nullopt: no change, because patches extend beyond the part
    std::vector<StableId> missing;        ///< the nodes beyond, if they are in the part
};

/// Ranges of one array, of which some are free.
class FreeRanges {
  public:
    /// Returns a free range of this length; if there is none, one after all others, which extends the array.
    std::uint32_t take(std::uint32_t count);
    void give(NumberRange range);
    std::uint32_t end() const { return end_; }    ///< of the last range
    std::uint32_t free() const { return free_; }  ///< numbers in free ranges

  private:
    std::map<std::uint32_t, std::vector<std::uint32_t>> by_count_;
    std::uint32_t end_ = 0, free_ = 0;
};

/// The patches of a surface, by the stable ids of the nodes of their tubes, in arrays in which each keeps its
/// position.
class PatchStore {
  public:
    /// Returns whether the vertices of the tubes of a node of the part differ from the stored ones.
    bool differs(const TracedPortion& traced, NodeId n) const;

    /// Replaces the stored patches by those of a part that are to be checked and have the same names, and
    /// removes those of removed nodes.
    Merged merge(const TracedPortion& traced, std::span<const StableId> removed);

    std::span<const Vec3> positions() const { return positions_; }
    std::span<const Quad> quads() const { return quads_; }
    /// Calls visit(nodes, needs) for every repair patch that requires a node's segment: the nodes of the
    /// tubes that it replaces, and all nodes from which it was made.
    template <class Visit>
    void visit_pieces(StableId node, const Visit& visit) const {
        for (const std::uint32_t repair_patch : row(pieces_of_, node))
            visit(std::span<const StableId>(patches_[repair_patch].nodes),
                  std::span<const StableId>(patches_[repair_patch].needs));
    }
    bool is_sparse() const;  ///< whether more is free than used
    QuadMesh compact() const;

  private:
    struct Patch {
        NumberRange vertices, quads;
        std::vector<StableId> nodes;  ///< of a tube: its node; of a repair patch: see SurfacePatches
        std::vector<StableId> needs;  ///< of a repair patch; empty for a tube
    };
    /// The changes of a merge.
    struct Plan {
        std::vector<std::uint32_t> kept;      ///< per traced patch: the stored one of the same name, or none
        std::vector<std::uint8_t> is_new;     ///< per traced patch: whether it has to be written
        std::vector<std::uint32_t> removed;   ///< stored patches
        std::vector<std::uint8_t> is_wanted;  ///< per node of the part
        std::vector<StableId> missing;        ///< see Merged; empty: the merge is possible
    };

    Plan plan(const TracedPortion& traced, std::span<const StableId> removed) const;
    void widen(const TracedPortion& traced, Plan& plan) const;
    void plan_tubes(const TracedPortion& traced, Plan& plan) const;
    void plan_pieces(const TracedPortion& traced, std::span<const StableId> removed, Plan& plan) const;
    std::uint32_t stored_tube(StableId node, std::uint32_t place) const;
    bool is_same(const TracedPortion& traced, const Plan& plan, std::uint32_t traced_patch,
                 std::uint32_t stored) const;
    std::uint32_t slot(const TracedPortion& traced, const Plan& plan, std::uint32_t vertex) const;
    void find_moves_under_others(const TracedPortion& traced, Plan& plan) const;
    void remove(std::uint32_t patch, SurfaceChange& change);
    void place(const TracedPortion& traced, Plan& plan, std::uint32_t traced_patch, SurfaceChange& change);
    void write_quads(const TracedPortion& traced, const Plan& plan, std::uint32_t traced_patch,
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
    std::vector<std::vector<std::uint32_t>> tubes_of_;   ///< per stable id, by index
    std::vector<std::vector<std::uint32_t>> pieces_of_;  ///< per stable id: patches that require it
};

}  // namespace coppice::pipeline_internal
