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

/// Reason for the end of the sampling.
enum class PointStop {
    count_reached,
    full,    ///< no space is left for a point, or only gaps of a thousandth of a cell
    stalled  ///< too many draws were rejected, and max_memory prevents a subdivision
};

template <>
struct EnumNames<PointStop> {
    static constexpr std::array<std::string_view, 3> names{"count_reached", "full", "stalled"};
};

/// Options of `sample_dart_throwing`.
struct DartThrowingOptions {
    int count = 1000;    ///< number of points to place; 0 = as many as fit, which needs a kernel with a core
    int resolution = 0;  ///< number of voxels along the longest side; 0 = from count and kernel
    float max_factor = 100;  ///< maximum factor of the density by all kernels together
    int seed = 0;            ///< random seed
    int max_memory = 4096;   ///< [MiB] maximum memory; larger requests are refused in advance
};

/// Lists the members for front ends.
void list_fields(DartThrowingOptions& o, FieldList& list);

/// New points and the reason for the end.
struct DartThrowingResult {
    PointSet points;                            ///< new points, in the order of placing; origin zero
    PointStop stop = PointStop::count_reached;  ///< reason for the end
    std::uint64_t tries = 0;                    ///< number of points drawn, including rejected ones
    float distance = 0;                         ///< [m] minimum distance of any two points
};

/// Places points one after the other: each is drawn from the density of the region times the kernels of all
/// previous points. Source: [Lane2002].
///
/// The density is stored per cell of a grid, and cells are drawn through a pyramid of sums. A point drawn in
/// a cell is accepted with the ratio of the exact density there to that of the cell, and rejected if it is
/// closer than the core of the kernel to another point, so that the field and the minimum distance are exact
/// at every point; only the soft part of the kernel is constant in a cell. If too many draws are rejected,
/// all cells are divided into eight and covered parts are removed, until `full`. Parts of the solid much
/// smaller than a cell may be missed: use a higher resolution for these.
///
/// With a kernel that consists only of a core, some thousand points are drawn at once and evaluated in
/// parallel: points excluded by those placed earlier are rejected, so that the distribution is the same. A
/// soft kernel is applied after each point.
///
/// `existing` points, also outside the region, act as if placed before. The result does not depend on the
/// number of threads; the field must be thread-safe. O(log n) for each draw.
///
/// Throws InvalidInput for options out of range, a box without volume, a density of 0 in the whole box, a
/// count of 0 for a kernel without core, kernels that extend over too many cells, or too much memory. Throws
/// Cancelled.
DartThrowingResult sample_dart_throwing(const PointRegion& region, const RadialKernel& kernel,
                                        const DartThrowingOptions& options = {}, const Context& ctx = {});
/// Places points among existing ones, which act on the new ones.
DartThrowingResult sample_dart_throwing(const PointRegion& region, const RadialKernel& kernel,
                                        const PointSet& existing, const DartThrowingOptions& options = {},
                                        const Context& ctx = {});

}  // namespace coppice
