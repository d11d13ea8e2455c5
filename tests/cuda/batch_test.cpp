#include <gtest/gtest.h>

#include <memory>
#include <tuple>

#include "coppice/cuda/batch/quad_run_internal.h"
#include "coppice/cuda/exec/host_executor_internal.h"
#include "coppice/skeleton/random_tree.h"
#include "on_executor.h"
#include "quads_case.h"
#include "zoo.h"

namespace coppice::cuda {
namespace {

struct Made {
    Buffer<Vec3> positions, anchors;
    QuadReport report;
};

auto compute_counts(const ProjectReport& r) {
    return std::tuple(r.vertices, r.evaluations, r.max_evaluations, r.not_converged, r.anchors_outside,
                      r.clipped);
}

void expect_same_bits(const Made& a, const Made& b) {
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(a.anchors, b.anchors);
    EXPECT_EQ(compute_counts(a.report.projected), compute_counts(b.report.projected));
    EXPECT_EQ(a.report.untangled, b.report.untangled);
}

std::vector<Made> finish(QuadRun<HostExecutor>& run, std::size_t count) {
    std::vector<Made> out(count);
    std::vector<QuadPlaces> places;
    for (Made& made : out) places.push_back({&made.positions, &made.anchors});
    const std::vector<QuadReport> reports = run.finish(places);
    for (std::size_t i = 0; i < count; ++i) out[i].report = reports[i];
    return out;
}

std::vector<Made> make_all(std::span<const QuadTask> tasks,
                           HostExecutor exec = HostExecutor({.threads = 2})) {
    QuadRun<HostExecutor> run(exec);
    run.begin(tasks);
    return finish(run, tasks.size());
}

/// A case with two additional vertices without quads at the end.
struct LoneVertices {
    const QuadCase& of;
    Buffer<Vec3> positions, anchors;
    PatchRefinement patches;

    LoneVertices(const QuadCase& c)
        : of(c),
          positions(with_two(c.control.cage.positions)),
          anchors(with_two(c.control.anchors)),
          patches(c.control.cage.quads, static_cast<std::uint32_t>(positions.size()), c.patches.levels()) {}
    QuadTask task(const QuadTask& with) const {
        QuadTask out = with;
        out.job.cage = patches.cage();
        out.job.positions = positions;
        out.job.anchors = anchors;
        return out;
    }

  private:
    static Buffer<Vec3> with_two(Buffer<Vec3> points) {
        points.push_back({1, 2, 3});
        points.push_back({4, 5, 6});
        return points;
    }
};

constexpr FieldOptions kOverTheEnds{.tip_extension = 1.5f};

ControlOptions ends(TipShape tips, BaseShape base) {
    ControlOptions out;
    out.tips = tips;
    out.base = base;
    return out;
}

/// Cages of different sizes: round ends, flat ones, a hole at the base, a vertex without quads, a single
/// ball.
class Batch : public testing::Test {
  protected:
    static constexpr int kLevels = 2;
    QuadCase round{zoo_skeleton("random_1"), kLevels, kOverTheEnds};
    QuadCase flat{zoo_skeleton("random_1"), kLevels, kOverTheEnds, ends(TipShape::flat, BaseShape::flat)};
    QuadCase open{random_tree(40, 3), kLevels, kOverTheEnds, ends(TipShape::round, BaseShape::open)};
    QuadCase small{random_tree(1, 2), kLevels, kOverTheEnds};
    LoneVertices lone{small};

