#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/points/painted_points.h"

namespace coppice {

/// Which classes of points, as LAS numbers them, may be trees.
struct WoodClasses {
    bool automatic = true;          ///< all but those that certainly are none, where the points have classes
    bool ground = false;            ///< that rule keeps ground, for whoever looks at trees above it
    std::bitset<256> classes = {};  ///< else these
};

/// Reads "auto", "all", or classes and ranges of them: "4,5,20-22". Throws InvalidInput for anything else.
WoodClasses parse_wood_classes(std::string_view text);

/// What became of points by their classes.
struct ClassSelection {
    std::array<std::uint64_t, 256> left_out{};  ///< points of each class
    std::uint64_t count = 0;                    ///< of all classes
    std::optional<std::string> doubt;           ///< why classes that the rule would have left out were kept
};

/// Leaves out points whose class is no wood, with what all columns say of them; the others keep their order.
///
/// The automatic rule leaves out ground (2), buildings (6), noise (7, 18), water (9), rails, roads, wires,
/// towers and bridges (10, 11, 13 to 17) and keeps all else, vegetation of any height (3 to 5) and points
/// that nobody classified (0, 1) among it. It keeps ground that does not lie low, as where 2 was taken for
/// wood, and everything where less than a tenth of the points would be left: `doubt` then says so.
///
/// Throws InvalidInput when classes are asked for and the points have none, or none of these; Cancelled.
/// Linear.
ClassSelection keep_wood_classes(PaintedPoints& points, const WoodClasses& wood, const Context& ctx = {});

}  // namespace coppice
