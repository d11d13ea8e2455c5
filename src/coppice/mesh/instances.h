#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/column.h"
#include "coppice/base/context.h"
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

    /// [m] Returns a vertex of the prototype at its place in a copy, relative to `origin`.
    Vec3 place(std::size_t copy, Vec3 vertex) const {
        return positions[copy] + scales[copy] * rotate(rotations[copy], vertex);
    }
};

/// Throws InvalidInput, with the number of the copy, if the vectors of the instances have different lengths,
/// a prototype does not exist, a position is not finite, a rotation is not of unit length (within 1e-3), or a
/// scale is not > 0; also if a prototype has no triangles or another number of texture coordinates than
/// corners. O(n).
void validate(std::span<const Prototype> prototypes, const Instances& instances);

/// [m] Returns the box around all vertices of all copies, relative to the origin of the instances; an empty
/// box without copies. The instances must be valid. O(vertices of all copies), in parallel.
Box3 compute_bounds(std::span<const Prototype> prototypes, const Instances& instances,
                    const Context& ctx = {});

/// One mesh of all copies, in the order of their prototypes.
struct MergedInstances {
    TriMesh mesh;                                ///< with the origin of the instances
    Buffer<TexturePoint> texture;                ///< one per corner of the faces
    std::vector<std::uint32_t> materials;        ///< one per face, as in the prototypes
    Buffer<std::array<std::uint8_t, 3>> colors;  ///< one per vertex: sRGB of the copy
    std::vector<std::size_t> first_face;         ///< of each prototype, and the number of faces
};

/// Returns one mesh of all copies. Prototypes without texture coordinates receive (0, 0). The instances must
/// be valid. The result does not depend on the number of threads. O(vertices and faces of all copies), in
/// parallel; memory: `estimate_merged_bytes`. Throws Unsupported beyond 4,294,967,295 vertices; Cancelled.
MergedInstances merge_instances(std::span<const Prototype> prototypes, const Instances& instances,
                                const Context& ctx = {});

/// [bytes] Returns the memory that the result of `merge_instances` needs. O(n).
double estimate_merged_bytes(std::span<const Prototype> prototypes, const Instances& instances);

}  // namespace coppice
