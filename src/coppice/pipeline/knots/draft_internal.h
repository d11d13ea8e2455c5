#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/measure/intersections.h"
#include "coppice/pipeline/knots/pieces_internal.h"
#include "coppice/pipeline/knots/tube_quads_internal.h"

namespace coppice::pipeline_internal {

/// What has to be looked at once some slices of a surface have been replaced by pieces: quads of new pieces,
/// and all that lies near them.
struct Draft {
    static constexpr std::uint32_t kNoPiece = 0xffffffffu;

    std::vector<Slice> slice;           ///< per quad: where it is, or none
    std::vector<std::uint32_t> piece;   ///< per quad: the piece it is of, or kNoPiece for one that stays
    std::vector<std::uint32_t> number;  ///< per quad: its own in the mesh or the piece
    std::vector<std::uint32_t> seam;    ///< per quad: of whose band it is, or kNoSeam
    std::uint32_t first_new = 0;        ///< quads from here on are of new pieces
    PolygonMesh quads;                  ///< of all

    std::uint32_t size() const { return static_cast<std::uint32_t>(slice.size()); }  ///< number of quads
};

/// A draft of the mesh as it will be. Costs in proportion to new pieces and what is near them, and O(tubes).
Draft draft(const TubeQuads& before, const Knots& knots, const Pieces& pieces, const Context& ctx);

/// The pairs of quads that cross or touch and of which one is new; in order, up to kMostPairs.
std::vector<FacePair> new_crossings(const Draft& draft, const Context& ctx);

}  // namespace coppice::pipeline_internal
