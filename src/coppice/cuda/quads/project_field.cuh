#pragma once

#include "coppice/cuda/exec/cuda_executor.cuh"
#include "coppice/cuda/quads/project_field.h"

namespace coppice::cuda {

/// Compiled in one place, since these are the kernels that take the longest: device_quads.cu.
/// @{
extern template void project<CudaExecutor>(QuadStages<CudaExecutor>& stages, const KernelConstants& kernel,
                                           const FieldArrays& field);
extern template std::vector<UntangleReport> unfold<CudaExecutor>(
    QuadStages<CudaExecutor>& stages, const QuadStages<CudaExecutor>::FoldSearch& search,
    const KernelConstants& kernel, const FieldArrays& field);
/// @}

}  // namespace coppice::cuda
