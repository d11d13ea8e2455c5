#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/points/point_set.h"
#include "coppice/points/sampling/dart_throwing.h"

namespace coppice {

/// Options of `remove_random`.
struct RemoveRandomOptions {
    float percent = 50;  ///< percentage of the points inside to remove
    int seed = 0;        ///< seed of the random selection
};

/// Lists the members for front ends.
void list_fields(RemoveRandomOptions& o, FieldList& list);

/// Removes exactly the rounded percentage of the points inside a solid (value > level at origin + position),
/// selected at random. The others keep their order. O(n log n) and one evaluation of the field per point.
/// Throws InvalidInput for options out of range.
PointSet remove_random(const PointSet& points, const FieldRef& solid, const RemoveRandomOptions& options = {},
                       const Context& ctx = {});

/// Appends new points in a region, placed by Lane's method as if after the existing ones, so that new points
/// also keep the distance of the kernel's core from existing points. See `sample_dart_throwing`.
PointSet densified(const PointSet& points, const PointRegion& region, const RadialKernel& kernel,
                   const DartThrowingOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
