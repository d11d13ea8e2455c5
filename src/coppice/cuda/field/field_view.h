#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/vec.h"
#include "coppice/field/kernel/axis_sum_kernel.h"
#include "coppice/field/kernel/contact_kernel.h"
#include "coppice/implicit/field_ref.h"

namespace coppice::cuda {

/// A segment in the layout of the GPU: four loads of 16 bytes.
struct alignas(16) DeviceSegment {
    kernel::SegmentConstants<float> constants;  ///< constants of the segment for the kernels
    std::uint32_t axis = 0;                     ///< see ConvolutionField::axes
};
static_assert(sizeof(DeviceSegment) == 64);

/// Active segments of each region: region r has entries first[r] .. first[r + 1].
struct RegionLists {
    std::span<const std::uint32_t> first;     ///< size is the number of regions plus one
    std::span<const std::uint32_t> segments;  ///< by lower node, sorted by axis
};

/// Data of a convolution field, except its kernel.
struct FieldArrays {
    std::span<const DeviceSegment> segments;  ///< by lower node
    RegionLists own;                          ///< segments that contribute to the value of a region
    RegionLists competitors;                  ///< competing segments in contact; empty lists without contact
    int blend = 4;                            ///< see FieldOptions
    float contact = 0;                        ///< see FieldOptions
};

/// A ConvolutionField of one kernel for sampling on the device, one point per thread. Iso value 1.
template <class Formula>
class FieldView {
  public:
    /// The arrays must outlive this object.
    FieldView(const Formula& formula, const FieldArrays& arrays) : formula_(formula), arrays_(arrays) {}

    const FieldArrays& arrays() const { return arrays_; }  ///< the sampled arrays

    /// Returns value and gradient at a point of a region: see ConvolutionField::sample.
    COPPICE_HOST_DEVICE FieldSample sample(std::uint32_t region, Vec3 p) const {
        FieldSample own = sum(arrays_.own, region, p);
        const std::uint32_t* const competitors = arrays_.competitors.first.data() + region;
        if (competitors[0] != competitors[1])
            press(sum(arrays_.competitors, region, p), arrays_.contact, own);
        return own;
    }

  private:
    using Sum = kernel::Sample<float>;

    COPPICE_HOST_DEVICE FieldSample sum(const RegionLists& lists, std::uint32_t region, Vec3 p) const {
        const std::uint32_t begin = lists.first[region], end = lists.first[region + 1];
        const kernel::Point<float> point{p.x, p.y, p.z};
        Sum total{0, 0, 0, 0}, axis{0, 0, 0, 0};
        if (begin == end) return {};
        const auto find_axis = [&](std::uint32_t k) { return arrays_.segments[lists.segments[k]].axis; };
        // The norm of a single axis is its plain sum.
        const bool blends = arrays_.blend > 1 && find_axis(begin) != find_axis(end - 1);
        std::uint32_t current = find_axis(begin);
        for (std::uint32_t k = begin; k < end; ++k) {
            const DeviceSegment& s = arrays_.segments[lists.segments[k]];
            if (blends && s.axis != current) {
                current = s.axis;
                add_power(axis, total);
                axis = {0, 0, 0, 0};
            }
            add_contribution(formula_, s.constants, point, axis);
        }
        if (blends) {
            add_power(axis, total);
            axis = root(total);
        }
        return {kernel::larger(axis.value, 0.0f), {axis.gx, axis.gy, axis.gz}};
    }

    COPPICE_HOST_DEVICE void add_power(const Sum& axis, Sum& total) const {
        switch (arrays_.blend) {
            case 2:
                return kernel::add_power<2>(axis, total);
            case 4:
                return kernel::add_power<4>(axis, total);
            default:
                return kernel::add_power<8>(axis, total);
        }
    }
    COPPICE_HOST_DEVICE Sum root(const Sum& total) const {
        switch (arrays_.blend) {
            case 2:
                return kernel::take_root<2>(total);
            case 4:
                return kernel::take_root<4>(total);
            default:
                return kernel::take_root<8>(total);
        }
    }

    Formula formula_;
    FieldArrays arrays_;
};

}  // namespace coppice::cuda