    static QuadTask task(const QuadCase& c, const ProjectOptions& project = {}) {
        return {c.job(project), &c.field};
    }
    std::vector<QuadTask> tasks(const ProjectOptions& project = {}) const {
        return {task(round, project), lone.task(task(small, project)), task(open, project),
                task(flat, project), task(small, project)};
    }
};

TEST_F(Batch, FixtureHasTheIntendedCases) {
    EXPECT_FALSE(flat.control.clip.empty());
    EXPECT_FALSE(open.patches.cage().closed());
    EXPECT_TRUE(round.patches.cage().closed());
    EXPECT_TRUE(lone.patches.cage().fan(static_cast<std::uint32_t>(lone.positions.size() - 1)).empty());
}

TEST_F(Batch, SurfacesMatchThoseOfEachJobAlone) {
    for (const ProjectOptions& project :
         {ProjectOptions{}, ProjectOptions{.method = ProjectionMethod::gradient, .relax_passes = 2}}) {
        const std::vector<QuadTask> all = tasks(project);
        const std::vector<Made> together = make_all(all);
        std::uint64_t unfolded = 0;
        for (std::size_t i = 0; i < all.size(); ++i) {
            SCOPED_TRACE(i);
            expect_same_bits(together[i], make_all({&all[i], 1}).front());
            unfolded += together[i].report.untangled.moved;
        }
        EXPECT_GT(unfolded, 0u);
        EXPECT_EQ(together[1].positions[lone.positions.size() - 1], (Vec3{4, 5, 6}));
    }
}

TEST_F(Batch, IsEmptyForNoJobs) { EXPECT_TRUE(make_all({}).empty()); }

TEST_F(Batch, RunsSeveralRoundsIfMemoryIsShort) {
    const std::vector<QuadTask> all = tasks();
    const std::vector<Made> together = make_all(all);
    // The largest fits by itself, but not with another.
    std::uint64_t most = 0;
    for (const QuadTask& t : all) {
        const auto entries =
            t.field->own_lists().segments.size() + t.field->competitor_lists().segments.size();
        most = std::max(most, bytes_of_job(t.job) + bytes_of_field(t.field->segments().size(), entries));
    }
    HostExecutor exec({}, kSlackBytes + most);
    QuadRun<HostExecutor> run(exec);
    run.begin(all);
    const std::vector<Made> in_rounds = finish(run, all.size());
    EXPECT_GT(run.round_count(), 1u);
    for (std::size_t i = 0; i < all.size(); ++i) {
        SCOPED_TRACE(i);
        expect_same_bits(together[i], in_rounds[i]);
        EXPECT_TRUE(in_rounds[i].report.is_whole);
    }
}

TEST_F(Batch, RepeatComputesTheSamePositions) {
    HostExecutor exec;
    QuadRun<HostExecutor> run(exec);
    run.begin(tasks());
    const std::vector<Made> made = finish(run, tasks().size());
    const Buffer<Vec3> first = downloaded(exec, run.stages().positions());
    const std::size_t used = exec.bytes_used();
    run.repeat();
    EXPECT_EQ(downloaded(exec, run.stages().positions()), first);
    run.repeat();
    EXPECT_EQ(downloaded(exec, run.stages().positions()), first);
    EXPECT_EQ(downloaded(exec, run.stages().normals()).size(), first.size());
    EXPECT_GE(exec.bytes_used(), used);
}

/// Assembles a whole from tiles of `quads` cage quads each.
Made pieced_together(const QuadTask& task, std::size_t quads) {
    const QuadJob& job = task.job;
    Made out;
    out.positions.resize(refined_counts(job.cage, job.levels).vertices);
    std::fill(out.positions.begin(), out.positions.end(), Vec3{-1, -1, -1});
    out.anchors = out.positions;
    for (std::size_t begin = 0; begin < job.cage.face_count();) {
        const std::size_t end = QuadTile::cut(job.clips, {begin, job.cage.face_count()}, begin + quads);
        const QuadTile tile(job, {begin, end});
        HostExecutor exec;
        QuadStages<HostExecutor> stages(exec, tile.job());
        stages.refine();
        cuda::project(stages, task.field->kernel(), upload_field(exec, *task.field));
        tile.put(downloaded(exec, stages.positions()), out.positions);
        tile.put(downloaded(exec, stages.anchors()), out.anchors);
        out.report.projected += stages.projected();
        begin = end;
    }
    return out;
}

TEST_F(Batch, PiecesAreBitIdenticalToTheWhole) {
    for (const int relax_passes : {0, 1, 3}) {
        for (QuadTask t : tasks({.relax_passes = relax_passes})) {
            SCOPED_TRACE(std::to_string(relax_passes) + " " + std::to_string(t.job.cage.face_count()));
            t.job.untangle = kNoUnfolding;
            const Made whole = make_all({&t, 1}).front();
            for (const std::size_t quads : {9, 40}) expect_same_bits(pieced_together(t, quads), whole);
        }
    }
}

TEST(QuadTile, PiecesOfTheZooAreBitIdenticalToTheWhole) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        if (skeleton.size() > 100) continue;
        for (const int levels : {0, 2}) {
            SCOPED_TRACE(name + ", level " + std::to_string(levels));
            const QuadCase c(skeleton, levels, kOverTheEnds, ends(TipShape::flat, BaseShape::flat));
            const QuadTask task{c.job({.relax_passes = 1}, {.passes = 0}), &c.field};
            expect_same_bits(pieced_together(task, 16), make_all({&task, 1}).front());
        }
    }
}

