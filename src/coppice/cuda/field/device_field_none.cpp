#include "coppice/cuda/field/device_field.h"

namespace coppice {

void sample_on_device(const ConvolutionField&, std::span<const Vec3>, std::span<FieldSample>) {
    require_device();
}

std::vector<double> time_field(const ConvolutionField&, std::span<const Vec3>, int) {
    require_device();
    return {};
}

}  // namespace coppice
