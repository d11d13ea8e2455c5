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

template <class Self, class Visitor>
requires SameOptions<Self, DrawSketchOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field("projection", "Projection of the cameras of both views."), o.projection);
    visit(common_field("angle", "Angle between the two views, counter-clockwise seen from above.",
                       Unit::radian, 0.01, 3.1),
          o.angle);
    visit(common_field("size", "Width and height of the pictures in pixels.", Unit::none, 16, 16384), o.size);
    visit(Field{"spacing", "Distance in pixels between the points of a stroke; nodes are points as well.",
                Unit::none, 0.5, 1000},
          o.spacing);
}

/// Returns two level cameras that show the whole skeleton: "front" looks along +y, "side" is rotated by
/// `angle`. O(n). Throws InvalidInput if an option is out of range.
std::vector<SketchView> views_of(const Skeleton& skeleton, const DrawSketchOptions& options = {});

/// Creates the ideal sketch of a skeleton in these views: a branch for every axis, that is a stem or lateral
/// that continues with the thickest child at every fork, with strokes in all views, widths at every point,
/// and its parent. Perspective cameras must be outside the tree. O(points). Throws InvalidInput if an option
/// is out of range or the skeleton has no segments.
Sketch draw_sketch(const Skeleton& skeleton, const std::vector<SketchView>& views,
                   const DrawSketchOptions& options = {});

}  // namespace coppice
