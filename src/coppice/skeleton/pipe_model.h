#pragma once

#include <span>
#include <vector>

#include "coppice/base/id.h"

namespace coppice {

/// Returns radii by the pipe model [Shinozaki1964]: tips have `tip_radius`, and r^exponent of a node is the
/// sum over its children plus `leaf` times that of a tip, so that unbranched axes taper if leaf > 0; roots
/// get no leaf. Parents must precede their children. Exponent and tip radius must be greater than 0. O(n).
std::vector<double> pipe_radii(std::span<const NodeId> parents, double tip_radius, double exponent,
                               double leaf);

}  // namespace coppice
