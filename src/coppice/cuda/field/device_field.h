#pragma once

#include <span>
#include <vector>

#include "coppice/cuda/device.h"
#include "coppice/field/convolution_field.h"

namespace coppice {

/// Samples a field at points of its region 0 on the GPU. Throws DeviceError.
void sample_on_device(const ConvolutionField& field, std::span<const Vec3> points,
                      std::span<FieldSample> out);

/// [s] Returns the times of `repeat` samplings on the GPU, without copies. Throws DeviceError.
std::vector<double> time_field(const ConvolutionField& field, std::span<const Vec3> points, int repeat);

}  // namespace coppice
