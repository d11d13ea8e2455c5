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

/// Axis of a stem from its base upward, as far as circles determine it.
struct StemAxis {
    std::vector<Vec3d> position;  ///< [m] upward; the first one is on the ground
    std::vector<double> radius;   ///< [m] not increasing upward
    StemDiameter breast;          ///< at breast height, as measured by circles
    StemTrack track;              ///< circles by which it was found
};

/// Returns the distance [m] from the axis of a stem up to which points belong to it, including bark, moss and
/// noise.
inline double reach_of_stem(double radius, double spacing) {
    return radius + std::max(0.3 * radius, spacing);
}

/// Returns whether the horizontal distance of a point from the axis of a stem is within its reach. O(stems *
/// log sections).
bool is_on_stem(std::span<const StemAxis> stems, Vec3d p, double spacing);

/// Returns the unit direction of growth at each point: away from the point of the closest stem that is lower
/// by the horizontal distance, or from the base of a tree without a stem. O(points * (stems + bases)).
Buffer<Vec3> growth_directions(std::span<const Vec3> points, std::span<const StemAxis> stems, StemBases bases,
                               const Context& ctx);

/// Computes the axis through the sections of a stem: positions and radii from robust local lines; radii are
/// then made monotone. Empty if there are fewer than four sections. O(sections).
StemAxis make_stem_axis(const StemForm& form);

/// Options of `find_stem_axes`.
struct StemAxisSearch {
    double spacing = 0.01;           ///< [m] spacing of the points
    std::optional<Vec3d> root = {};  ///< [m] start of the only stem, if set
    int max_trees = 0;               ///< maximum number of stems, thickest first; 0 = all
};

/// Finds the axes of all separate stems on the ground, thickest first; with a specified root, that of the
/// stem there, if any. O(n). Throws Cancelled.
std::vector<StemAxis> find_stem_axes(std::span<const Vec3> points, const Terrain& terrain,
                                     const StemAxisSearch& search, const Context& ctx);

}  // namespace coppice::extract_internal
