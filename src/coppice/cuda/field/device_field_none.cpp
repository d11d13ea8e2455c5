#include "coppice/cuda/field/device_field.h"

namespace coppice {

void sample_on_device(const ConvolutionField&, std::span<const Vec3>, std::span<FieldSample>) {
    throw DeviceError("no CUDA device was found: " + find_device().missing);
}

std::vector<double> time_field(const ConvolutionField&, std::span<const Vec3>, int) {
    throw DeviceError("no CUDA device was found: " + find_device().missing);
}

}  // namespace coppice
