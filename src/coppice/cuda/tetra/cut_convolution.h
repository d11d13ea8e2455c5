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

/// Flat ends of trees, and the regions of the field that they affect.
struct EndCuts {
    std::vector<tetra_kernel::EndCut> cuts;   ///< all ends
    CompressedRows<std::uint32_t> of_region;  ///< indices in `cuts`; no rows if there are no cuts
};

/// A convolution field truncated at flat ends, which a GPU can sample.
struct CutConvolution {
    const ConvolutionField& field;  ///< field before truncation
    const EndCuts& ends;            ///< flat ends

    float level() const { return field.level(); }  ///< iso value of the surface
    /// Computes values and gradients at points of a region. Thread safe.
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

/// A truncated field for kernels, in arrays in any memory.
template <class Field>
struct CutFieldView {
    Field field;                                 ///< field before truncation
    std::span<const tetra_kernel::EndCut> cuts;  ///< see EndCuts
    /// The rows of EndCuts::of_region.
    /// @{
    std::span<const std::uint32_t> first, of_region;
    /// @}
    float level;  ///< of the field

    /// Returns value and gradient at a point of a region.
    COPPICE_HOST_DEVICE FieldSample sample(std::uint32_t region, Vec3 p) const {
        FieldSample s = field.sample(region, p);
        if (cuts.empty()) return s;
        for (std::uint32_t k = first[region]; k < first[region + 1]; ++k)
            tetra_kernel::cut_off(cuts[of_region[k]], level, p, s);
        return s;
    }
};

/// Copies flat ends to an executor, for a field that is already there.
template <class Exec, class Field>
CutFieldView<Field> upload_cuts(Exec& exec, const Field& field, const EndCuts& ends, float level) {
    return {field, exec.upload(std::span<const tetra_kernel::EndCut>(ends.cuts)),
            exec.upload(std::span<const std::uint32_t>(ends.of_region.first)),
            exec.upload(std::span<const std::uint32_t>(ends.of_region.items)), level};
}

}  // namespace cuda
}  // namespace coppice
