#pragma once

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

}  // namespace coppice
