#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/points/point_cloud.h"

namespace coppice {

/// Selection of the LAS classes of points that may be trees.
struct WoodClasses {
    bool automatic = true;  ///< all except those that certainly are not trees, if the points have classes
    bool ground = false;    ///< whether this rule keeps ground, for methods that detect the ground themselves
    std::bitset<256> classes = {};  ///< otherwise these classes
};

/// Parses "auto", "all", or classes and ranges of them: "4,5,20-22". Throws InvalidInput for any other text.
WoodClasses parse_wood_classes(std::string_view text);

/// Result of the selection by class.
struct ClassSelection {
    std::array<std::uint64_t, 256> left_out{};  ///< number of removed points per class
    std::uint64_t count = 0;                    ///< total number of removed points
    std::optional<std::string> doubt;  ///< reason for keeping classes that the rule would have removed
};

/// Removes points with a class that is not wood, and their values in all columns; the others keep their
/// order.
///
/// The automatic rule removes ground (2), buildings (6), noise (7, 18), water (9), rails, roads, wires,
/// towers and bridges (10, 11, 13 to 17) and keeps all other classes, including vegetation of any height (3
/// to 5) and unclassified points (0, 1). It keeps ground that is not low, for example if 2 was used for wood,
/// and all points if less than a tenth of them would be left: `doubt` then contains the reason.
///
/// Throws InvalidInput if classes are specified and the points have no classes, or not these; Cancelled.
/// Linear.
ClassSelection keep_wood_classes(PointCloud& points, const WoodClasses& wood, const Context& ctx = {});

}  // namespace coppice
