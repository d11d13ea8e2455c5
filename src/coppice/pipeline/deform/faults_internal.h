#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"

namespace coppice::pipeline_internal {

/// Returns the quads with a scaled Jacobian not above 0, ascending. O(n), with a small constant if there are
/// few.
std::vector<std::uint32_t> folded_faces(std::span<const Quad> quads, std::span<const Vec3> positions,
                                        const Context& ctx);

/// Smooths folded quads: those given and those that become folded; their corners move half the way to the
/// mean of their neighbours, a few times. `faces_of`: by vertex. Returns those that remain folded; moves
/// without effect are undone.
std::vector<std::uint32_t> smooth_folds(std::span<const Quad> quads,
                                        const CompressedRows<std::uint32_t>& faces_of,
                                        std::vector<std::uint32_t> folded, std::span<Vec3> positions);

}  // namespace coppice::pipeline_internal
