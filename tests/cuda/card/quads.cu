#include "../quads_tests.h"
#include "coppice/cuda/exec/cuda_executor.cuh"
#include "coppice/cuda/quads/project_field.cuh"

namespace coppice::cuda {
namespace {

INSTANTIATE_TYPED_TEST_SUITE_P(Card, QuadStagesOn, CudaExecutor);

}  // namespace
}  // namespace coppice::cuda
