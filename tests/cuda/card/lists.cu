#include "../lists_tests.h"
#include "coppice/cuda/exec/cuda_executor.cuh"

namespace coppice::cuda {
namespace {

INSTANTIATE_TYPED_TEST_SUITE_P(Card, ListsOn, CudaExecutor);
INSTANTIATE_TYPED_TEST_SUITE_P(Card, BoxesOn, CudaExecutor);

}  // namespace
}  // namespace coppice::cuda
