#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "coppice/base/random.h"
#include "coppice/cuda/batch/march_tiles_internal.h"
#include "coppice/cuda/exec/host_executor_internal.h"
#include "coppice/cuda/tetra/march_stages_internal.h"
#include "cuda/march_support.h"
#include "cuda/strict_executor.h"
#include "cuda/tetra_scene.h"
#include "tetra/support.h"

namespace coppice::cuda {
namespace {

TEST(TetraPieces, PreserveTheOrderOfTetrahedraAndVertices) {
    const TetraMesh mesh = shuffled(bcc_block({3, 3, 20}, 1, {0, 0, 0}), 1);
    const TetraRefinement whole(mesh, 2);
    const IndexRange regions{70, 80};
    std::size_t before = 0;
    for (const int rings : {0, 1, 3, 100}) {
        SCOPED_TRACE(rings);
        const TetraTile tile(whole, regions, rings);
        const TetraMesh& taken = tile.mesh();
        EXPECT_GT(taken.tetra.size(), before);
        before = taken.tetra.size();
        EXPECT_EQ(tile.is_closed(), rings == 100);
        EXPECT_EQ(tile.tetra(static_cast<std::uint32_t>(tile.own().begin)), mesh.first[70]);
        EXPECT_EQ(tile.own().size(), mesh.first[80] - mesh.first[70]);
        ASSERT_EQ(taken.region_count(), tile.regions().size());
        EXPECT_EQ(taken.first.back(), taken.tetra.size());
        std::vector<std::uint32_t> number(taken.positions.size());
        for (std::uint32_t r = 0; r < taken.region_count(); ++r) {
            const std::uint32_t of = tile.regions()[r];
            for (std::uint32_t t = taken.first[r]; t < taken.first[r + 1]; ++t) {
                const std::uint32_t original = tile.tetra(t);
                EXPECT_TRUE(mesh.first[of] <= original && original < mesh.first[of + 1]);
                EXPECT_TRUE(t == 0 || tile.tetra(t - 1) < original);
                for (std::size_t k = 0; k < 4; ++k) {
                    number[taken.tetra[t][k]] = mesh.tetra[original][k];
                    EXPECT_EQ(taken.positions[taken.tetra[t][k]], mesh.positions[mesh.tetra[original][k]]);
                }
            }
        }
        EXPECT_TRUE(std::ranges::is_sorted(number));
    }
}

TEST(TetraPieces, ContainTheRowsOfTheirRegions) {
    const TetraMesh mesh = bcc_block({3, 3, 20}, 1, {0, 0, 0});
    const TetraRefinement whole(mesh, 1);
    const TetraTile tile(whole, {30, 40}, 1);
    const auto rows = compress_rows<std::uint32_t>(mesh.region_count(), [](const auto& put) {
        for (std::uint32_t i = 0; i < 300; ++i) put(i % 90, i);
    });
    const auto taken = tile.rows(rows);
    ASSERT_EQ(taken.size(), tile.regions().size());
    for (std::size_t r = 0; r < taken.size(); ++r)
        EXPECT_TRUE(std::ranges::equal(taken[r], rows[tile.regions()[r]]));
    EXPECT_EQ(tile.rows({}).size(), 0u);
}

/// Executes march() in tiles, for any field that does not depend on the region.
template <class F>
MarchResult march_in(std::size_t count, const TetraMesh& mesh, const F& field, const MarchOptions& options) {
    MarchTiles tiles(mesh, options.levels, count);
    while (const TetraTile* tile = tiles.next()) {
        HostExecutor exec;
        DeviceRefinement refinement = upload_coarse(exec, tile->mesh(), options.levels);
        refinement.own_begin = static_cast<std::uint32_t>(tile->own().begin);
        refinement.own_end = static_cast<std::uint32_t>(tile->own().end);
        EXPECT_TRUE(refine(exec, refinement));
        const SnapField<PointField<F>> at{{&field}, tetra_kernel::Profile(field.level()), options.snap};
        tiles.put(download_march(exec, refinement,
                                 march_own(exec, refinement, PassingAxes{}, at, options.refinements)));
    }
    return tiles.join(false);
}

// Noise creates more folds than any tree, so that vertices are moved back in many rounds.
TEST(MarchTiles, AreBitIdenticalToMarchOnNoise) {
    std::uint64_t freed = 0;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        const std::array<std::uint32_t, 3> cells{4, 4, seed == 3 ? 60u : 24u};
        TetraMesh mesh = bcc_block(cells, 1, {0, 0, 0});
        if (seed > 0) mesh = shuffled(bent(mesh, 0.12f, seed), seed);
        for (int levels = 0; levels <= 2; ++levels) {
            SCOPED_TRACE(testing::Message() << seed << " levels " << levels);
            const AnyField field =
                noise(seed, 1.7f * static_cast<float>(1 << levels), {4, 4, static_cast<float>(cells[2])});
            const MarchOptions options{.levels = levels};
            const MarchResult expected = march(mesh, FieldRef(field), options);
            ASSERT_GT(expected.mesh.triangles.size(), 100u);
            freed += expected.report.freed;
            for (const std::size_t count : {1u, 2u, 7u})
                expect_same(march_in(count, mesh, field, options), expected);
        }
    }
    EXPECT_GT(freed, 1000u);
}

// The result of the first tile at its border is invalid if another one needs more rounds.
TEST(MarchTiles, ReturnAgainWithMoreTetrahedraAfterMoreRounds) {
    const TetraMesh mesh = bcc_block({3, 3, 60}, 1, {0, 0, 0});
    MarchTiles tiles(mesh, 2, 2);
    const auto size_of_next = [&](int rounds) {
        const TetraTile* tile = tiles.next();
        const std::size_t size = tile == nullptr ? 0 : tile->mesh().tetra.size();
        TileMarch march;
        march.rounds = rounds;
        if (tile != nullptr) tiles.put(march);
        return size;
    };
    const std::size_t first = size_of_next(2), second = size_of_next(20);
    EXPECT_GT(size_of_next(20), first);
    EXPECT_GT(size_of_next(20), second);
    EXPECT_EQ(size_of_next(0), 0u);
}

TEST(MarchTiles, ReportTheSameOpenFaces) {
    const TetraMesh mesh = bcc_block({4, 4, 24}, 1, {0, 0, 0});
    const KernelField field = ball_field({0.9f, 2, 12}, 1.7f);
    const MarchResult expected = march(mesh, FieldRef(field), {});
    ASSERT_FALSE(expected.open.empty());
    for (const std::size_t count : {2u, 5u}) expect_same(march_in(count, mesh, field, {}), expected);
}

/// A tree, and the result of march() without tiles.
struct WholeTree {
    WholeTree(const Skeleton& tree, int levels, float edge) : scene(tree, levels, edge) {
        HostExecutor exec;
        expected = downloaded(exec, march(exec, upload_march(exec, input())).value());
        bytes = exec.bytes_used();
    }
    MarchInput input() const { return {scene.mesh(), scene.field, scene.axes, scene.options}; }

