#pragma once

#include "coppice/cuda/exec/cuda_executor.cuh"
#include "coppice/cuda/field/field_view.h"
#include "coppice/cuda/quads/quad_stages.h"
#include "coppice/field/kernel/kernel_constants.h"

namespace coppice::cuda {

/// QuadStages::project and QuadStages::untangle with whatever kernel a field has: compiled in one place,
/// since these are the kernels that take the longest.
/// @{
void project(QuadStages<CudaExecutor>& stages, const KernelConstants& kernel, const FieldArrays& field);
UntangleReport untangle(QuadStages<CudaExecutor>& stages, const KernelConstants& kernel,
                        const FieldArrays& field);
/// @}

}  // namespace coppice::cuda
