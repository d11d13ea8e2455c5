#pragma once

#include <optional>

#include "coppice/field/convolution_field.h"
#include "coppice/field/weights/global_weights.h"
#include "coppice/pipeline/mesh_options.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Returns the radius of the corners of a regular polygon that has the area of a circle of radius 1.
double corner_radius(double sides);

/// Returns the options of the field of the requested surface: the continuation of lines beyond ends follows
/// from the cage's options.
FieldOptions surface_field_options(const MeshOptions& options);

/// Fits global weights of a field around a skeleton to constraints, which have the frame of their origin, and
/// applies them to the field. Returns nullopt, and changes nothing, if the options request local weights.
std::optional<GlobalWeights> apply_global_weights(ConvolutionField& field, const Skeleton& skeleton,
                                                  const FieldOptions& options, const PointSet& constraints,
                                                  const Context& ctx);

}  // namespace coppice