    CutScene scene;
    MarchResult expected;
    std::size_t bytes = 0;  ///< memory used
};

TEST(MarchTiles, AreBitIdenticalToMarchOfTreesInLessMemory) {
    for (const bool hard : {false, true}) {
        for (int levels = 1; levels <= 2; ++levels) {
            SCOPED_TRACE(testing::Message() << "hard " << hard << " levels " << levels);
            const WholeTree tree(random_tree(250, 5, hard), levels, 0.6f);
            const std::size_t room = tree.bytes / 10 * 7;
            for (const unsigned threads : {1u, 2u}) {
                HostExecutor exec({.threads = threads}, room);
                expect_same(march_in_tiles(exec, tree.input(), {.threads = threads}), tree.expected);
                EXPECT_LE(exec.bytes_used(), room);
            }
        }
    }
}

TEST(MarchTiles, MatchMarchOnTheStrictExecutor) {
    const WholeTree tree(random_tree(150, 4, true), 1, 0.6f);
    StrictExecutor exec;
    expect_same(march_in_tiles(exec, tree.input()), tree.expected);
}

TEST(MarchTiles, ThrowIfMemoryIsTooSmall) {
    const WholeTree tree(random_tree(100, 5), 1, 0.5f);
    for (const std::size_t room : {std::size_t{1} << 14, tree.bytes / 20}) {
        HostExecutor exec({}, room);
        EXPECT_THROW(march_in_tiles(exec, tree.input()), DeviceFull);
    }
}

TEST(MarchTiles, RejectTheInputThatMarchRejects) {
    const WholeTree tree(random_tree(20, 5), 1, 0.5f);
    TetraMesh bad = tree.scene.mesh();
    std::swap(bad.tetra[5][0], bad.tetra[5][1]);
    HostExecutor exec;
    EXPECT_THROW(march_in_tiles(exec, {bad, tree.scene.field, tree.scene.axes, tree.scene.options}),
                 InvalidInput);
    const MarchOptions options{.levels = 9};
    EXPECT_THROW(march_in_tiles(exec, {tree.scene.mesh(), tree.scene.field, tree.scene.axes, options}),
                 InvalidInput);
}

}  // namespace
}  // namespace coppice::cuda
