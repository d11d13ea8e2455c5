#include "lists_tests.h"

#include <fmt/format.h>

#include <optional>
#include <string>

#include "coppice/cuda/exec/host_executor_internal.h"
#include "strict_executor.h"
#include "workloads.h"

namespace coppice::cuda {
namespace {

INSTANTIATE_TYPED_TEST_SUITE_P(Host, ListsOn, HostExecutor);
INSTANTIATE_TYPED_TEST_SUITE_P(Strict, ListsOn, StrictExecutor);
INSTANTIATE_TYPED_TEST_SUITE_P(Host, BoxesOn, HostExecutor);
INSTANTIATE_TYPED_TEST_SUITE_P(Strict, BoxesOn, StrictExecutor);

TEST(FindContacts, MatchesTheCpuForEveryKernelAndBlend) {
    const Scene scene = wrap(zoo_skeleton("random_large_hard"));
    for (const Kernel kernel : {Kernel::quartic, Kernel::cauchy, Kernel::scalis, Kernel::balls}) {
        for (const int blend : {1, 2, 8}) {
            SCOPED_TRACE(static_cast<int>(kernel) * 10 + blend);
            expect_same(compare<HostExecutor>(scene, {.kernel = kernel, .blend = blend}));
        }
    }
    expect_same(compare<HostExecutor>(scene, {.weights = Weights::global}));
}

class Workload : public testing::TestWithParam<const char*> {};

TEST_P(Workload, ListsMatchThoseOfTheCpu) {
    const std::optional<Skeleton> tree = workload(GetParam());
    if (!tree) GTEST_SKIP() << "no workloads next to the checkout";
    for (const float graft : {0.0f, 0.6f}) {
        SCOPED_TRACE(graft);
        const Comparison c = compare<HostExecutor>(wrap(*tree, graft));
        // The CPU applies kMaxNear to several regions together, which is too few for some.
        expect_same(c, static_cast<std::uint32_t>(c.lists / 10000));
        EXPECT_GT(c.competitors, 0u);
        const ListRoom room = usual_room(c.lists);
        EXPECT_LE(c.own, room.own) << "the device would do the work twice";
        EXPECT_LE(c.competitors, room.competitors) << "the device would do the work twice";
        RecordProperty(graft > 0 ? "grafted" : "plain",
                       fmt::format("{} lists, {} own, {} competitors, longest {}, missed {}", c.lists, c.own,
                                   c.competitors, c.longest, c.missed));
    }
}
INSTANTIATE_TEST_SUITE_P(Shared, Workload,
                         testing::Values("tree300.swc", "tree300hard.swc", "tree3k.swc", "tree3khard.swc",
                                         "tree30k.swc"),
                         [](const auto& test) {
                             const std::string name = test.param;
                             return name.substr(0, name.find('.'));
                         });

TEST(ContactTopology, RequiresTubesInDepthFirstOrderAndContact) {
    // The second child of the root precedes the child of the first one.
    const Skeleton skeleton({NodeId::none(), NodeId(0), NodeId(0), NodeId(1)},
                            {{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 0, 2}}, {0.1f, 0.1f, 0.1f, 0.1f});
    const Scene broad = in_boxes(skeleton, std::vector<Box3>(4));
    EXPECT_THROW(contact_topology(make_input(broad, ConvolutionField(skeleton, {}))), PreconditionBroken);
    const Scene scene = in_boxes(stems(2, 1, 0.1f), std::vector<Box3>(4));
    EXPECT_THROW(contact_topology(make_input(scene, ConvolutionField(scene.skeleton, {.contact = 0}))),
                 PreconditionBroken);
}

TEST(SortRanks, SortsListsOfAnyLength) {
    std::mt19937 random(1);
    for (std::uint32_t count = 0; count < 600; count += 1 + count / 10) {
        std::vector<std::uint32_t> list(count);
        for (std::uint32_t& rank : list) rank = static_cast<std::uint32_t>(random() % 1000);
        std::vector<std::uint32_t> sorted = list;
        std::ranges::sort(sorted);
        sort_ranks(list.data(), count);
        EXPECT_EQ(list, sorted);
    }
}

}  // namespace
}  // namespace coppice::cuda