TEST_F(Batch, SplitsAJobThatDoesNotFitIntoMemory) {
    const QuadCase large(random_tree(1200, 1), kLevels, kOverTheEnds, ends(TipShape::flat, BaseShape::flat));
    QuadTask task{large.job(), &large.field};
    const auto entries =
        large.field.own_lists().segments.size() + large.field.competitor_lists().segments.size();
    const std::uint64_t field = bytes_of_field(large.field.segments().size(), entries);
    // A third of the required memory: at least four tiles, because each has surrounding quads.
    HostExecutor exec({}, kSlackBytes + field + bytes_of_job(task.job) / 3);
    QuadRun<HostExecutor> run(exec);
    run.begin({&task, 1});
    const Made tiles = finish(run, 1).front();
    EXPECT_GE(run.round_count(), 4u);
    EXPECT_LE(run.round_count(), 16u);
    EXPECT_FALSE(tiles.report.is_whole);
    EXPECT_EQ(tiles.report.untangled, UntangleReport{});
    task.job.untangle.passes = 0;
    expect_same_bits(make_all({&task, 1}).front(), tiles);
}

TEST_F(Batch, ReportsTheFreeMemoryIfItDoesNotSuffice) {
    const QuadTask t = task(round);
    HostExecutor exec({}, kSlackBytes);
    QuadRun<HostExecutor> run(exec);
    try {
        run.begin({&t, 1});
        FAIL() << "there was room although the memory is 0";
    } catch (const DeviceError& e) {
        EXPECT_NE(std::string(e.what()).find("16 MiB of memory free"), std::string::npos) << e.what();
    }
}

TEST_F(Batch, UsesNoMoreMemoryThanEstimated) {
    const QuadCase large(random_tree(1200, 1), kLevels);
    for (const QuadTask& t : {task(large), task(large, {.relax_passes = 1}), task(flat)}) {
        const auto entries =
            t.field->own_lists().segments.size() + t.field->competitor_lists().segments.size();
        HostExecutor exec;
        QuadRun<HostExecutor> run(exec);
        run.begin({&t, 1});
        finish(run, 1);
        run.repeat();
        const std::uint64_t announced =
            bytes_of_job(t.job) + bytes_of_field(t.field->segments().size(), entries);
        // The slack includes the rounding of array sizes.
        EXPECT_LE(exec.bytes_used(), announced + kSlackBytes / 64);
        EXPECT_GE(exec.bytes_used(), announced * 3 / 4);
        RecordProperty("bytes_per_quad",
                       std::to_string(exec.bytes_used() / refined_counts(t.job.cage, t.job.levels).quads));
    }
}

TEST(QuadTile, DoesNotSplitAFlatEnd) {
    std::vector<ClipPlane> clips(2);
    clips[0].first_quad = 3;
    clips[0].quad_count = 4;  // [3, 7)
    clips[1].first_quad = 8;
    clips[1].quad_count = 4;  // [8, 12)
    EXPECT_EQ(QuadTile::cut(clips, {0, 20}, 2), 2u);
    EXPECT_EQ(QuadTile::cut(clips, {0, 20}, 5), 3u);
    EXPECT_EQ(QuadTile::cut(clips, {3, 20}, 5), 7u);
    EXPECT_EQ(QuadTile::cut(clips, {8, 12}, 10), 12u);
    EXPECT_EQ(QuadTile::cut(clips, {0, 20}, 30), 20u);
    EXPECT_EQ(QuadTile::cut(clips, {19, 20}, 19), 20u);
}

TEST_F(Batch, RoundsFollowTheFreeMemory) {
    const QuadJob job = round.job();
    const std::vector<QuadJob> jobs(5, job);
    const std::vector<JobBytes> bytes{{600, 200}, {100, 100}, {50, 50}, {3000, 100}, {100, 0}};
    const std::vector<BatchRound> rounds = plan_batch(jobs, bytes, kSlackBytes + 1000);
    // 800 + 200 fit, and 100 more do not; then 3100, of which a quarter of the quads fits; then 100.
    ASSERT_GE(rounds.size(), 5u);
    const auto expect_range = [](IndexRange range, std::size_t begin, std::size_t end) {
        EXPECT_EQ(range.begin, begin);
        EXPECT_EQ(range.end, end);
    };
    expect_range(rounds[0].jobs, 0, 2);
    expect_range(rounds[1].jobs, 2, 3);
    expect_range(rounds[2].jobs, 3, 4);
    expect_range(rounds.back().jobs, 4, 5);
    for (const BatchRound& r : rounds) EXPECT_EQ(r.is_tile, r.jobs.begin == 3);
    const std::size_t quads = job.cage.face_count();
    expect_range(rounds[2].quads, 0, quads / 4);  // (1000 - 100) / (1.2 * 3000) = 1/4
    const auto [half, other_half] = split(rounds[2], job, 2000, 1000);
    expect_range(half.quads, 0, quads / 4 / 2);
    expect_range(other_half.quads, quads / 4 / 2, quads / 4);
    EXPECT_THROW(split({{3, 4}, true, {7, 8}}, job, 2000, 1000), DeviceError);
}

}  // namespace
}  // namespace coppice::cuda
