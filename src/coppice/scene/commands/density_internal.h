#pragma once

#include <string_view>
#include <vector>

#include "coppice/points/sampling/generate.h"
#include "coppice/scene/commands/tables_internal.h"

namespace coppice::table {

inline Argument curve_argument() {
    return repeated(tuple("curve", "",
                          "VALUE,DENSITY: a point of a custom density curve, which replaces `density`.", {2},
                          Unit::none));
}

inline Argument kernel_argument(std::string help) {
    return repeated(tuple("kernel", "", std::move(help), {2}, Unit::none));
}

/// Returns the points of a curve or kernel, in the given order.
template <class Knot>
std::vector<Knot> read_knots(const SceneCall& call, std::string_view name) {
    std::vector<Knot> knots;
    for (const ArgumentValue& v : call.values(name))
        knots.push_back({static_cast<float>(v.numbers.at(0)), static_cast<float>(v.numbers.at(1))});
    return knots;
}

/// Returns the density of curve=, or otherwise of density= with its width and power.
inline DensityCurve compute_density(const SceneCall& call, const GenerateOptions& options, float level) {
    if (call.has("curve")) return DensityCurve(read_knots<DensityCurve::Knot>(call, "curve"));
    return DensityCurve(options.density, level, options.width, options.power);
}

/// Returns a box that contains all points with a positive density.
inline Box3 density_box(const SceneCall& call, const GenerateOptions& options, const SolidField& field) {
    if (call.has("curve")) return field.bounds();
    if (options.density != PointDensity::outside_boundary) return field.surface_bounds();
    const float value = field.level() - options.width;
    return value > 0 ? field.bounds_at(value) : field.bounds();
}

inline RadialKernel make_kernel(const SceneCall& call) {
    return RadialKernel(read_knots<RadialKernel::Knot>(call, "kernel"));
}

}  // namespace coppice::table
