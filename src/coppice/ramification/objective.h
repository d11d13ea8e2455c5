#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/vec.h"

namespace coppice {

/// 1 - cos of the angle between two directions; 0 where one has no length. The text prints the cosine itself
/// ([Huang2017] eq. 2), but takes its least value for the best.
double cosine_distance(Vec3d a, Vec3d b);

/// RU of a unit that reaches from its main face's centre `down` and `up` along the branch and `side` to
/// either side, with a square subface: twice the distance of each direction to a corner from the diagonal of
/// the square ([Huang2017] eq. 2, with A2' of eq. 8). 0 for a cube.
double unit_distortion(double down, double up, double side);

/// RC of two neighbours on a branch whose rings are turned by `twist` [rad] against each other, `gap` [m]
/// apart (negative where they overlap), at a diameter of the branch [m]: the distance of the directions to
/// the corners (eq. 6), and a repulsion below one diameter, 1 - gap / diameter times their likeness (eq. 9
/// with the cosine, since with its distance nothing would part rings that are aligned).
double connection_distortion(double twist, double gap, double diameter);

/// By how many places the second loop is to be turned so that its directions from its centre suit those of
/// the first best, both seen along `normal` (eq. 6 and 10). Loops of the same number of points, both
/// counter-clockwise. O(m^2).
std::uint32_t best_turn(std::span<const Vec3d> first, std::span<const Vec3d> second, Vec3d normal);

/// CP of two loops of the same number of points that are merged in their order (eq. 11), with equal weights
/// of directions and of lengths, the latter in diameters.
double paste_distortion(std::span<const Vec3d> sub, std::span<const Vec3d> place, double diameter);

}  // namespace coppice
