#pragma once

#include <array>
#include <cmath>
#include <string>

#include "coppice/base/vec.h"

namespace coppice {

/// A point in an image [pixels]: x to the right, y down, from the upper left corner.
struct PicturePoint {
    double x = 0;  ///< to the right
    double y = 0;  ///< down

    /// Component-wise operations.
    /// @{
    friend constexpr PicturePoint operator+(PicturePoint a, PicturePoint b) { return {a.x + b.x, a.y + b.y}; }
    friend constexpr PicturePoint operator-(PicturePoint a, PicturePoint b) { return {a.x - b.x, a.y - b.y}; }
    friend constexpr PicturePoint operator*(PicturePoint a, double s) { return {a.x * s, a.y * s}; }
    friend constexpr bool operator==(const PicturePoint&, const PicturePoint&) = default;
    /// @}
};

/// Returns the scalar product.
constexpr double dot(PicturePoint a, PicturePoint b) { return a.x * b.x + a.y * b.y; }
/// Returns twice the signed area of the triangle 0, a, b.
constexpr double cross(PicturePoint a, PicturePoint b) { return a.x * b.y - a.y * b.x; }
/// Returns the length of a vector [pixels].
inline double length(PicturePoint a) { return std::sqrt(dot(a, a)); }

/// 3 x 3 matrix by rows.
using Matrix3 = std::array<std::array<double, 3>, 3>;

/// Returns the product of a matrix and a vector.
Vec3d operator*(const Matrix3& m, Vec3d v);
/// Returns the product of two matrices.
Matrix3 operator*(const Matrix3& a, const Matrix3& b);
/// Returns the transpose; for a rotation, its inverse.
Matrix3 transposed(const Matrix3& m);

/// Returns the rotation by a rotation vector (Rodrigues), as in OpenCV: its length is the angle [rad].
Matrix3 rotation_about(Vec3d axis);

/// Returns the rotation of a quaternion, which need not be normalized.
Matrix3 compute_rotation(double w, Vec3d v);

/// Projection of a camera.
enum class Projection {
    perspective,   ///< pinhole camera: size is inversely proportional to depth
    orthographic,  ///< uniform scale, as in a technical drawing
};

/// An image of a tree with its camera. A point X [m] in world space has the camera coordinates R X + t: x to
/// the right, y down, z away from the camera, as in OpenCV and COLMAP. A perspective camera divides x and y
/// by z and applies the distortion; an orthographic one uses x and y [m] directly. K converts the result to
/// pixels.
struct SketchView {
    std::string name;                                 ///< unique
    std::string image;                                ///< image file, relative to the sketch; may be empty
    int width = 0;                                    ///< [pixels] of the image; 0 = unknown
    int height = 0;                                   ///< [pixels] of the image; 0 = unknown
    Projection projection = Projection::perspective;  ///< projection of the camera
    Matrix3 k{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};     ///< [pixels], orthographic: [pixels per metre]
    Matrix3 r{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};     ///< a rotation
    Vec3d t;                                          ///< [m]
    std::array<double, 5> distortion{};               ///< k1, k2, p1, p2, k3 of OpenCV; perspective only
};

/// A line of sight.
struct ViewRay {
    Vec3d origin;  ///< [m] the centre of a perspective camera, or some point of the line for an orthographic
                   ///< one
    Vec3d direction;  ///< unit vector, away from the camera
};

/// Returns the depth [m] of a point in front of the camera; <= 0 is behind it. Not meaningful for an
/// orthographic camera.
double depth(const SketchView& view, Vec3d position);
/// Projects a point [m] in world space into the image. A perspective camera requires a positive depth.
PicturePoint project(const SketchView& view, Vec3d position);
/// Returns the Jacobian of the projection: two rows [pixels / m], ignoring distortion.
std::array<Vec3d, 2> projection_change(const SketchView& view, Vec3d position);
/// Returns the line of sight through a point of the image.
ViewRay ray(const SketchView& view, PicturePoint point);
/// Returns the corresponding point in the undistorted image of the same camera, by fixed-point iteration.
PicturePoint undistorted(const SketchView& view, PicturePoint point);
/// Returns the view without distortion.
SketchView without_distortion(SketchView view);
/// Returns the scale [pixels / m] at a point in world space, perpendicular to the line of sight.
double pixels_per_metre(const SketchView& view, Vec3d position);

/// Side of the tree that a drawing shows, with the front towards -y. Front and side are the most common.
enum class DrawingSide { front, back, side, left, top };

/// Returns an orthographic view with (0, 0, 0) at the image point `origin`. Throws InvalidInput if the scale
/// [pixels / m] is not positive.
SketchView drawing_view(DrawingSide side, double pixels_per_metre, PicturePoint origin);

/// Throws InvalidInput if the camera is invalid, for example "`where`.R must be a rotation".
void validate(const SketchView& view, const std::string& where);

}  // namespace coppice
