#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/vec.h"

namespace coppice {

/// Returns 1 - cos of the angle between two directions; 0 if one has no length. The paper prints the cosine
/// itself ([Huang2017] eq. 2), but considers its minimum as the optimum.
double cosine_distance(Vec3d a, Vec3d b);

/// Returns RU of a unit that extends from the centre of its main face `down` and `up` along the branch and
/// `side` to either side, with a square subface: twice the distance of each direction to a corner from the
/// diagonal of the square ([Huang2017] eq. 2, with A2' of eq. 8). 0 for a cube.
double unit_distortion(double down, double up, double side);

/// Returns RC of two neighbours on a branch with rings rotated by `twist` [rad] against each other, `gap` [m]
/// apart (negative if they overlap), at a diameter of the branch [m]: the distance of the directions to the
/// corners (eq. 6), and a repulsion below one diameter, 1 - gap / diameter times their similarity (eq. 9 with
/// the cosine, because its distance would not separate aligned rings).
double connection_distortion(double twist, double gap, double diameter);

/// Returns the number of places by which the second loop must be rotated so that the directions from its
/// centre match those of the first best, both projected along `normal` (eq. 6 and 10). The loops have the
/// same number of points and are counter-clockwise. O(m^2).
std::uint32_t best_turn(std::span<const Vec3d> first, std::span<const Vec3d> second, Vec3d normal);

/// Returns CP of two loops with the same number of points that are merged in their order (eq. 11), with equal
/// weights of directions and of lengths, the latter in diameters.
double paste_distortion(std::span<const Vec3d> sub, std::span<const Vec3d> place, double diameter);

}  // namespace coppice
