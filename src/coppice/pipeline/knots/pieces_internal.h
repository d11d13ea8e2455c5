#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/number_set.h"
#include "coppice/pipeline/knots/knot_patch_internal.h"
#include "coppice/pipeline/knots/knots_internal.h"

namespace coppice::pipeline_internal {

/// What stands in the place of one group.
struct Piece {
    KnotSurface surface;
    KnotQuads quads;
    bool is_current = false;  ///< whether `quads` are as careful as asked
};

/// The pieces of all groups.
class Pieces {
  public:
    /// All must outlive this. O(n).
    Pieces(const TubeMap& map, const Slices& slices, const QuadMesh& mesh, const MeshOptions& options,
           const Context& ctx);

    /// Makes a piece for every group of what goes, with as much care as is asked for per slice. Takes more
    /// until each group has a piece that fits, and gives back those for which none does. What has been made
    /// for a group is used again as far as it reaches.
    void make(Knots& knots, std::span<const Care> care);

    /// Whether a piece could be about so many segments.
    bool can_hold(std::span<const Segment> segments) const;

    std::size_t size() const { return pieces_.size(); }                   ///< number of pieces
    Piece& operator[](std::size_t i) { return *pieces_[i]; }              ///< one of them
    const Piece& operator[](std::size_t i) const { return *pieces_[i]; }  ///< one of them

  private:
    static constexpr std::uint32_t kNobody = 0xffffffffu;

    void follow(std::vector<KnotGroup> groups);
    std::shared_ptr<const Marched> made_for(const KnotGroup& group) const;
    bool grow_to_fit(Knots& knots, int attempt) const;

    const QuadMesh& mesh_;
    const MeshOptions options_;
    const Context& ctx_;
    KnotSkeletons skeletons_;
    std::vector<std::unique_ptr<Piece>> pieces_;
    std::vector<std::uint32_t> owner_;  // per slice: the piece that replaces it
};

/// Puts the pieces into the mesh: quads and vertices that stay first, in their order. Returns the vertices
/// that went. O(n).
NumberSet put_into(QuadMesh& mesh, const Slices& slices, const Knots& knots, const Pieces& pieces,
                   const Context& ctx);

/// The number of bodies that the mesh then has. O(slices + pieces).
std::uint32_t count_bodies(const Slices& slices, const Knots& knots, const Pieces& pieces);

}  // namespace coppice::pipeline_internal
