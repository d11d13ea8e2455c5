#include "coppice/render/frame_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"
#include "coppice/render/trace/camera_internal.h"

namespace coppice {
namespace {

/// The transformation of the points in which cameras are placed: the centre of their box is moved to the
/// origin, its diagonal scaled to 1.
struct UnitFrame {
    Vec3d center;
    double scale;

    Vec3 local(Vec3d p) const { return Vec3((p - center) * scale); }
};

UnitFrame unit_frame(std::span<const Vec3d> points) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Vec3d low{kInfinity, kInfinity, kInfinity}, high = -low;
    for (const Vec3d& p : points) {
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }
    }
    const double size = length(high - low);
    if (!std::isfinite(size) || size <= 0)
        throw InvalidInput("render: the object has no extent that a camera could frame");
    return {(low + high) * 0.5, 1 / size};
}

}  // namespace

SketchView frame_view(std::span<const Vec3d> points, const CameraOptions& options) {
    const UnitFrame frame = unit_frame(points);
    std::vector<FramePoint> local;
    local.reserve(points.size());
    for (const Vec3d& p : points) local.push_back({frame.local(p)});
    const Camera camera(local, options);
    const Vec3d right(camera.right()), forward(-camera.to_camera()), down = cross(forward, right);
    const double half = std::tan(0.5 * static_cast<double>(options.field_of_view));
    const double scale = 0.5 * std::max(options.width, options.height) / half;
    SketchView view;
    view.width = options.width;
    view.height = options.height;
    view.k = {{{scale, 0, 0.5 * options.width}, {0, scale, 0.5 * options.height}, {0, 0, 1}}};
    view.r = {{{right.x, right.y, right.z}, {down.x, down.y, down.z}, {forward.x, forward.y, forward.z}}};
    view.t = view.r * -(Vec3d(camera.position()) / frame.scale + frame.center);
    return view;
}

void list_fields(CameraOptions& o, FieldList& list) {
    list.add(common_field("width", "Width of the image in pixels.", Unit::none, 16, 16384), o.width);
    list.add(common_field("height", "Height of the image in pixels.", Unit::none, 16, 16384), o.height);
    list.add(common_field("azimuth", "Direction of the camera, counter-clockwise from +x seen from above.",
                          Unit::radian, -6.2832, 6.2832),
             o.azimuth);
    list.add(
        common_field("elevation", "Height of the camera above the horizon.", Unit::radian, -1.5708, 1.5708),
        o.elevation);
    list.add(Field{"field_of_view", "Field of view of the camera across the longer side of the image.",
                   Unit::radian, 0.01, 2.5},
             o.field_of_view);
    list.add(Field{"margin", "Fraction of the image that remains free on each side.", Unit::none, 0, 0.45},
             o.margin);
}

}  // namespace coppice
