#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::bench {

inline constexpr std::uint32_t kGroundOwner = std::numeric_limits<std::uint32_t>::max();
inline constexpr std::uint32_t kBushOwner = kGroundOwner - 1;

/// A tree in a plot.
struct TrueTree {
    Skeleton skeleton;
    Vec3d foot;         ///< [m] base on the ground
    Vec3d at_breast;    ///< [m] of the axis, 1.3 m above it
    double dbh = 0;     ///< [m]
    double height = 0;  ///< [m]
};

/// A synthetic plot, and its points from scanners inside it.
struct PlotScene {
    std::string name;
    std::vector<TrueTree> trees;
    PointSet points;
    std::vector<std::uint32_t> owner;  ///< of each point: index of its tree, kGroundOwner, kBushOwner
    std::vector<std::uint8_t> leaf;    ///< 1: on a leaf
};

/// Creates a plot by its name TREES:POINTS or TREES:POINTS:FOLIAGE, such as 40:4000000:sparse (see
/// foliage_named()): trees of 8 to 20 m on about 16 m2 each, so that crowns overlap; some lean, every twelfth
/// forks at half a metre. The ground is a slope of 8 degrees with hummocks and bushes up to 1.5 m. The plot
/// is scanned from its middle and four positions within it, at 1.6 m above the ground, with noise of 3 mm in
/// range. Throws InvalidInput.
PlotScene make_plot(const std::string& name, const Context& ctx);

}  // namespace coppice::bench
