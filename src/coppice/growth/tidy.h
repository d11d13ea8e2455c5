#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/growth/guard.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// How much a grown tree is smoothed, and what of it is contracted.
struct TidyOptions {
    int relax_passes = 1;   ///< times that nodes move towards their parents; in [0, 100]
    float relax = 0.5f;     ///< part of the way to the parent in a pass; in [0, 1]
    int smooth_passes = 2;  ///< times that nodes move towards the middle of their neighbours along the axis;
                            ///< in [0, 1000]
    float smooth = 0.5f;    ///< part of the way to that middle in a pass; in [0, 1]
    float shortest = 0.5f;  ///< [mean length of a segment] shorter ones are contracted; 0 = never; in [0, 2]
    float within = 1;  ///< [radius] nodes nearer than this to their parents are contracted: they lie inside
                       ///< the parent's branch; 0 = never; in [0, 2]
};

template <class Self, class Visitor>
requires SameOptions<Self, TidyOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"relax_passes", "Times that nodes move towards their parents", Unit::none, 0, 100},
          o.relax_passes);
    visit(Field{"relax", "Part of the way to the parent", Unit::none, 0, 1}, o.relax);
    visit(Field{"axis_passes", "Times that axes are smoothed", Unit::none, 0, 1000}, o.smooth_passes);
    visit(Field{"axis_smoothing", "Part of the way to the middle of the neighbours", Unit::none, 0, 1},
          o.smooth);
    visit(Field{"shortest", "Segments shorter than this part of the mean are contracted", Unit::none, 0, 2},
          o.shortest);
    visit(Field{"within", "Nodes nearer to their parents are contracted into them; 0 = never", Unit::radius,
                0, 2},
          o.within);
}

/// A smoother tree, and what was done.
struct TidyResult {
    Skeleton skeleton;               ///< the new one
    std::uint32_t contracted = 0;    ///< nodes that became one with an ancestor
    std::uint32_t held = 0;          ///< times that a node stayed where it was because of the guard
    std::vector<NodeId> new_of_old;  ///< for every node of the input the one that stands for it
};

/// Makes a grown skeleton fit for a surface: first nodes move towards their parents, which makes the angles
/// of branches more acute [Runions2007]; then axes, which run along the leaders, lose their kinks; then tiny
/// steps go, and what lies inside the branch of its parent. Roots stay where they are; the tip of an
/// axis may lose its last steps, and a lateral that ends inside its parent's branch goes altogether. Radii
/// stay, so they should be right before: they say who leads, and what lies inside a branch.
///
/// With a guard no segment that was clear of the solid enters it: nodes whose segments would stay behind.
/// What else `prepare` sees to is left to that.
///
/// The same bits for any number of threads. Throws InvalidInput when an option is out of its range;
/// Cancelled. O(n passes).
TidyResult tidy(const Skeleton& skeleton, const TidyOptions& options = {}, const Guard* guard = nullptr,
                const Context& ctx = {});

}  // namespace coppice
