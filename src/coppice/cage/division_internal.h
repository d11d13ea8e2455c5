#pragma once

#include <span>
#include <vector>

#include "coppice/cage/frame_internal.h"

namespace coppice::cage_internal {

/// A direction that needs room on the sphere.
struct Site {
    Vec3 direction;  ///< unit
    float angle;     ///< [rad] of the cone that its cell should hold
};

/// The sphere of directions cut into one cell of four corners per site.
struct Division {
    std::vector<Vec3> corner;  ///< unit
    std::vector<Ring> cell;    ///< per site, counter-clockwise seen from outside
};

/// Cuts the sphere into cells for any two or more sites in any directions. The sites `first` and `second`
/// share a ring of four corners; every other one, thick before thin, opens a corner between the cells that
/// are there: the corner becomes two, and two of its neighbours are the other corners of the new cell. Of the
/// ways to do so the one is taken after which the cells hold their cones best. Cells that share a corner
/// always fit together, so that this closes whatever the directions are. O(k^3) for k sites up to 48; more
/// are stacked around `second` in linear time.
Division divide_sphere(std::span<const Site> sites, std::uint32_t first, std::uint32_t second);

/// Moves the corners of all cells towards squares about their sites, none smaller than the site's cone.
void even_out(Division& division, std::span<const Site> sites, int passes);

}  // namespace coppice::cage_internal
