#pragma once

namespace coppice {

/// Spacing of balls along a branch, and the resulting deviation of its surface.
struct BallChain {
    double spacing = 0;   ///< [radii] between adjacent balls
    double at_balls = 1;  ///< [radii] radius of the surface of an infinite chain at a ball
    double between = 1;   ///< [radii] the same half-way between two balls
};

/// Returns the widest spacing at which, and below which, the radii of an infinite chain of metaballs differ
/// by at most `bulge`. `support` > 1 in radii; bulge > 0 in radii. The spacing of a whole number of balls is
/// smaller.
BallChain ball_chain(double support, double bulge);

/// Returns an infinite chain of metaballs with this spacing [radii]: see BallKernel.
BallChain compute_ball_chain(double support, double spacing);

}  // namespace coppice
