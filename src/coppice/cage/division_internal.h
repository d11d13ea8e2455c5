#pragma once

#include <span>
#include <vector>

#include "coppice/cage/frame_internal.h"

namespace coppice::cage_internal {

/// A direction that requires space on the sphere.
struct Site {
    Vec3 direction;  ///< unit
    float angle;     ///< [rad] angle of the cone that its cell should contain
};

/// The sphere of directions divided into one cell of four corners per site.
struct Division {
    std::vector<Vec3> corner;  ///< unit
    std::vector<Ring> cell;    ///< per site, counter-clockwise seen from outside
};

/// Divides the sphere into cells for any two or more sites in any directions. The sites `first` and `second`
/// share a ring of four corners; every other one, thick before thin, opens a corner between the existing
/// cells: the corner becomes two, and two of its neighbours are the other corners of the new cell. Of the
/// possible openings, the one after which the cells contain their cones best is selected. Cells that share a
/// corner always fit together, so that the division is closed for any directions. O(k^3) for k sites up to
/// 48; more are stacked around `second` in linear time.
Division divide_sphere(std::span<const Site> sites, std::uint32_t first, std::uint32_t second);

/// Moves the corners of all cells towards squares around their sites, none smaller than the site's cone.
void even_out(Division& division, std::span<const Site> sites, int passes);

}  // namespace coppice::cage_internal
