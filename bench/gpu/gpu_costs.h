#pragma once

#include <span>
#include <vector>

#include "coppice/cuda/quads/quad_job.h"
#include "coppice/field/convolution_field.h"
#include "coppice/field/field_options.h"
#include "coppice/tetra/march/march.h"
#include "gpu_case.h"

// Costs of kernels, counted in their sources: each array that is read or written counts once, independent of
// caches. Kernels that are not listed here have no cost.

namespace coppice::bench {

/// Returns the operations for one segment at one point, according to segment_kernel.h and the header of the
/// kernel; the value alone requires fewer. Excludes norms over axes, about ten more for each axis.
double flops_per_pair(Kernel kernel, bool with_gradient = true);

/// Cost of sampling a field.
struct FieldWork {
    Kernel kernel = Kernel::quartic;
    double list = 0;   ///< average number of active segments at a point
    double bytes = 0;  ///< of segments and lists

    /// Computes the cost of a field with the lists of its regions; `weight` is the number of points in each
    /// region.
    FieldWork(const ConvolutionField& field, std::span<const double> weight);
};

/// Returns the costs of DeviceQuads; `evaluations` of the field.
std::vector<KernelCost> quad_costs(const cuda::QuadJob& job, const FieldWork& field, double evaluations);

/// Returns the costs of DevicePrintedQuads, with `steps` steps of the evolution.
std::vector<KernelCost> printed_quad_costs(const cuda::QuadJob& job, const FieldWork& field, int steps);

/// Numbers of elements of explicit tetrahedra.
struct TetraCounts {
    double vertices, edges, faces, tetra;
    TetraCounts cut() const {  ///< after division of each into eight
        return {vertices + edges, 2 * edges + 3 * faces + tetra, 4 * faces + 8 * tetra, 8 * tetra};
    }
};

/// Returns the costs of DevicePrintedMarch::repeat.
std::vector<KernelCost> printed_tetra_costs(TetraCounts coarse, int levels, double triangles,
                                            const FieldWork& field);

/// Returns the costs of DeviceMarcher::march, only for sampling the field at every fine vertex.
std::vector<KernelCost> march_costs(const MarchReport& march, const FieldWork& field);

}  // namespace coppice::bench
