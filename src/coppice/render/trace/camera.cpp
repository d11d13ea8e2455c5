#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/render/trace/camera_internal.h"

namespace coppice {
namespace {

/// Start of the rays of an orthographic image, before the scene of diagonal 1.
constexpr float kBehind = 2;

/// The camera sees x in [c - t d, c + t d] at depth d. For points at (x, z), z towards the camera, the
/// minimum camera height and the centre follow from the two extreme lines alone.
struct Slab {
    float upper = -std::numeric_limits<float>::infinity();
    float lower = -std::numeric_limits<float>::infinity();

    void add(float x, float z, float radius, float tangent) {
        const float reach = radius * std::sqrt(1 + tangent * tangent);
        upper = std::max(upper, x + tangent * z + reach);
        lower = std::max(lower, -x + tangent * z + reach);
    }
    float height(float tangent) const { return 0.5f * (upper + lower) / tangent; }
    float center() const { return 0.5f * (upper - lower); }
};

}  // namespace

Camera::Camera(std::span<const FramePoint> points, const CameraOptions& options, float zoom,
               std::optional<Vec3> middle)
    : width_(static_cast<float>(options.width)), height_(static_cast<float>(options.height)) {
    const float ca = std::cos(options.azimuth), sa = std::sin(options.azimuth);
    const float ce = std::cos(options.elevation), se = std::sin(options.elevation);
    right_ = {-sa, ca, 0};
    forward_ = {-ce * ca, -ce * sa, -se};
    up_ = cross(right_, forward_);
    const float half = std::tan(0.5f * options.field_of_view), longer = std::max(width_, height_);
    tan_x_ = half * width_ / longer;
    tan_y_ = half * height_ / longer;
    const float free = 1 - 2 * options.margin;
    Slab across, along;
    float nearest = -std::numeric_limits<float>::infinity();
    for (const FramePoint& p : points) {
        const float z = -dot(p.position, forward_);
        across.add(dot(p.position, right_), z, p.radius, free * tan_x_);
        along.add(dot(p.position, up_), z, p.radius, free * tan_y_);
        nearest = std::max(nearest, z + p.radius);
    }
    const float z = std::max({across.height(free * tan_x_), along.height(free * tan_y_), nearest + 1e-3f});
    position_ = right_ * across.center() + up_ * along.center() - forward_ * z;
    if (middle) {
        const Vec3 off = *middle - position_;
        position_ += right_ * dot(off, right_) + up_ * dot(off, up_);
    }
    tan_x_ /= zoom;
    tan_y_ /= zoom;
}

Camera::Camera(const SketchView& view) : view_(view) {
    const auto axis = [&](std::size_t i) { return Vec3(Vec3d{view.r[i][0], view.r[i][1], view.r[i][2]}); };
    right_ = axis(0);
    up_ = -axis(1);
    forward_ = axis(2);
    const bool perspective = view.projection == Projection::perspective;
    position_ = perspective ? Vec3(transposed(view.r) * -view.t) : forward_ * -kBehind;
}

Camera::Ray Camera::ray(float x, float y) const {
    if (view_) {
        const ViewRay r = coppice::ray(*view_, {double{x}, double{y}});
        if (view_->projection == Projection::perspective) return {position_, Vec3(r.direction)};
        return {Vec3(r.origin - r.direction * (dot(r.origin, r.direction) + double{kBehind})),
                Vec3(r.direction)};
    }
    const float a = (2 * x / width_ - 1) * tan_x_, b = (1 - 2 * y / height_) * tan_y_;
    return {position_, normalized(forward_ + right_ * a + up_ * b)};
}

Camera::Projected Camera::project(Vec3 p) const {
    const Vec3 d = p - position_;
    if (view_) {
        const PicturePoint at = coppice::project(*view_, Vec3d(p));
        return {static_cast<float>(at.x), static_cast<float>(at.y), dot(d, forward_)};
    }
    const float depth = dot(d, forward_), scale = 1 / std::max(depth, 1e-12f);
    return {0.5f * width_ * (1 + dot(d, right_) * scale / tan_x_),
            0.5f * height_ * (1 - dot(d, up_) * scale / tan_y_), depth};
}

}  // namespace coppice
