#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/cuda/field/field_view.h"
#include "coppice/field/convolution_field.h"
#include "coppice/field/kernel/ball_kernel.h"
#include "coppice/field/kernel/cauchy_kernel.h"
#include "coppice/field/kernel/quartic_kernel.h"
#include "coppice/field/kernel/scalis_kernel.h"

namespace coppice::cuda {

/// Calls use(formula) with the kernel function of a field in single precision.
template <class Use>
void with_formula(const KernelConstants& constants, const Use& use) {
    switch (constants.kernel) {
        case Kernel::quartic:
            return use(kernel::QuarticKernel<float>(constants.shape, constants.weight));
        case Kernel::cauchy:
            return use(kernel::CauchyKernel<float>(constants.shape, constants.weight));
        case Kernel::scalis:
            return use(kernel::ScalisKernel<float>());
        case Kernel::balls:
            return use(kernel::BallKernel<float>(constants.shape, constants.weight));
    }
}

/// Returns the segments of a field in the layout of the GPU, with axes offset by the number of preceding
/// segments.
std::vector<DeviceSegment> device_segments(const ConvolutionField& field, std::uint32_t others = 0);

/// Several fields as one: the segments and the regions of each follow those of the previous one. They must
/// have the same kernel, blend and contact.
struct JoinedFields {
    /// See FieldArrays.
    /// @{
    std::vector<DeviceSegment> segments;
    std::vector<std::uint32_t> own_first, own;
    std::vector<std::uint32_t> competitor_first, competitors;
    /// @}

    /// Requires at least one field. Throws DeviceError if there are more than 2^32 entries.
    explicit JoinedFields(std::span<const ConvolutionField* const> fields);
};

/// Copies fields with their lists into the arrays of an executor, as one field.
template <class Exec>
FieldArrays upload_fields(Exec& exec, std::span<const ConvolutionField* const> fields) {
    const JoinedFields all(fields);
    const auto upload = [&]<class T>(const std::vector<T>& values) {
        return exec.upload(std::span<const T>(values));
    };
    return {upload(all.segments),
            {upload(all.own_first), upload(all.own)},
            {upload(all.competitor_first), upload(all.competitors)},
            fields.front()->blend(),
            fields.front()->contact()};
}

/// Copies a single field.
template <class Exec>
FieldArrays upload_field(Exec& exec, const ConvolutionField& field) {
    const ConvolutionField* const one = &field;
    return upload_fields(exec, std::span(&one, 1));
}

}  // namespace coppice::cuda
