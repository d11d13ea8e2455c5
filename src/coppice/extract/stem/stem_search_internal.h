#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/extract/stem/circle_search_internal.h"

namespace coppice::extract_internal {

/// Cross-section of a stem.
struct StemSection {
    Vec3d center;        ///< [m]
    double height = 0;   ///< [m] above the ground
    FoundCircle circle;  ///< on the plane across the stem; `x` and `y` are coordinates on that plane
    double radius() const { return circle.radius; }
};

/// Sections of a stem about breast height, upward, at least two. Returned by find_stems with heights above
/// the ground as z.
struct StemTrack {
    std::vector<StemSection> sections;
    double radius = 0;  ///< [m] median of the sections

    /// Returns the axis at a height: linear between sections, extrapolated from the last few sections beyond
    /// them.
    Vec3d at(double z) const;
    /// Returns the unit direction of the axis at a height, upward.
    Vec3d direction_at(double z) const;
    Vec3d middle() const { return sections[sections.size() / 2].center; }
    void raise(double by);  ///< [m]
};

struct StemSearch {
    double min_radius = 0.02, max_radius = 1;  ///< [m]
    double noise = 0.006;                      ///< [m] approximate noise of the points
    double scale = 1;  ///< scale of the search heights and widths: less than 1 for small trees
};

/// Finds stems at breast height: circles in slices of 20 cm from 0.3 to 3.9 m above the ground that are above
/// each other and of similar thickness. Where a slice has few points, it includes those within 30 cm; if no
/// stem is found, those within 50 cm. `height` is the height [m] of each point above the ground. The result
/// is sorted by decreasing evidence, the total coverage of the sections. O(n) and some milliseconds for each
/// cluster of points in a slice. Throws Cancelled.
std::vector<StemTrack> find_stems(std::span<const Vec3> points, std::span<const float> height,
                                  const StemSearch& search, const Context& ctx);

/// Returns the circles in the points of one slice in plan view, thickest first. O(n) and some milliseconds
/// for each cluster of points.
std::vector<FoundCircle> circles_in_slice(std::span<const Vec3> points, const StemSearch& search,
                                          const Context& ctx);

}  // namespace coppice::extract_internal
