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

/// How a skeleton is drawn.
struct DrawSketchOptions {
    Projection projection = Projection::perspective;  ///< of both cameras
    float angle = 1.5707964f;  ///< [rad] between the two views, counter-clockwise seen from above
    int size = 2000;           ///< [pixels] width and height of the pictures
    float spacing = 12;        ///< [pixels] between points of a stroke; nodes are points as well
};

template <class Self, class Visitor>
requires SameOptions<Self, DrawSketchOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(common_field("projection", "Projection of the cameras of both views"), o.projection);
    visit(common_field("angle", "Angle between the two views, counter-clockwise seen from above",
                       Unit::radian, 0.01, 3.1),
          o.angle);
    visit(common_field("size", "Width and height of the pictures in pixels", Unit::none, 16, 16384), o.size);
    visit(Field{"spacing", "pixels between the points of a stroke; nodes are points as well", Unit::none, 0.5,
                1000},
          o.spacing);
}

/// Two cameras before a skeleton, level, that show it whole: "front" looks along +y, "side" stands `angle`
/// further. O(n). Throws InvalidInput for an option out of its range.
std::vector<SketchView> views_of(const Skeleton& skeleton, const DrawSketchOptions& options = {});

/// What somebody would draw who sees the skeleton in these views: a branch for every axis, that is a stem or
/// lateral with the thickest child at every fork, with strokes in all views, widths at every point, and its
/// parent. Perspective cameras have to stand off. O(points). Throws InvalidInput for an option out of its
/// range and for a skeleton without segments.
Sketch draw_sketch(const Skeleton& skeleton, const std::vector<SketchView>& views,
                   const DrawSketchOptions& options = {});

}  // namespace coppice
