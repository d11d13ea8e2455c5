#pragma once

#include <string_view>
#include <vector>

#include "coppice/points/sampling/generate.h"
#include "coppice/scene/commands/tables_internal.h"

namespace coppice::table {

inline Argument curve_argument() {
    return repeated(tuple("curve", "", "VALUE,DENSITY: a knot of a density of your own, instead of `density`",
                          {2}, Unit::none));
}

inline Argument kernel_argument(std::string help) {
    return repeated(tuple("kernel", "", std::move(help), {2}, Unit::none));
}

/// Knots of a curve or kernel, as they were given.
template <class Knot>
std::vector<Knot> knots_of(const SceneCall& call, std::string_view name) {
    std::vector<Knot> knots;
    for (const ArgumentValue& v : call.values(name))
        knots.push_back({static_cast<float>(v.numbers.at(0)), static_cast<float>(v.numbers.at(1))});
    return knots;
}

/// The density that curve=, or else density= with its width and power, ask for.
inline DensityCurve density_of(const SceneCall& call, const GenerateOptions& options, float level) {
    if (call.has("curve")) return DensityCurve(knots_of<DensityCurve::Knot>(call, "curve"));
    return DensityCurve(options.density, level, options.width, options.power);
}

/// Holds all places where that density is above 0.
inline Box3 density_box(const SceneCall& call, const GenerateOptions& options, const SolidField& field) {
    if (call.has("curve")) return field.bounds();
    if (options.density != PointDensity::outside_boundary) return field.surface_bounds();
    const float value = field.level() - options.width;
    return value > 0 ? field.bounds_at(value) : field.bounds();
}

inline RadialKernel kernel_of(const SceneCall& call) {
    return RadialKernel(knots_of<RadialKernel::Knot>(call, "kernel"));
}

}  // namespace coppice::table
