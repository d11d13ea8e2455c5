#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/texture.h"

namespace coppice {

/// A rotation as a unit quaternion.
struct Quaternion {
    float x = 0;  ///< of the vector
    float y = 0;  ///< of the vector
    float z = 0;  ///< of the vector
    float w = 1;  ///< the scalar
};

/// Returns the rotated vector; `r` must be of unit length.
inline Vec3 rotate(Quaternion r, Vec3 v) {
    const Vec3 axis{r.x, r.y, r.z};
    const Vec3 t = 2.0f * cross(axis, v);
    return v + r.w * t + cross(axis, t);
}

/// A mesh that is placed many times, such as a leaf. Its origin is the point of attachment, its length
/// extends along +y, its upper side faces +z.
struct Prototype {
    std::string name;  ///< for files: letters, digits and underscores
    TriMesh mesh;      ///< [m] at scale 1
    /// One per corner of the faces; u from 0 at the left edge to 1, v from 0 at the point of attachment to 1.
    std::vector<TexturePoint> texture;
    std::uint32_t material = 0;  ///< index of the material
};

/// Placed copies of prototypes. All vectors have the same length.
struct Instances {
    std::vector<std::uint32_t> prototypes;  ///< index of the prototype
    std::vector<Vec3> positions;            ///< [m] of the point of attachment, relative to `origin`
    std::vector<Quaternion> rotations;      ///< from the frame of the prototype to that of the tree
    std::vector<float> scales;              ///< > 0
    std::vector<std::array<std::uint8_t, 3>> colors;  ///< sRGB, multiplied with that of the material
    Vec3d origin;                                     ///< [m]

    std::size_t size() const { return positions.size(); }  ///< number of copies
    bool empty() const { return positions.empty(); }       ///< whether there are none
};

}  // namespace coppice
