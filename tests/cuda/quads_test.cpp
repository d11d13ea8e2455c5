#include "quads_tests.h"

#include "coppice/cuda/exec/host_executor_internal.h"
#include "coppice/cuda/quads/device_quads.h"
#include "coppice/skeleton/random_tree.h"
#include "strict_executor.h"

namespace coppice::cuda {
namespace {

INSTANTIATE_TYPED_TEST_SUITE_P(Host, QuadStagesOn, HostExecutor);
INSTANTIATE_TYPED_TEST_SUITE_P(Strict, QuadStagesOn, StrictExecutor);

TEST(QuadStages, AreBitIdenticalForAnyNumberOfThreads) {
    const QuadCase c(zoo_skeleton("random_1"), 2);
    EXPECT_EQ(by_kernels<HostExecutor>(c, {}, {}, 1).positions,
              by_kernels<HostExecutor>(c, {}, {}, 4).positions);
}

// Tests that the memory estimate before a job is at least the used memory, and at most a third more.
TEST(BytesOf, EstimatesTheMemoryOfAJob) {
    const QuadCase c(random_tree(3000, 8), 3);
    const QuadJob job = c.job();
    StrictExecutor exec;
    QuadStages<StrictExecutor> stages(exec, job);
    const FieldArrays arrays = upload_field(exec, c.field);
    stages.make_room();
    stages.refine();
    project(stages, c.field.kernel(), arrays);
    EXPECT_GT(untangle(stages, c.field.kernel(), arrays).bad_before, 0u);
    const std::size_t entries =
        c.field.own_lists().segments.size() + c.field.competitor_lists().segments.size();
    const std::uint64_t announced = count_bytes(job, c.field.segments().size(), entries);
    EXPECT_GE(announced, exec.bytes_used());
    EXPECT_LT(announced, exec.bytes_used() * 4 / 3);
}

}  // namespace
}  // namespace coppice::cuda
