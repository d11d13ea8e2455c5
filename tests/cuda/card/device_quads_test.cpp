#include "coppice/cuda/quads/device_quads.h"

#include <stop_token>
#include <thread>

#include "../lists_scene.h"
#include "../on_executor.h"
#include "../quads_case.h"
#include "coppice/skeleton/random_tree.h"

namespace coppice::cuda {
namespace {

Surface on_card(DeviceQuads& device, const QuadCase& c, const UntangleOptions& unfolding = kNoUnfolding) {
    Surface out;
    device.begin(c.job({}, unfolding), c.field);
    const QuadReport report = device.finish(out.positions, &out.anchors);
    out.projected = report.projected;
    out.untangled = report.untangled;
    return out;
}

class DeviceQuadsOnCard : public OnCard {};

TEST_F(DeviceQuadsOnCard, MatchTheCpuForTheWholeZoo) {
    DeviceQuads device;
    std::size_t apart = 0, all = 0;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        for (const int levels : {0, 1, 2, 3}) {
            SCOPED_TRACE(name + ", level " + std::to_string(levels));
            const QuadCase c(skeleton, levels);
            const Surface cpu = on_cpu(c, {}, kNoUnfolding), card = on_card(device, c);
            // Collinear children have whole sides in planes of symmetry.
            expect_same(cpu, card, 0.3, 0.2);
            apart += differing(cpu, card);
            all += cpu.positions.size();
        }
    }
    EXPECT_LT(apart, all / 500);
}

TEST_F(DeviceQuadsOnCard, MatchTheCpuOfRandomTrees) {
    DeviceQuads device;
    for (const std::uint32_t segments : {30u, 300u, 3000u}) {
        for (const bool hard : {false, true}) {
            SCOPED_TRACE(testing::Message() << segments << (hard ? " hard" : ""));
            const QuadCase c(random_tree(segments, 2, hard), 2);
            // Hard skeletons have many folds, where rounding determines the ends of rays.
            expect_same(on_cpu(c, {}, kNoUnfolding), on_card(device, c), hard ? 0.01 : 1e-4);
            const UntangleReport cpu = on_cpu(c, {}, {}).untangled, card = on_card(device, c, {}).untangled;
            EXPECT_TRUE(near(cpu.bad_before, card.bad_before, 0.02))
                << cpu.bad_before << " " << card.bad_before;
            EXPECT_TRUE(near(cpu.bad_after, card.bad_after, 0.1)) << cpu.bad_after << " " << card.bad_after;
        }
    }
}

TEST_F(DeviceQuadsOnCard, ComputeTheSameSurfaceWithTheirOwnLists) {
    const Scene scene = wrap(random_tree(3000, 3));
    ConvolutionField field(scene.skeleton, {});
    const ControlMesh& control = scene.control;
    const PatchRefinement patches(control.cage.quads,
                                  static_cast<std::uint32_t>(control.cage.positions.size()), 2);
    const QuadJob job{
        patches.cage(), 2, control.cage.positions, control.anchors, control.region, control.clip, {},
        kNoUnfolding};
    DeviceQuads device;
    Surface own, given;
    ASSERT_TRUE(device.begin(job, make_input(scene, field)));
    own.projected = device.finish(own.positions, &own.anchors).projected;
    field.set_regions(make_regions(scene), scene.tree());
    device.begin(job, field);
    given.projected = device.finish(given.positions, &given.anchors).projected;
    expect_same(given, own, 1e-3);
}

TEST_F(DeviceQuadsOnCard, RunSuccessiveJobsIndependently) {
    const QuadCase small(random_tree(100, 4), 2);
    const QuadCase large(random_tree(size_for(5000, 300), 5, true), static_cast<int>(size_for(3, 2)));
    DeviceQuads device;
    const Surface first = on_card(device, small, {}), second = on_card(device, large, {});
    EXPECT_EQ(on_card(device, small, {}).positions, first.positions);
    EXPECT_EQ(on_card(device, large, {}).positions, second.positions);
    device.measure();
    for (int round = 0; round < 2; ++round) device.repeat();
    EXPECT_FALSE(device.take_times().empty());
    EXPECT_EQ(on_card(device, small, {}).positions, first.positions);
    DeviceQuads another;
    EXPECT_EQ(on_card(another, large, {}).positions, second.positions);
}

TEST_F(DeviceQuadsOnCard, RunConcurrently) {
    const QuadCase c(random_tree(1000, 6), 2);
    DeviceQuads one;
    const Surface expected = on_card(one, c, {});
    std::vector<Surface> found(4);
    {
        std::vector<std::jthread> workers;
        for (Surface& out : found) {
            workers.emplace_back([&] {
                DeviceQuads device;
                for (int round = 0; round < 5; ++round) out = on_card(device, c, {});
            });
        }
        workers.emplace_back([&] { one.begin(c.job({}, {}), c.field); });
    }
    for (const Surface& out : found) EXPECT_EQ(out.positions, expected.positions);
    Surface begun_elsewhere;
    one.finish(begun_elsewhere.positions);
    EXPECT_EQ(begun_elsewhere.positions, expected.positions);
}

TEST_F(DeviceQuadsOnCard, StopAndGoOn) {
    const QuadCase c(random_tree(300, 7), 2);
    std::stop_source source;
    DeviceQuads device(Context{.stop = source.get_token()});
    const Surface expected = on_card(device, c);
    device.begin(c.job({}, kNoUnfolding), c.field);
    source.request_stop();
    EXPECT_THROW(on_card(device, c), Cancelled);
    DeviceQuads another;
    EXPECT_EQ(on_card(another, c).positions, expected.positions);
}

TEST_F(DeviceQuadsOnCard, UseNoMoreMemoryThanEstimated) {
    for (const std::uint32_t segments : {30u, 3000u}) {
        const QuadCase c(random_tree(segments, 8), 3);
        DeviceQuads device;
        on_card(device, c, {});
        device.repeat();
        const std::uint64_t entries =
            c.field.own_lists().segments.size() + c.field.competitor_lists().segments.size();
        EXPECT_LE(device.bytes_used(), count_bytes(c.job({}, {}), c.field.segments().size(), entries));
    }
}

TEST_F(DeviceQuadsOnCard, RunInRoundsIfMemoryIsShortAndThrowIfItIsTooSmall) {
    const QuadCase c(random_tree(3000, 9), 3);
    DeviceQuads device;
    const Surface whole = on_card(device, c);
    EXPECT_EQ(device.rounds(), 1u);
    DeviceQuads small({}, count_bytes(c.job(), c.field.segments().size(), 0) / 10 * 7);
    EXPECT_EQ(on_card(small, c).positions, whole.positions);
    EXPECT_GT(small.rounds(), 1u);
    DeviceQuads tiny({}, std::size_t{1} << 16);
    EXPECT_THROW(tiny.begin(c.job(), c.field), DeviceError);
    EXPECT_EQ(on_card(device, c).positions, whole.positions);
}

}  // namespace
}  // namespace coppice::cuda
