#pragma once

#include "coppice/cuda/exec/cuda_executor.cuh"
#include "coppice/cuda/quads/project_field_internal.h"

namespace coppice::cuda {

/// Compiled only in device_quads.cu, since these kernels take the longest to compile.
/// @{
extern template void project<CudaExecutor>(QuadStages<CudaExecutor>& stages, const KernelConstants& kernel,
                                           const FieldArrays& field);
extern template std::vector<UntangleReport> unfold<CudaExecutor>(
    QuadStages<CudaExecutor>& stages, const QuadStages<CudaExecutor>::FoldSearch& search,
    const KernelConstants& kernel, const FieldArrays& field);
/// @}

}  // namespace coppice::cuda
