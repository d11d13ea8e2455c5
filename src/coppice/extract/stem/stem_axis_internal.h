#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/extract/plot/terrain.h"
#include "coppice/extract/points/graph_internal.h"
#include "coppice/extract/stem/stem_form.h"
#include "coppice/extract/stem/stem_search_internal.h"

namespace coppice::extract_internal {

/// The axis of a stem from its foot upward, as far as circles show it.
struct StemAxis {
    std::vector<Vec3d> position;  ///< [m] upward; the first one on the ground
    std::vector<double> radius;   ///< [m] never growing upward
    StemDiameter breast;          ///< at breast height, as circles show it
    StemTrack track;              ///< the circles by which it was found
};

/// [m] From the axis of a stem, up to which points are its own: bark, moss and what stands off it.
inline double reach_of_stem(double radius, double spacing) {
    return radius + std::max(0.3 * radius, spacing);
}

/// Whether a point lies within reach of the axis of a stem, seen level. O(stems * log sections).
bool is_on_stem(std::span<const StemAxis> stems, Vec3d p, double spacing);

/// How branches grow at each point, of length 1: away from the place of the closest stem that is as much
/// lower as it is far, or of the foot of a tree without a stem. O(points * (stems + bases)).
Buffer<Vec3> growth_directions(std::span<const Vec3> points, std::span<const StemAxis> stems, StemBases bases,
                               const Context& ctx);

/// The axis through the sections of a stem: places and radii by local lines in which outlying sections do not
/// count, radii made monotone. Empty where fewer than four sections were seen. O(sections).
StemAxis make_stem_axis(const StemForm& form);

/// Where stems are looked for.
struct StemAxisSearch {
    double spacing = 0.01;           ///< [m] of the points
    std::optional<Vec3d> root = {};  ///< [m] there is one tree, which starts at this place of its stem
    int max_trees = 0;               ///< the thickest so many; 0 = all
};

/// The axes of all stems that stand on the ground apart from each other, the thickest first; with a given
/// root that of the stem there, if any. O(n). Throws Cancelled.
std::vector<StemAxis> find_stem_axes(std::span<const Vec3> points, const Terrain& terrain,
                                     const StemAxisSearch& search, const Context& ctx);

}  // namespace coppice::extract_internal
