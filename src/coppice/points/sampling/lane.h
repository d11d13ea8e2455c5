#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/points/point_region.h"
#include "coppice/points/point_set.h"
#include "coppice/points/sampling/radial_kernel.h"

namespace coppice {

/// Why no more points were placed.
enum class PointStop {
    count_reached,
    full,    ///< no place is left at which a point may lie, or only gaps of a thousandth of a cell
    stalled  ///< drawing went on in vain for too long, and max_memory forbids to look closer
};

template <>
struct EnumNames<PointStop> {
    static constexpr std::array<std::string_view, 3> names{"count_reached", "full", "stalled"};
};

/// How many points are placed, and with what means.
struct LaneOptions {
    int count = 1000;             ///< points to place; 0 = as many as fit, which needs a kernel with a core
    int resolution = 0;           ///< voxels along the longest side of the box; 0 = by count and kernel
    float greatest_factor = 100;  ///< kernels of points together raise the density this much at most
    int seed = 0;                 ///< another seed, another set
    int max_memory = 4096;        ///< [MiB] what would take more is refused before it starts
};

template <class Self, class Visitor>
requires SameOptions<Self, LaneOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"count", "points to place; 0 = as many as fit", Unit::none, 0, 1e8}, o.count);
    visit(Field{"resolution", "voxels along the longest side of the box; 0 = automatic", Unit::none, 0, 2048},
          o.resolution);
    visit(Field{"greatest_factor", "how much the kernels of points together raise the density at most",
                Unit::none, 1, 1e6},
          o.greatest_factor);
    visit(Field{"seed", "another seed gives another set", Unit::none, 0, 2147483647}, o.seed);
    visit(Field{"max_memory", "MiB that may be used", Unit::none, 1, 1e6}, o.max_memory);
}

/// New points, and why there are no more.
struct LaneResult {
    PointSet points;                            ///< the new ones, in the order of placing; origin zero
    PointStop stop = PointStop::count_reached;  ///< why it ended
    std::uint64_t tries = 0;                    ///< points drawn, also those that were refused
    float distance = 0;                         ///< [m] that every two points keep
};

/// Places points one after the other: each is drawn from the region's density times the kernels of all points
/// before it. Source: [Lane2002].
///
/// The density is held per cell of a grid, and cells are drawn through a pyramid of sums. Within its cell a
/// point is kept with the share of the exact density there in the cell's, and refused when it lies nearer
/// than the kernel's core to any other, so that the field and the least distance hold exactly at every point;
/// only the soft part of the kernel is constant in a cell. When too many draws are refused, all cells are cut
/// in eight and parts that are covered vanish, down to `full`. Parts of the solid much smaller than a cell
/// may be missed: give a higher resolution for these.
///
/// With a kernel that is nothing but a core, some thousand points are drawn at once and judged in parallel:
/// what the ones placed first rule out is refused, so that the law stays the same. A soft kernel is applied
/// after each point.
///
/// `existing` points, also outside the region, act as if placed before. Deterministic for any number of
/// threads; the field must be thread safe. O(log n) for each draw.
///
/// Throws InvalidInput, one sentence: options out of range, a box without volume, a density of 0 all over the
/// box, a count of 0 for a kernel without core, kernels that reach over too many cells, too much memory.
/// Throws Cancelled.
LaneResult sample_lane(const PointRegion& region, const RadialKernel& kernel, const LaneOptions& options = {},
                       const Context& ctx = {});
/// The same amid points that are there already, which act on the new ones.
LaneResult sample_lane(const PointRegion& region, const RadialKernel& kernel, const PointSet& existing,
                       const LaneOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
