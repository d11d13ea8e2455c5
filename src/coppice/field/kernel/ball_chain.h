#pragma once

namespace coppice {

/// How balls stand along a branch, and how far its surface then is from smooth.
struct BallChain {
    double spacing = 0;   ///< [radii] from ball to ball
    double at_balls = 1;  ///< [radii] of the surface of an endless chain, across a ball
    double between = 1;   ///< [radii] the same half-way between two balls
};

/// The widest spacing at which, and below which, radii of an endless chain of metaballs differ by no more
/// than `bulge`. `support` > 1 in radii; bulge > 0 in radii. Whole balls then stand closer than that.
BallChain ball_chain(double support, double bulge);

/// An endless chain of metaballs of this spacing [radii]: see BallKernel.
BallChain ball_chain_of(double support, double spacing);

}  // namespace coppice
