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
    bool always = false;  ///< classify some points as leaves even if the cloud appears to have no leaves
    GapRule gap = {};     ///< maximum widths of gaps that paths cross
    std::optional<Vec3d> root;  ///< [m] position of the only tree; by default that of find_roots()
};

/// Marks the points of leaves (1), separated from wood by coordinates alone; none if the cloud has no leaves.
///
/// Normals of wood are in a plane, those of leaves have all directions: `NormalDispersion`. It is computed at
/// scales from the points themselves on, each twice as coarse, up to a spacing of 10 cm or 2.5 % of the
/// height. A cloud has leaves if a quarter of the points of a scale have a high dispersion, the mean above
/// the threshold is high, both are also true at the next scale, and the mean below the threshold is low:
/// noise violates one of the last two conditions.
///
/// Points above the threshold at this scale are leaves, unless shortest paths from the roots pass through
/// them or near them to points more than ten spacings beyond: these are wood among leaves, as in
/// [Vicari2019]. Near means within 1/35 of the length beyond, because branches have at least about this
/// thickness. Finally, components of wood shorter than ten spacings become leaves.
///
/// `ignored` points have no influence and are not marked. O(n log n); about 300 bytes of additional memory
/// per point. The result does not depend on the number of threads. Throws Cancelled.
std::vector<std::uint8_t> find_leaves(std::span<const Vec3> points, const Neighbours& near,
                                      std::span<const std::uint8_t> ignored, const LeafOptions& options,
                                      const Context& ctx);

}  // namespace coppice::extract_internal
