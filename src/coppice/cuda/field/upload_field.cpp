#include "coppice/cuda/field/upload_field.h"

#include <limits>

#include "coppice/cuda/device.h"

namespace coppice::cuda {

std::vector<DeviceSegment> device_segments(const ConvolutionField& field) {
    std::vector<DeviceSegment> out(field.segments().size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = {field.segments()[i], field.axes()[i]};
    return out;
}

std::vector<std::uint32_t> device_offsets(const CandidateLists& lists) {
    if (lists.first.back() > std::numeric_limits<std::uint32_t>::max())
        throw DeviceError("the field's lists are too long for a device");
    return {lists.first.begin(), lists.first.end()};
}

}  // namespace coppice::cuda
