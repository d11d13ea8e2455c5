#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/subdivision/catmull_clark.h"
#include "coppice/subdivision/kernel/face_kernel.h"

namespace coppice {

// Refined positions and anchors, and the scaled Jacobian below which a face is bad (see untangle.h).
struct FoldedFaces {
    std::span<const Vec3> positions;
    std::span<const Vec3> anchors;
    float quality;

    // Returns the bad faces of the whole mesh, ascending. Fast if there are few.
    std::vector<std::uint32_t> all(const PatchRefinement& patches, const Context& ctx) const;
    // Applies the same test to one face.
    bool is_bad(const Quad& face) const;
};

// Points by row, one array per coordinate: x y z, and u v w away from the anchor. Face k has the corners k,
// k + 1, k + row + 1, k + row.
struct FaceColumns {
    const float *x, *y, *z, *u, *v, *w;
    std::size_t row;
};

// Sets bad[k] to bad_face of face k where starts[k] is 1, else to 0; returns whether a face is bad. Vector
// code.
bool mark_bad_faces(const FaceColumns& columns, std::size_t count, FaceLimits limits,
                    const std::int32_t* starts, std::int32_t* bad);

}  // namespace coppice
