#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// What smoothing did to quads that cross.
struct SmoothCrossingsReport {
    std::uint64_t pairs_before = 0;   ///< of quads that crossed
    std::uint64_t pairs_after = 0;    ///< of quads that still do
    std::uint32_t rounds = 0;         ///< of smoothing and looking again
    std::vector<std::uint32_t> left;  ///< quads that still cross others, ascending
};

/// Smooths a closed mesh about quads that cross or touch, until none do: between the vertices that stay it
/// becomes a soap film, which parts folds and tubes that press on each other, at the price of radius there;
/// tubes that are linked it cannot part. Each of at most 60 rounds moves the vertices of such quads and their
/// neighbours, farther out the more often quads there have crossed. The state with the fewest pairs is kept.
/// Corners of `fixed` quads stay. A clean mesh keeps its bits.
///
/// O(n log n) to look at all quads, and in each round O(n) and what the quads that cross cost. The same bits
/// for any number of threads.
SmoothCrossingsReport smooth_crossings(QuadMesh& mesh, std::span<const std::uint32_t> fixed = {},
                                       const Context& ctx = {});

}  // namespace coppice
