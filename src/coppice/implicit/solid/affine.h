#pragma once

#include <cmath>

#include "coppice/base/vec.h"

namespace coppice {

/// An affine map of space, in double precision: p -> x p.x + y p.y + z p.z + origin.
struct Affine {
    Vec3d x{1, 0, 0};  ///< image of the first unit vector
    Vec3d y{0, 1, 0};  ///< image of the second
    Vec3d z{0, 0, 1};  ///< image of the third
    Vec3d origin{};    ///< [m] image of the origin

    Vec3d direction(Vec3d d) const { return x * d.x + y * d.y + z * d.z; }  ///< without the translation
    Vec3d point(Vec3d p) const { return direction(p) + origin; }            ///< with the translation
    /// Factor of volumes; negative for a reflection.
    double determinant() const { return dot(x, cross(y, z)); }

    /// Returns the inverse map; not finite if the determinant is 0.
    Affine inverse() const {
        const double k = 1 / determinant();
        const Vec3d r0 = cross(y, z) * k, r1 = cross(z, x) * k, r2 = cross(x, y) * k;
        Affine out{{r0.x, r1.x, r2.x}, {r0.y, r1.y, r2.y}, {r0.z, r1.z, r2.z}, {}};
        out.origin = -out.direction(origin);
        return out;
    }

    /// Returns the composition: first b, then a.
    friend Affine operator*(const Affine& a, const Affine& b) {
        return {a.direction(b.x), a.direction(b.y), a.direction(b.z), a.point(b.origin)};
    }

    /// Translates by a vector [m].
    static Affine translation(Vec3d by) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, by}; }
    /// Scales along the axes about the origin.
    static Affine scaling(Vec3d by) { return {{by.x, 0, 0}, {0, by.y, 0}, {0, 0, by.z}, {}}; }

    /// Rotates by `angle` [rad] about the line through the origin along the unit vector `axis`, right-handed.
    static Affine rotation(Vec3d axis, double angle) {
        const double c = std::cos(angle), s = std::sin(angle);
        const auto turned = [&](Vec3d v) {
            return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
        };
        return {turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1}), {}};
    }

    /// Returns the rigid map from the z axis to the line through `origin` along the unit vector `axis`.
    static Affine frame(Vec3d origin, Vec3d axis) {
        const Vec3d u = perpendicular(axis);
        return {u, cross(axis, u), axis, origin};
    }
};

}  // namespace coppice
