#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/kernel/host_device.h"
#include "coppice/field/convolution_field.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/tetra/march/kernel/end_cut_kernel.h"

namespace coppice {

/// Where trees end flat, and in which regions of the field that is felt.
struct EndCuts {
    std::vector<tetra_kernel::EndCut> cuts;   ///< all of them
    CompressedRows<std::uint32_t> of_region;  ///< places in `cuts`; no rows when there are none at all
};

/// A convolution field cut off at flat ends, which a card can sample.
struct CutConvolution {
    const ConvolutionField& field;  ///< what is cut off
    const EndCuts& ends;            ///< where

    float level() const { return field.level(); }  ///< on the surface
    /// Value and gradient at points of a region. Thread safe.
    void sample(std::uint32_t region, std::span<const Vec3> points, std::span<FieldSample> out) const {
        field.sample(region, points, out);
        if (ends.cuts.empty()) return;
        for (const std::uint32_t cut : ends.of_region[region]) {
            for (std::size_t i = 0; i < points.size(); ++i)
                tetra_kernel::cut_off(ends.cuts[cut], level(), points[i], out[i]);
        }
    }
};

namespace cuda {

/// The same as kernels sample it, in arrays that lie anywhere.
template <class Field>
struct CutFieldView {
    Field field;                                 ///< what is cut off
    std::span<const tetra_kernel::EndCut> cuts;  ///< see EndCuts
    /// The rows of EndCuts::of_region.
    /// @{
    std::span<const std::uint32_t> first, of_region;
    /// @}
    float level;  ///< of the field

    /// Value and gradient at a point of a region.
    COPPICE_HOST_DEVICE FieldSample sample(std::uint32_t region, Vec3 p) const {
        FieldSample s = field.sample(region, p);
        if (cuts.empty()) return s;
        for (std::uint32_t k = first[region]; k < first[region + 1]; ++k)
            tetra_kernel::cut_off(cuts[of_region[k]], level, p, s);
        return s;
    }
};

/// Copies flat ends to an executor, about a field that lies there.
template <class Exec, class Field>
CutFieldView<Field> upload_cuts(Exec& exec, const Field& field, const EndCuts& ends, float level) {
    return {field, exec.upload(std::span<const tetra_kernel::EndCut>(ends.cuts)),
            exec.upload(std::span<const std::uint32_t>(ends.of_region.first)),
            exec.upload(std::span<const std::uint32_t>(ends.of_region.items)), level};
}

}  // namespace cuda
}  // namespace coppice
