#pragma once

#include <optional>

#include "coppice/field/convolution_field.h"
#include "coppice/pipeline/mesh_skeleton.h"

namespace coppice {

/// Returns the radius of the corners of a regular polygon that has the area of a circle of radius 1.
double corner_radius(double sides);

/// The options of the field whose surface is asked for: how lines go on beyond ends follows from the cage's.
FieldOptions surface_field_options(const MeshOptions& options);

/// The field whose surface is asked for, without its regions: with lines that go on beyond flat ends, and
/// with the weights wanted. Constraints have the frame of their origin.
ConvolutionField surface_field(const Skeleton& skeleton, const MeshOptions& options,
                               const PointSet& constraints, std::optional<GlobalWeights>& weights,
                               const Context& ctx);

}  // namespace coppice
