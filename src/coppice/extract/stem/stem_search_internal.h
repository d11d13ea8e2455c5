#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/extract/stem/circle_search_internal.h"

namespace coppice::extract_internal {

/// A section across a stem.
struct StemSection {
    Vec3d center;        ///< [m]
    double height = 0;   ///< [m] above the ground
    FoundCircle circle;  ///< on the plane across the stem; its `x` and `y` are those of that plane
    double radius() const { return circle.radius; }
};

/// What was found of a stem about breast height: sections, upward, at least two. Found, their z are heights
/// above the ground.
struct StemTrack {
    std::vector<StemSection> sections;
    double radius = 0;  ///< [m] usual among the sections

    /// The axis at a height: between sections straight, beyond them on as it runs through the last few.
    Vec3d at(double z) const;
    /// How it runs there, upward, of length 1.
    Vec3d direction_at(double z) const;
    Vec3d middle() const { return sections[sections.size() / 2].center; }
    void raise(double by);  ///< [m]
};

struct StemSearch {
    double least_radius = 0.02, greatest_radius = 1;  ///< [m]
    double noise = 0.006;                             ///< [m] of the points, about
    double scale = 1;  ///< of the heights and widths below: less than 1 for trees of a few metres
};

/// Stems by what stands at breast height: circles in slices of 20 cm from 0.3 to 3.9 m above the ground,
/// stacked where they lie above each other and are about as thick. `height` is that of each point above the
/// ground [m]. From thick to thin evidence: the more sections, the earlier. O(n) and some milliseconds for
/// each cluster of points in a slice. Throws Cancelled.
std::vector<StemTrack> find_stems(std::span<const Vec3> points, std::span<const float> height,
                                  const StemSearch& search, const Context& ctx);

/// Circles amid the points of one slice, seen from above, the thickest first. O(n) and some milliseconds for
/// each cluster of points.
std::vector<FoundCircle> circles_in_slice(std::span<const Vec3> points, const StemSearch& search,
                                          const Context& ctx);

}  // namespace coppice::extract_internal
