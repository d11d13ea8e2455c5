#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/tetra/lattice/refinement.h"
#include "coppice/tetra/march/march.h"
#include "coppice/tetra/march/ranked_bits_internal.h"

namespace coppice::tetra_internal {

/// A fine vertex that holds an axis together: a corner of `tetra`, the fine vertex `local` there.
struct HeldVertex {
    std::uint32_t vertex;
    std::uint32_t segment;  ///< of those it holds, the nearest
    std::uint32_t tetra;
    TetraPattern::Local local;
};

/// The fine vertices that hold axes together: those that have the greatest of the four weights
/// (barycentric coordinates) at some point of an axis.
///
/// Vertices that hold one axis are joined by fine edges, also where axes meet: the points at which a vertex
/// has the greatest weight are a closed set, and these sets cover space; where two of them meet, both
/// vertices have a weight in one point, so they are corners of one tetrahedron; and an axis, which is
/// connected, is not the union of two closed parts that do not meet. So what is inside about them is one
/// body, whatever the field says and wherever the other vertices are.
struct HeldVertices {
    RankedBits bits;
    std::vector<HeldVertex> list;  ///< ascending
    /// Places in `list`: one for each set of segments that they join.
    std::vector<std::uint32_t> of_each_set;
};

/// O(regions + meetings of axes with coarse tetrahedra).
HeldVertices hold_axes(const TetraRefinement& refinement, const InsideAxes& axes, const Context& ctx);

}  // namespace coppice::tetra_internal
