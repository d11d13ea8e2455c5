#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/extract/tree/initial_tree_internal.h"

namespace coppice {

/// Samples of a surface that an initial tree is fitted to.
struct FitSamples {
    std::span<const Vec3> positions;  ///< [m] finite
    std::span<const Vec3> normals;    ///< outward unit normals, zero where unknown; may be empty
    std::vector<std::uint32_t> node;  ///< per sample: the lower node of its segment, if known
};

/// Options of `fit_capsules`: number of iterations and movement of the nodes that are not fixed.
struct FitOptions {
    int iterations = 10;      ///< number of iterations
    double robust = 0.3;      ///< [radius] scale of the robust weight of residuals
    double stiffness = 0.02;  ///< coupling of adjacent nodes, relative to the mean weight of a sample
    double move = 0.5;        ///< [radius] maximum movement of a node in one iteration
};

/// Moves the nodes and changes the radii to fit the surface to the samples by damped, robust least squares
/// [Levenberg1944]. Each sample is assigned to the segment with the smallest signed distance, searched among
/// the neighbours of its previous segment; `samples.node` is updated. The normal equations of a tree are
/// eliminated from the tips to the root without fill-in: O(samples + nodes) per iteration, parallel. The
/// result does not depend on the number of threads. Reports progress; throws Cancelled.
void fit_capsules(InitialTree& tree, FitSamples& samples, const FitOptions& options, const Context& ctx);

/// Returns the distance [m] of each sample from the surface of its segment, negative inside.
std::vector<float> fit_residuals(const InitialTree& tree, const FitSamples& samples, const Context& ctx);

}  // namespace coppice
