#include "coppice/pipeline/surface_field_internal.h"

#include <cmath>
#include <numbers>

namespace coppice {
namespace {

// A polygon with its corners on a circle has less area; the radii are multiplied by this factor to
// compensate. It is not needed for the fit, which compensates by itself, for global weights, which are fitted
// to points of the surface, and for tetrahedra, because their rings have no known number of sides.
float volume_true_scale(const MeshOptions& options) {
    if (options.method == MeshMethod::tetrahedra || options.fit == Fit::volume ||
        options.field.weights == Weights::global) {
        return 1;
    }
    return static_cast<float>(corner_radius(std::ldexp(options.control.sides, options.levels)));
}

}  // namespace

double corner_radius(double sides) {
    const double angle = 2 * std::numbers::pi / sides;
    return std::sqrt(angle / std::sin(angle));
}

// At a flat cut the field continues far enough to have its full value there.
FieldOptions surface_field_options(const MeshOptions& options) {
    constexpr float kBeyondCut = 1.5f;
    const ControlOptions& control = options.control;
    FieldOptions field = options.field;
    if (field.radius_scale == 0) field.radius_scale = volume_true_scale(options);
    if (control.base == BaseShape::round) field.root_extension = -1;
    if (control.tips == TipShape::flat) field.tip_extension = kBeyondCut;
    return field;
}

std::optional<GlobalWeights> apply_global_weights(ConvolutionField& field, const Skeleton& skeleton,
                                                  const FieldOptions& options, const PointSet& constraints,
                                                  const Context& ctx) {
    if (options.weights == Weights::local) return {};
    std::vector<Vec3> points(constraints.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        points[i] = Vec3(constraints.world(i) - skeleton.origin());
    }
    std::optional<GlobalWeights> weights = global_weights(skeleton, options, points, ctx);
    field.scale_weights(weights->factors);
    return weights;
}

}  // namespace coppice
