#pragma once

#include <optional>

#include "coppice/field/convolution_field.h"
#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice {

/// Returns the radius of the corners of a regular polygon that has the area of a circle of radius 1.
double corner_radius(double sides);

/// Returns the options of the field of the requested surface: the continuation of lines beyond ends follows
/// from the cage's options.
FieldOptions surface_field_options(const MeshOptions& options);

/// Returns the field of the requested surface, without its regions: with lines that continue beyond flat
/// ends, and with the requested weights. Constraints have the frame of their origin.
ConvolutionField surface_field(const Skeleton& skeleton, const MeshOptions& options,
                               const PointSet& constraints, std::optional<GlobalWeights>& weights,
                               const Context& ctx);

}  // namespace coppice
