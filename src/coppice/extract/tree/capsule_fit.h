#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/extract/tree/draft_tree.h"

namespace coppice {

/// What a draft is fitted to: places on a surface.
struct FitSamples {
    std::span<const Vec3> positions;  ///< [m] finite
    std::span<const Vec3> normals;    ///< outward unit normals, zero where unknown; may be empty
    std::vector<std::uint32_t>
        node;  ///< per sample: the lower node of the segment it belongs to, as far as known
};

/// How long and how freely nodes move that are not fixed.
struct FitOptions {
    int iterations = 10;      ///< times that all nodes move
    double robust = 0.3;      ///< [radius] residuals much larger than this hardly count
    double stiffness = 0.02;  ///< how strongly neighbours move together, against the mean weight of a sample
    double move = 0.5;        ///< [radius] most that a node moves in one iteration
};

/// Moves the nodes and changes the radii so that the samples lie on the surface, by damped, robust least
/// squares [Levenberg1944]. Each sample belongs to the segment whose surface it is deepest in, sought among
/// the neighbours of the one it had; `samples.node` is brought up to date. The normal equations of a tree are
/// eliminated from the tips to the root without fill: O(samples + nodes) per iteration, parallel, the same
/// bits for any number of threads. Reports progress; throws Cancelled.
void fit_capsules(DraftTree& tree, FitSamples& samples, const FitOptions& options, const Context& ctx);

/// Distance of a sample from the surface of its segment, negative inside [m].
std::vector<float> fit_residuals(const DraftTree& tree, const FitSamples& samples, const Context& ctx);

}  // namespace coppice
