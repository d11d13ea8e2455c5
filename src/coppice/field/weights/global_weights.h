#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/field/field_options.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Deviation of the field from the iso value at the constraints, in units of the iso value.
struct WeightResidual {
    double rms = 0;      ///< root mean square
    double largest = 0;  ///< maximum absolute value
};

/// A point that the surface should pass through.
struct WeightConstraint {
    Vec3 position;   ///< [m] in the frame of the skeleton
    NodeId segment;  ///< the segment of the point, by child node; the node itself in a tree of one node
};

/// Returns points distributed over the surface defined by the skeleton: on circles of the local radius around
/// the segments, options.constraint_density points per segment on average, in proportion to length over
/// radius, so that thick and thin branches have the same number for their shape; at least four on each
/// segment. Points deeper than 2 % of the radius inside another segment's rounded cone are omitted. Sorted by
/// segment. O(n log n). Throws InvalidInput for more than 2^28 points.
std::vector<WeightConstraint> surface_constraints(const Skeleton& skeleton, const FieldOptions& options,
                                                  const Context& ctx = {});

/// Factors of all segments, and the quality of the fit.
struct GlobalWeights {
    std::vector<float> factors;     ///< relative to the local weights, by child node: for scale_weights
    std::uint64_t constraints = 0;  ///< number of fitted points
    std::uint64_t entries = 0;      ///< number of pairs of a point and a segment near it
    std::uint64_t zero = 0;    ///< number of segments with weight 0, which are not in the surface any more
    std::uint64_t unseen = 0;  ///< number of segments not near any constraint, which keep their local weight
    WeightResidual local;      ///< of the plain sum, with local weights
    WeightResidual global;     ///< of the plain sum, with the fitted weights
    int pivots = 0;            ///< see nnls
    int sweeps = 0;            ///< see nnls
    bool converged = false;    ///< false: better than local, but not optimal
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const GlobalWeights& r, Visitor&& visit) {
    visit("constraints", r.constraints);
    visit("weights_zero", r.zero);
    visit("weights_unseen", r.unseen);
    visit("weights_converged", r.converged);
    visit("weights_pivots", r.pivots);
    visit("weights_sweeps", r.sweeps);
    visit("residual_rms", r.global.rms);
    visit("residual_max", r.global.largest);
    visit("residual_rms_of_local_weights", r.local.rms);
    visit("residual_max_of_local_weights", r.local.largest);
}

/// Computes the weights of all segments at once, >= 0, such that the plain sum is closest to the iso value at
/// given points by least squares [Zhu2013, eq. 6] [Zhu2015, eq. 2]. Without `constraints` the points of
/// surface_constraints are used; given points belong to the segment with the nearest surface, and are all
/// used.
///
/// A constraint sees the relevant segments in the region of its segment (see find_candidates): those that
/// ConvolutionField sums there. A segment with values below 0.01 of the iso value at all constraints together
/// is unseen. options.blend is set to 1, options.contact to 0.
///
/// options.weight_averaging smooths the fitted weights, as in [Zhu2015, figure 12 (g)]: each weight, in units
/// of the local one, is averaged with the weights of the segments that share a node with it. O(n) per pass.
///
/// The fit minimizes mean residuals: near forks, where the sum is too great, branches become too thin, and
/// others in turn too thick (see docs/user/comparison.md for figures). It is provided for comparison.
///
/// Compact kernels: 300 segments take a few milliseconds. Throws InvalidInput that names an option out of
/// range, for constraints that are not finite or are all far from the skeleton, and Unsupported if the
/// segments overlap so much that more than 2^28 pairs of point and segment would be stored.
GlobalWeights global_weights(const Skeleton& skeleton, const FieldOptions& options,
                             std::span<const Vec3> constraints = {}, const Context& ctx = {});

}  // namespace coppice
