#pragma once

#include <span>
#include <vector>

#include "coppice/cuda/device.h"
#include "coppice/field/convolution_field.h"

namespace coppice {

/// Samples a field at points of its region 0 on the card. Throws DeviceError.
void sample_on_device(const ConvolutionField& field, std::span<const Vec3> points,
                      std::span<FieldSample> out);

/// [s] How long the card takes for that, without copies, `repeat` times. Throws DeviceError.
std::vector<double> time_field(const ConvolutionField& field, std::span<const Vec3> points, int repeat);

}  // namespace coppice
