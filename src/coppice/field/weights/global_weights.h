#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/field/field_options.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// How far values of the field at the constraints are from the level, in units of the level.
struct WeightResidual {
    double rms = 0;       ///< root of the mean square
    double greatest = 0;  ///< the greatest absolute value
};

/// A point that the surface is to go through.
struct WeightConstraint {
    Vec3 position;   ///< [m] in the frame of the skeleton
    NodeId segment;  ///< the one it belongs to, by child node; the node itself in a tree of one node
};

/// Points spread over the surface that the skeleton says: on circles of the local radius about the segments,
/// options.constraint_density points per segment on average, in proportion to length over radius, so that
/// thick and thin branches get as many for their shape; four at least on each segment. Points deeper than
/// 2 % of the radius inside another segment's rounded cone are left out. By segment, ascending. O(n log n).
/// Throws InvalidInput when there would be more than 2^28.
std::vector<WeightConstraint> surface_constraints(const Skeleton& skeleton, const FieldOptions& options,
                                                  const Context& ctx = {});

/// Factors of all segments, and how well they fit.
struct GlobalWeights {
    std::vector<float> factors;     ///< of the local weights, by child node: for scale_weights
    std::uint64_t constraints = 0;  ///< points that were fitted
    std::uint64_t entries = 0;      ///< pairs of a point and a segment that it sees
    std::uint64_t zero = 0;         ///< segments that got no weight: they are not in the surface any more
    std::uint64_t unseen = 0;       ///< segments that no constraint sees: they keep their local weight
    WeightResidual local;           ///< of the plain sum, before
    WeightResidual global;          ///< and after
    int pivots = 0;                 ///< see nnls
    int sweeps = 0;                 ///< see nnls
    bool converged = false;         ///< false: better than local, but not the best
};

/// Weights of all segments at once, >= 0, such that the plain sum comes nearest to the level at given points
/// by least squares [Zhu2013, eq. 6] [Zhu2015, eq. 2]. Without `constraints` those of surface_constraints are
/// taken; given ones belong to the segment whose surface is nearest, and are all used.
///
/// A constraint sees the segments that matter in the region of its segment (see find_candidates): those that
/// ConvolutionField sums there. A segment whose values at all constraints together are below 0.01 of the
/// level is unseen. options.blend is taken for 1, options.contact for 0.
///
/// options.weight_averaging smooths what was fitted, as [Zhu2015, figure 12 (g)] does: each weight, in units
/// of the local one, becomes the mean of its own and of those of the segments that share a node with it. O(n)
/// each time.
///
/// It fits mean residuals: near forks, where the sum is too great, branches become thinner than they should
/// be, and others thicker in turn (docs/user/comparison.md has figures). It is here for comparison.
///
/// Compact kernels: 300 segments take a few milliseconds. Throws InvalidInput naming an option out of range,
/// for constraints that are not finite or of which none lies near the skeleton, and Unsupported where so many
/// segments overlap that more than 2^28 pairs of point and segment would have to be stored.
GlobalWeights global_weights(const Skeleton& skeleton, const FieldOptions& options,
                             std::span<const Vec3> constraints = {}, const Context& ctx = {});

}  // namespace coppice
