#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/tetra/lattice/refinement.h"
#include "coppice/tetra/march/march.h"
#include "coppice/tetra/march/ranked_bits_internal.h"

namespace coppice::tetra_internal {

/// A fine vertex that is held inside to keep an axis connected: the fine vertex `local` of `tetra`.
struct HeldVertex {
    std::uint32_t vertex;
    std::uint32_t segment;  ///< the closest of the segments that it holds
    std::uint32_t tetra;
    TetraPattern::Local local;
};

/// The fine vertices that are held inside to keep axes connected: those with the maximum of the four weights
/// (barycentric coordinates) at some point of an axis.
///
/// The vertices held for one axis are connected by fine edges, also where axes meet: the points at which a
/// vertex has the maximum weight form a closed set, and these sets cover space; where two of them meet, both
/// vertices have a positive weight at one point, so they are corners of one tetrahedron; and an axis, which
/// is connected, is not the union of two disjoint closed sets. The inside around them is therefore one body,
/// for any field and any positions of the other vertices.
struct HeldVertices {
    RankedBits bits;
    std::vector<HeldVertex> list;  ///< ascending
    /// Indices in `list`: one for each set of segments that the vertices connect.
    std::vector<std::uint32_t> of_each_set;
};

/// O(regions + intersections of axes with coarse tetrahedra).
HeldVertices hold_axes(const TetraRefinement& refinement, const InsideAxes& axes, const Context& ctx);

}  // namespace coppice::tetra_internal
