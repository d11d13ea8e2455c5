#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/extract/points/gaps_internal.h"
#include "coppice/extract/points/graph_internal.h"

namespace coppice::extract_internal {

struct LeafOptions {
    bool always = false;        ///< take some for leaves even where the cloud shows none
    GapRule gap = {};           ///< that paths cross
    std::optional<Vec3d> root;  ///< [m] where the one tree stands; else as find_roots() says
};

/// Marks the points of leaves (1), told from wood by coordinates alone; none where the cloud shows none.
///
/// Normals of wood lie in a plane, those of leaves point everywhere: `NormalDispersion`. It is measured at
/// scales from the points themselves on, each twice as coarse, up to a spacing of 10 cm or 2.5 % of the
/// height. Leaves show where a quarter of the places has a high dispersion, the mean above the threshold is
/// high, both hold at the next scale too, and the mean below it is low: noise differs in one of the last two.
///
/// Points above the threshold there are leaves, unless shortest paths from the roots lead through or beside
/// them to what lies ten spacings beyond: that is wood amid leaves, as in [Vicari2019]. Beside means within
/// 1/35 of the length of what lies beyond, since branches are at least about so thick. Last, pieces of wood
/// shorter than ten spacings become leaves.
///
/// `ignored` are points that count for nothing, and are not marked. O(n log n); about 300 bytes per point
/// while it runs; the same bits for any number of threads. Throws Cancelled.
std::vector<std::uint8_t> find_leaves(std::span<const Vec3> points, const Neighbours& near,
                                      std::span<const std::uint8_t> ignored, const LeafOptions& options,
                                      const Context& ctx);

}  // namespace coppice::extract_internal
