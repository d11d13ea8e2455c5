#include <gtest/gtest.h>

#include <deque>

#include "coppice/cuda/batch/quad_run_internal.h"
#include "coppice/cuda/exec/host_executor_internal.h"
#include "coppice/skeleton/random_tree.h"
#include "lists_scene.h"
#include "on_executor.h"
#include "zoo.h"

namespace coppice::cuda {
namespace {

/// Trees at the same position, which would all be in contact with each other if they were one surface.
class ListBatch : public testing::Test {
  protected:
    struct Tree {
        Scene scene;
        ConvolutionField field;
        PatchRefinement patches;

        explicit Tree(const Skeleton& skeleton)
            : scene(wrap(skeleton)),
              field(scene.skeleton, {}),
              patches(scene.control.cage.quads,
                      static_cast<std::uint32_t>(scene.control.cage.positions.size()), 1) {}
        Tree(const Tree&) = delete;
    };

    ListBatch() {
        for (const Skeleton& s : {random_tree(120, 1, true), zoo_skeleton("random_1"), random_tree(1, 2),
                                  random_tree(120, 1, true), random_tree(90, 4)})
            trees.emplace_back(s);
        for (const Tree& t : trees) {
            contacts.push_back(make_input(t.scene, t.field));
            jobs.push_back({t.patches.cage(),
                            1,
                            t.scene.control.cage.positions,
                            t.scene.control.anchors,
                            t.scene.control.region,
                            t.scene.control.clip,
                            {},
                            {}});
        }
    }

    std::deque<Tree> trees;
    std::vector<ContactInput> contacts;
    std::vector<QuadJob> jobs;
};

using Lists = std::vector<std::vector<std::uint32_t>>;

/// Returns the lists of some regions, with segments renumbered relative to `base`.
Lists find_lists(HostExecutor& exec, const RegionLists& lists, std::size_t begin, std::size_t end,
                 std::uint32_t base) {
    const auto first = downloaded(exec, lists.first);
    const auto segments = downloaded(exec, lists.segments);
    Lists out;
    for (std::size_t r = begin; r < end; ++r) {
        out.emplace_back(segments.begin() + first[r], segments.begin() + first[r + 1]);
        for (std::uint32_t& s : out.back()) s -= base;
    }
    return out;
}

TEST_F(ListBatch, ListsMatchThoseOfEachJobAlone) {
    HostExecutor exec({.threads = 2});
    const ContactTables tables = upload_contacts(exec, contact_topology(contacts));
    const ContactGeometry geometry = upload_geometry(exec, contacts);
    const ContactsFound all =
        find_contacts(exec, tables, geometry, competitor_order(exec, tables, geometry), {});
    ASSERT_FALSE(all.state.is_cut);
    std::size_t region = 0, competitors = 0;
    std::uint32_t segment = 0;
    for (const ContactInput& input : contacts) {
        HostExecutor other;
        const ContactsFound alone = find_contacts(other, input);
        const std::size_t end = region + input.control.region_node.size();
        EXPECT_EQ(find_lists(exec, all.lists.own, region, end, segment),
                  find_lists(other, alone.lists.own, 0, end - region, 0));
        EXPECT_EQ(find_lists(exec, all.lists.competitors, region, end, segment),
                  find_lists(other, alone.lists.competitors, 0, end - region, 0));
        competitors += alone.state.entries.competitors;
        region = end;
        segment += input.skeleton.size();
    }
    EXPECT_EQ(all.lists.own.first.size(), region + 1);
    EXPECT_GT(competitors, 100u);
}

struct Made {
    Buffer<Vec3> positions;
    QuadReport report;
};

std::vector<Made> make_all(std::span<const QuadJob> jobs, std::span<const ContactInput> contacts) {
    HostExecutor exec({.threads = 2});
    QuadRun<HostExecutor> run(exec);
    EXPECT_TRUE(run.begin(jobs, contacts));
    std::vector<Made> out(jobs.size());
    std::vector<QuadPlaces> places;
    for (Made& made : out) places.push_back({&made.positions});
    const std::vector<QuadReport> reports = run.finish(places);
    const Buffer<Vec3> first = downloaded(exec, run.stages().positions());
    run.repeat();
    EXPECT_EQ(downloaded(exec, run.stages().positions()), first);
    for (std::size_t i = 0; i < out.size(); ++i) out[i].report = reports[i];
    return out;
}

TEST_F(ListBatch, SurfacesMatchThoseOfEachJobAlone) {
    const std::vector<Made> together = make_all(jobs, contacts);
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        SCOPED_TRACE(i);
        const Made alone = make_all({&jobs[i], 1}, {&contacts[i], 1}).front();
        EXPECT_EQ(together[i].positions, alone.positions);
        EXPECT_EQ(together[i].report.projected.evaluations, alone.report.projected.evaluations);
        EXPECT_EQ(together[i].report.untangled, alone.report.untangled);
    }
    EXPECT_EQ(together[0].positions, together[3].positions);  // the same tree
}

TEST_F(ListBatch, ReportsWhenNotAllJobsFitIntoMemory) {
    HostExecutor exec({}, kSlackBytes + 2 * bytes_of_job(jobs[0]));
    QuadRun<HostExecutor> run(exec);
    EXPECT_FALSE(run.begin(jobs, contacts));
}

TEST_F(ListBatch, SplitsAJobThatDoesNotFitIntoMemory) {
    const Tree large(random_tree(1500, 1));
    const ContactInput input = make_input(large.scene, large.field);
    const Scene& s = large.scene;
    const QuadJob job{large.patches.cage(),
                      1,
                      s.control.cage.positions,
                      s.control.anchors,
                      s.control.region,
                      s.control.clip,
                      {},
                      {.passes = 0}};
    // The memory of the field, and half of that of the job.
    const std::uint64_t field = bytes_of_field(4 * s.skeleton.size(), 100 * s.control.region_node.size());
    HostExecutor exec({}, kSlackBytes + field + bytes_of_job(job) / 2);
    QuadRun<HostExecutor> run(exec);
    ASSERT_TRUE(run.begin({&job, 1}, {&input, 1}));
    Made pieces;
    const QuadPlaces places{&pieces.positions};
    EXPECT_FALSE(run.finish({&places, 1}).front().is_whole);
    EXPECT_GE(run.round_count(), 2u);
    EXPECT_EQ(pieces.positions, make_all({&job, 1}, {&input, 1}).front().positions);
}

}  // namespace
}  // namespace coppice::cuda
