#pragma once

#include <vector>

#include "coppice/cuda/field/field_view.h"
#include "coppice/field/convolution_field.h"
#include "coppice/field/kernel/ball_kernel.h"
#include "coppice/field/kernel/cauchy_kernel.h"
#include "coppice/field/kernel/quartic_kernel.h"
#include "coppice/field/kernel/scalis_kernel.h"

namespace coppice::cuda {

/// Calls use(formula) with the kernel of a field in single precision.
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

/// The segments of a field as a card reads them.
std::vector<DeviceSegment> device_segments(const ConvolutionField& field);

/// Lists with offsets of 32 bits. Throws DeviceError when there are more than 2^32 entries.
std::vector<std::uint32_t> device_offsets(const CandidateLists& lists);

/// Copies a field with its lists into the arrays of an executor.
template <class Exec>
FieldArrays upload_field(Exec& exec, const ConvolutionField& field) {
    const auto upload_lists = [&](const CandidateLists& lists) {
        return RegionLists{exec.upload(std::span<const std::uint32_t>(device_offsets(lists))),
                           exec.upload(std::span<const std::uint32_t>(lists.segments))};
    };
    return {exec.upload(std::span<const DeviceSegment>(device_segments(field))),
            upload_lists(field.own_lists()), upload_lists(field.rival_lists()), field.blend(),
            field.contact()};
}

}  // namespace coppice::cuda
