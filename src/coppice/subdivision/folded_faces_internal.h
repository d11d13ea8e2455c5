#pragma once

#include <hwy/base.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/subdivision/catmull_clark.h"

namespace coppice {

// Refined positions and anchors, and the scaled Jacobian below which a face is bad (see untangle.h).
struct FoldedFaces {
    std::span<const Vec3> positions;
    std::span<const Vec3> anchors;
    float quality;

    // The bad faces of the whole mesh, ascending. Fast when there are few.
    std::vector<std::uint32_t> all(const PatchRefinement& patches, const Context& ctx) const;
    // The same test on one face.
    bool is_bad(const Quad& face) const;
};

// Squared sine and cosine below which a face is bad.
struct FaceLimits {
    float sine, cosine;
};

// 1 for a bad face. `outward` has the direction from the anchors to the corners. Compares squares, so that
// there is neither root nor division; the corners have to be scaled to about 1, since lengths enter with
// their eighth power. Opposite corners' areas add up to that of the face.
HWY_INLINE std::int32_t bad_face(Vec3 a, Vec3 b, Vec3 c, Vec3 d, Vec3 outward, FaceLimits limits) {
    const Vec3 ab = b - a;
    const Vec3 bc = c - b;
    const Vec3 cd = d - c;
    const Vec3 da = a - d;
    const Vec3 normal = cross(c - a, d - b);
    const float size = length_squared(normal);
    const float at_a = dot(cross(da, ab), normal);
    const float at_b = dot(cross(ab, bc), normal);
    const float at_c = size - at_a;
    const float at_d = size - at_b;
    const float limit = limits.sine * size;
    const float ab2 = length_squared(ab);
    const float bc2 = length_squared(bc);
    const float cd2 = length_squared(cd);
    const float da2 = length_squared(da);
    const float out = dot(normal, outward);
    const bool convex = (at_a > 0) & (at_b > 0) & (at_c > 0) & (at_d > 0);
    const bool even = (at_a * at_a >= limit * (da2 * ab2)) & (at_b * at_b >= limit * (ab2 * bc2)) &
                      (at_c * at_c >= limit * (bc2 * cd2)) & (at_d * at_d >= limit * (cd2 * da2));
    const bool outer = (out >= 0) & (out * out >= limits.cosine * (size * length_squared(outward)));
    return (convex & even & outer) ? 0 : 1;
}

// Points by row, one array per coordinate: x y z, and u v w away from the anchor. Face k has the corners k,
// k + 1, k + row + 1, k + row.
struct FaceColumns {
    const float *x, *y, *z, *u, *v, *w;
    std::size_t row;
};

// bad[k] = bad_face of face k where starts[k] is 1, else 0; true when any is bad. Vector code.
bool mark_bad_faces(const FaceColumns& columns, std::size_t count, FaceLimits limits,
                    const std::int32_t* starts, std::int32_t* bad);

}  // namespace coppice
