#include "coppice/cuda/field/upload_field_internal.h"

#include <limits>

#include "coppice/base/error.h"
#include "coppice/cuda/device.h"

namespace coppice::cuda {
namespace {

// Appends lists of segments with numbers offset by `segments`.
void append(const CandidateLists& lists, std::uint32_t segments, std::vector<std::uint32_t>& first,
            std::vector<std::uint32_t>& items) {
    const std::size_t base = items.size();
    if (base + lists.segments.size() > std::numeric_limits<std::uint32_t>::max())
        throw DeviceError("the field's lists are too long for a device");
    for (std::size_t r = 1; r < lists.first.size(); ++r)
        first.push_back(static_cast<std::uint32_t>(base + lists.first[r]));
    for (const std::uint32_t s : lists.segments) items.push_back(segments + s);
}

}  // namespace

std::vector<DeviceSegment> device_segments(const ConvolutionField& field, std::uint32_t others) {
    std::vector<DeviceSegment> out(field.segments().size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = {field.segments()[i], others + field.axes()[i]};
    return out;
}

JoinedFields::JoinedFields(std::span<const ConvolutionField* const> fields)
    : own_first{0}, competitor_first{0} {
    for (const ConvolutionField* const field : fields) {
        COPPICE_ASSERT(field->kernel().kernel == fields.front()->kernel().kernel &&
                       field->blend() == fields.front()->blend());
        const auto base = static_cast<std::uint32_t>(segments.size());
        append(field->own_lists(), base, own_first, own);
        append(field->competitor_lists(), base, competitor_first, competitors);
        const std::vector<DeviceSegment> more = device_segments(*field, base);
        segments.insert(segments.end(), more.begin(), more.end());
    }
}

}  // namespace coppice::cuda
