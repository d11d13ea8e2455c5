#pragma once

#include <span>
#include <vector>

#include "coppice/cuda/quads/quad_job.h"
#include "coppice/field/convolution_field.h"
#include "coppice/field/field_options.h"
#include "coppice/tetra/march/march.h"
#include "gpu_case.h"

// What kernels do, counted in their sources: each array that is read or written counts once, whatever the
// caches do. Kernels that are not named here have no cost.

namespace coppice::bench {

/// Of one segment at one point, in segment_kernel.h and the header of the kernel; the value alone takes less.
/// Norms over axes, some ten more for each axis, are left out.
double flops_per_pair(Kernel kernel, bool with_gradient = true);

/// The work of asking a field.
struct FieldWork {
    Kernel kernel = Kernel::quartic;
    double list = 0;   ///< segments that count at a point, on average
    double bytes = 0;  ///< of segments and lists

    /// Of a field whose lists are those of its regions; `weight` tells how many points lie in each.
    FieldWork(const ConvolutionField& field, std::span<const double> weight);
};

/// Of DeviceQuads; `evaluations` of the field.
std::vector<KernelCost> quad_costs(const cuda::QuadJob& job, const FieldWork& field, double evaluations);

/// Of DevicePrintedQuads, with so many steps of the evolution.
std::vector<KernelCost> printed_quad_costs(const cuda::QuadJob& job, const FieldWork& field, int steps);

/// Tetrahedra that are written down, with their edges and faces.
struct TetraCounts {
    double vertices, edges, faces, tetra;
    TetraCounts cut() const {  ///< each into eight
        return {vertices + edges, 2 * edges + 3 * faces + tetra, 4 * faces + 8 * tetra, 8 * tetra};
    }
};

/// Of DeviceMarcher::repeat, after a march as printed.
std::vector<KernelCost> printed_tetra_costs(TetraCounts coarse, int levels, double triangles,
                                            const FieldWork& field);

/// Of DeviceMarcher::march, asking the field at every fine vertex alone.
std::vector<KernelCost> march_costs(const MarchReport& march, const FieldWork& field);

}  // namespace coppice::bench
