#include "coppice/render/frame_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "coppice/base/error.h"
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

SketchView frame_view(std::span<const Vec3d> points, const RenderOptions& options) {
    const UnitFrame frame = unit_frame(points);
    std::vector<FramePoint> local;
    local.reserve(points.size());
    for (const Vec3d& p : points) local.push_back({frame.local(p)});
    const Camera camera(local, options);
    const Vec3d right(camera.right()), forward(-camera.to_camera()), down = cross(forward, right);
    const double half = std::tan(0.5 * static_cast<double>(options.field_of_view));
    const double scale = 0.5 * std::max(options.width, options.height) * options.zoom / half;
    SketchView view;
    view.width = options.width;
    view.height = options.height;
    view.k = {{{scale, 0, 0.5 * options.width}, {0, scale, 0.5 * options.height}, {0, 0, 1}}};
    view.r = {{{right.x, right.y, right.z}, {down.x, down.y, down.z}, {forward.x, forward.y, forward.z}}};
    view.t = view.r * -(Vec3d(camera.position()) / frame.scale + frame.center);
    return view;
}

}  // namespace coppice
