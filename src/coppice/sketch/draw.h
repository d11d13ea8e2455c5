#pragma once

#include <vector>

#include "coppice/base/fields.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/sketch/sketch.h"

namespace coppice {

template <>
struct EnumNames<Projection> {
    static constexpr std::array<std::string_view, 2> names{"perspective", "orthographic"};
};

/// Options of draw_sketch.
struct DrawSketchOptions {
    Projection projection = Projection::perspective;  ///< projection of both cameras
    float angle = 1.5707964f;  ///< [rad] between the two views, counter-clockwise seen from above
    int size = 2000;           ///< [pixels] width and height of the images
    float spacing = 12;        ///< [pixels] distance between points of a stroke; nodes are points as well
};

/// Lists the members for front ends.
void list_fields(DrawSketchOptions& o, FieldList& list);

/// Returns two level cameras that show the whole skeleton: "front" looks along +y, "side" is rotated by
/// `angle`. O(n). Throws InvalidInput if an option is out of range.
std::vector<SketchView> choose_views(const Skeleton& skeleton, const DrawSketchOptions& options = {});

/// Creates the ideal sketch of a skeleton in these views: a branch for every axis, that is a stem or lateral
/// that continues with the thickest child at every fork, with strokes in all views, widths at every point,
/// and its parent. Perspective cameras must be outside the tree. O(points). Throws InvalidInput if an option
/// is out of range or the skeleton has no segments.
Sketch draw_sketch(const Skeleton& skeleton, const std::vector<SketchView>& views,
                   const DrawSketchOptions& options = {});

}  // namespace coppice
