#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/foliage/leaf_shape.h"
#include "coppice/foliage/outline_internal.h"

namespace coppice::foliage_internal {

/// The organs of which the triangles of a leaf are parts.
enum class LeafPart { petiole, blade, needle };

/// A corner of a triangle of a leaf, both in space and before the leaf is bent.
struct FlatCorner {
    std::uint32_t vertex = 0;  ///< index of the position
    Point2 flat;               ///< [m] in the flat leaf
    float t = 0;               ///< parameter of the row of the blade; see BladeRow
    float s = 0;               ///< position across the blade: -1 and 1 are the margins
    Point2 local;              ///< [m] in the flat blade, from its base
};

/// A triangle of a leaf.
struct FlatTriangle {
    std::array<FlatCorner, 3> corners;  ///< counter-clockwise seen from above
    LeafPart part = LeafPart::blade;    ///< organ
    const FlatCorner& operator[](std::size_t k) const { return corners[k]; }  ///< corner k < 3
};

/// The triangles of a leaf with their places in the flat leaf.
struct FlatLeaf {
    std::vector<Vec3> positions;          ///< [m] of the bent leaf
    std::vector<FlatTriangle> triangles;  ///< of all parts
    double area = 0;                      ///< [m^2] as in LeafModel
};

/// Bounds of a flat leaf.
struct FlatBox {
    Point2 low;   ///< [m] minimum
    Point2 high;  ///< [m] maximum
};

/// Makes the triangles of a leaf with shape.rows rows and shape.columns columns.
FlatLeaf make_flat_leaf(const LeafShape& shape);

/// Makes the triangles of a leaf with all of its teeth and lobes, without bending, for images.
FlatLeaf make_fine_leaf(const LeafShape& shape);

/// Returns the bounds of the flat corners of the image and of all meshes of a leaf.
FlatBox find_image_box(const FlatLeaf& fine_leaf);

}  // namespace coppice::foliage_internal
