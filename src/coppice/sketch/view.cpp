#include "coppice/sketch/view.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/error.h"

namespace coppice {
namespace {

constexpr double kNearest = 1e-9;  // [m] minimum depth of a perspective image

/// Applies the distortion to normalized image coordinates.
PicturePoint distort(const SketchView& view, PicturePoint p) {
    const auto [k1, k2, p1, p2, k3] = view.distortion;
    const double rr = dot(p, p), radial = 1 + rr * (k1 + rr * (k2 + rr * k3));
    return {p.x * radial + 2 * p1 * p.x * p.y + p2 * (rr + 2 * p.x * p.x),
            p.y * radial + p1 * (rr + 2 * p.y * p.y) + 2 * p2 * p.x * p.y};
}

bool distorts(const SketchView& view) {
    return std::ranges::any_of(view.distortion, [](double d) { return d != 0; });
}

/// Inverts `distort`.
PicturePoint straighten(const SketchView& view, PicturePoint wanted) {
    PicturePoint p = wanted;
    for (int i = 0; i < 30; ++i) {
        const PicturePoint miss = wanted - distort(view, p);
        p = p + miss;
        if (dot(miss, miss) < 1e-24) break;
    }
    return p;
}

PicturePoint to_pixels(const SketchView& view, PicturePoint p) {
    const Matrix3& k = view.k;
    return {k[0][0] * p.x + k[0][1] * p.y + k[0][2], k[1][1] * p.y + k[1][2]};
}

PicturePoint from_pixels(const SketchView& view, PicturePoint p) {
    const Matrix3& k = view.k;
    const double y = (p.y - k[1][2]) / k[1][1];
    return {(p.x - k[0][2] - k[0][1] * y) / k[0][0], y};
}

Vec3d row(const Matrix3& m, std::size_t i) { return {m[i][0], m[i][1], m[i][2]}; }

bool is_rotation(const Matrix3& r) {
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j)
            if (!(std::abs(dot(row(r, i), row(r, j)) - (i == j ? 1 : 0)) < 1e-3)) return false;
    }
    return dot(cross(row(r, 0), row(r, 1)), row(r, 2)) > 0;
}

}  // namespace

Vec3d operator*(const Matrix3& m, Vec3d v) {
    return {dot(row(m, 0), v), dot(row(m, 1), v), dot(row(m, 2), v)};
}

Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
    Matrix3 out{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k) out[i][j] += a[i][k] * b[k][j];
    return out;
}

Matrix3 transposed(const Matrix3& m) {
    return {{{m[0][0], m[1][0], m[2][0]}, {m[0][1], m[1][1], m[2][1]}, {m[0][2], m[1][2], m[2][2]}}};
}

Matrix3 compute_rotation(double w, Vec3d v) {
    const double size = std::sqrt(w * w + length_squared(v));
    w /= size;
    v = v / size;
    const auto [x, y, z] = v;
    return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
             {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
             {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

Matrix3 rotation_about(Vec3d axis) {
    const double angle = length(axis);
    return compute_rotation(std::cos(0.5 * angle), normalized(axis) * std::sin(0.5 * angle));
}

double depth(const SketchView& view, Vec3d position) { return (view.r * position + view.t).z; }

PicturePoint project(const SketchView& view, Vec3d position) {
    const Vec3d c = view.r * position + view.t;
    if (view.projection == Projection::orthographic) return to_pixels(view, {c.x, c.y});
    const double z = std::max(c.z, kNearest);
    return to_pixels(view, distort(view, {c.x / z, c.y / z}));
}

std::array<Vec3d, 2> projection_change(const SketchView& view, Vec3d position) {
    Vec3d across = row(view.r, 0), down = row(view.r, 1);
    if (view.projection == Projection::perspective) {
        const Vec3d c = view.r * position + view.t;
        const double z = std::max(c.z, kNearest);
        across = (across - row(view.r, 2) * (c.x / z)) / z;
        down = (down - row(view.r, 2) * (c.y / z)) / z;
    }
    return {across * view.k[0][0] + down * view.k[0][1], down * view.k[1][1]};
}

ViewRay ray(const SketchView& view, PicturePoint point) {
    const Matrix3 back = transposed(view.r);
    const PicturePoint p = from_pixels(view, point);
    if (view.projection == Projection::orthographic)
        return {back * (Vec3d{p.x, p.y, 0} - view.t), row(view.r, 2)};
    const PicturePoint q = straighten(view, p);
    return {back * (-view.t), normalized(back * Vec3d{q.x, q.y, 1})};
}

PicturePoint undistorted(const SketchView& view, PicturePoint point) {
    if (!distorts(view)) return point;
    return to_pixels(view, straighten(view, from_pixels(view, point)));
}

SketchView without_distortion(SketchView view) {
    view.distortion = {};
    return view;
}

double pixels_per_metre(const SketchView& view, Vec3d position) {
    const double scale = std::sqrt(std::abs(view.k[0][0] * view.k[1][1]));
    if (view.projection == Projection::orthographic) return scale;
    return scale / std::max(depth(view, position), kNearest);
}

SketchView drawing_view(DrawingSide side, double pixels_per_metre, PicturePoint origin) {
    if (!(pixels_per_metre > 0))
        throw InvalidInput("the scale of a drawing must be above 0 pixels per metre");
    SketchView view;
    view.projection = Projection::orthographic;
    view.k = {{{pixels_per_metre, 0, origin.x}, {0, pixels_per_metre, origin.y}, {0, 0, 1}}};
    switch (side) {
        case DrawingSide::front:
            view.r = {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}};
            break;
        case DrawingSide::back:
            view.r = {{{-1, 0, 0}, {0, 0, -1}, {0, -1, 0}}};
            break;
        case DrawingSide::side:
            view.r = {{{0, 1, 0}, {0, 0, -1}, {-1, 0, 0}}};
            break;
        case DrawingSide::left:
            view.r = {{{0, -1, 0}, {0, 0, -1}, {1, 0, 0}}};
            break;
        case DrawingSide::top:
            view.r = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
            break;
    }
    return view;
}

void validate(const SketchView& view, const std::string& where) {
    for (const auto& numbers : view.k)
        for (const double number : numbers)
            if (!std::isfinite(number)) throw InvalidInput(where + ".K must contain finite numbers");
    const Matrix3& k = view.k;
    if (!(k[0][0] > 0) || !(k[1][1] > 0) || k[1][0] != 0 || k[2][0] != 0 || k[2][1] != 0 || k[2][2] != 1) {
        throw InvalidInput(where +
                           ".K must be [[fx, skew, cx], [0, fy, cy], [0, 0, 1]] with fx and fy above 0");
    }
    if (!is_rotation(view.r)) throw InvalidInput(where + ".R must be a rotation");
    if (!is_finite(view.t)) throw InvalidInput(where + ".t must contain finite numbers");
    for (const double number : view.distortion)
        if (!std::isfinite(number)) throw InvalidInput(where + ".distortion must contain finite numbers");
}

}  // namespace coppice
