#pragma once

#include <array>
#include <cmath>
#include <string>

#include "coppice/base/vec.h"

namespace coppice {

/// A place in a picture [pixels]: x to the right, y down, from the upper left corner.
struct PicturePoint {
    double x = 0;  ///< to the right
    double y = 0;  ///< down

    /// Coordinate by coordinate.
    /// @{
    friend constexpr PicturePoint operator+(PicturePoint a, PicturePoint b) { return {a.x + b.x, a.y + b.y}; }
    friend constexpr PicturePoint operator-(PicturePoint a, PicturePoint b) { return {a.x - b.x, a.y - b.y}; }
    friend constexpr PicturePoint operator*(PicturePoint a, double s) { return {a.x * s, a.y * s}; }
    friend constexpr bool operator==(const PicturePoint&, const PicturePoint&) = default;
    /// @}
};

/// The scalar product.
constexpr double dot(PicturePoint a, PicturePoint b) { return a.x * b.x + a.y * b.y; }
/// Twice the area of the triangle 0, a, b.
constexpr double cross(PicturePoint a, PicturePoint b) { return a.x * b.y - a.y * b.x; }
/// [pixels]
inline double length(PicturePoint a) { return std::sqrt(dot(a, a)); }

/// Three rows of three numbers.
using Matrix3 = std::array<std::array<double, 3>, 3>;

/// A row of pixels, or a column, for every row of the matrix.
Vec3d operator*(const Matrix3& m, Vec3d v);
/// The product of two matrices.
Matrix3 operator*(const Matrix3& a, const Matrix3& b);
/// The matrix with rows and columns exchanged; of a rotation, its inverse.
Matrix3 transposed(const Matrix3& m);

/// The rotation about an axis by its length [rad] (Rodrigues), as OpenCV writes them.
Matrix3 rotation_about(Vec3d axis);

/// The rotation of a quaternion, which need not have length 1.
Matrix3 rotation_of(double w, Vec3d v);

/// How a camera turns space into a picture.
enum class Projection {
    perspective,   ///< a pinhole: what is twice as far is half as large
    orthographic,  ///< everything in one scale, as in a drawing
};

/// One picture of a tree, and the camera that took it. A point X [m] of the world lies at R X + t before the
/// camera: x to the right, y down, z away from it, as in OpenCV and COLMAP. A perspective camera divides x
/// and y by z and distorts them; an orthographic one leaves x and y [m] as they are. K makes pixels of that.
struct SketchView {
    std::string name;   ///< each once
    std::string image;  ///< file of the picture, relative to the sketch; empty where there is none
    int width = 0;      ///< [pixels] of the picture; 0 = not known
    int height = 0;     ///< [pixels] of the picture; 0 = not known
    Projection projection = Projection::perspective;  ///< of the camera
    Matrix3 k{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};     ///< [pixels], orthographic: [pixels per metre]
    Matrix3 r{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};     ///< a rotation
    Vec3d t;                                          ///< [m]
    std::array<double, 5> distortion{};               ///< k1, k2, p1, p2, k3 of OpenCV; perspective only
};

/// A line of sight.
struct ViewRay {
    Vec3d origin;  ///< [m] of a perspective camera its centre, of an orthographic one some point of the line
    Vec3d direction;  ///< unit, away from the camera
};

/// [m] before the camera; <= 0 is behind it. Means nothing for an orthographic one.
double depth(const SketchView& view, Vec3d position);
/// Where a point of the world [m] is in the picture. A perspective camera needs a positive depth.
PicturePoint project(const SketchView& view, Vec3d position);
/// How the place in the picture changes with the point of the world: two rows [pixels / m], distortion left
/// out of the change.
std::array<Vec3d, 2> projection_change(const SketchView& view, Vec3d position);
/// The line of sight through a point of the picture.
ViewRay ray(const SketchView& view, PicturePoint point);
/// The same place in the picture of the same camera without distortion. By fixed-point iteration.
PicturePoint undistorted(const SketchView& view, PicturePoint point);
/// The same view with a lens that does not distort.
SketchView without_distortion(SketchView view);
/// [pixels / m] at a point of the world, for what lies across the line of sight.
double pixels_per_metre(const SketchView& view, Vec3d position);

/// The six sides from which a drawing may show a tree, its front towards -y. Front and side are what most
/// people draw.
enum class DrawingSide { front, back, side, left, top };

/// An orthographic view: `origin` is where (0, 0, 0) lies in the picture. Throws InvalidInput when the scale
/// [pixels / m] is not above 0.
SketchView drawing_view(DrawingSide side, double pixels_per_metre, PicturePoint origin);

/// Throws InvalidInput when something is wrong with the camera: "`where`.R must be a rotation", say.
void validate(const SketchView& view, const std::string& where);

}  // namespace coppice
