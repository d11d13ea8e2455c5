#include "coppice/pipeline/repair/crossings_internal.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "coppice/skeleton/random_tree.h"
#include "tube_row_search.h"
#include "zoo.h"

namespace coppice {
namespace {

using namespace test;

MeshOptions with(int levels, int sides, TipShape tips = TipShape::round, BaseShape base = BaseShape::flat) {
    MeshOptions options;
    options.levels = levels;
    options.control = {sides, tips, base};
    return options;
}

TEST(TubeCrossings, MatchTheWholeMeshOnTheZoo) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        expect_same(skeleton);
        expect_same(skeleton, with(0, 8, TipShape::flat, BaseShape::round));
        expect_same(skeleton, with(1, 4, TipShape::flat, BaseShape::open));
    }
}

TEST(TubeCrossings, MatchTheWholeMeshAtEveryLevelAndNumberOfSides) {
    for (int levels = 0; levels <= 6; ++levels) {
        const std::uint32_t size = levels < 4 ? 60 : 8;
        for (const int sides : {4, 8, 16}) {
            if (levels > 4 && sides > 4) continue;  // a million quads without additional coverage
            SCOPED_TRACE(testing::Message() << levels << " levels, " << sides << " sides");
            expect_same(random_tree(size, 3), with(levels, sides));
            expect_same(random_tree(size, 4, true), with(levels, sides, TipShape::flat));
        }
    }
}

// Cages without grafting and unfolding cross themselves in many ways.
TEST(TubeCrossings, MatchTheWholeMeshWithManySelfIntersections) {
    std::size_t pairs = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        SCOPED_TRACE(seed);
        MeshOptions options = with(1 + static_cast<int>(seed % 3), 4);
        options.graft = 0;
        options.untangle.passes = 0;
        pairs += expect_same(random_tree(300, seed, true), options);
    }
    EXPECT_GT(pairs, 1000u);
}

// Units have quads between their tubes, including roots, and many quads cross without unfolding.
TEST(TubeCrossings, MatchTheWholeMeshOnRamifications) {
    std::size_t pairs = 0;
    for (const int levels : {1, 2, 3}) {
        SCOPED_TRACE(testing::Message() << levels << " levels");
        MeshOptions options = with(levels, 4);
        options.method = MeshMethod::ramifications;
        for (const auto& [name, skeleton] : skeleton_zoo()) {
            SCOPED_TRACE(name);
            for (const BaseShape base : {BaseShape::flat, BaseShape::round}) {
                options.control.base = base;
                expect_same(skeleton, options);
            }
        }
        expect_same(random_tree(300, 5), options);
        options.untangle.passes = 0;
        for (const bool additional : {false, true}) {
            options.ramification.all_additional = additional;
            for (std::uint64_t seed = 0; seed < 4; ++seed)
                pairs += expect_same(random_tree(200, seed, true), options);
        }
    }
    EXPECT_GT(pairs, 1000u);
}

// Each vertex is displaced separately: a fold that only touches its own row, or a spike that reaches others.
void expect_same_when_vertices_are_moved(const Quads& quads) {
    const std::size_t count = quads.surface.mesh.positions.size();
    const Box3 box = [&] {
        Box3 all;
        for (const Vec3 p : quads.surface.mesh.positions) all.extend(p);
        return all;
    }();
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < 120; ++i) {
        const std::size_t v = i * 7919 % count;
        SCOPED_TRACE(v);
        QuadMesh mesh = quads.surface.mesh;
        const Vec3 other = i % 2 == 0 ? box.center() : mesh.positions[(v + 1 + i % 30) % count];
        mesh.positions[v] = lerp(mesh.positions[v], other, i % 3 == 0 ? 0.3f : 1.2f);
        const std::vector<FacePair> all = search(mesh);
        EXPECT_EQ(tube_row_search(quads, mesh), all);
        pairs += all.empty() ? 0 : 1;
    }
    EXPECT_GT(pairs, 60u);
}

TEST(TubeCrossings, MatchTheWholeMeshWithMovedVertices) {
    MeshOptions options = with(2, 4);
    expect_same_when_vertices_are_moved(make_quads(random_tree(40, 5), options));
    options.method = MeshMethod::ramifications;
    options.levels = 3;
    expect_same_when_vertices_are_moved(make_quads(random_tree(40, 5), options));
}

TEST(TubeCrossings, AreBitIdenticalForAnyNumberOfThreads) {
    const Quads quads = make_quads(random_tree(2000, 1, true), with(1, 4));
    const auto one = tube_row_search(quads, quads.surface.mesh, {.threads = 1});
    EXPECT_FALSE(one.empty());
    for (const unsigned threads : {2u, 7u}) {
        EXPECT_EQ(tube_row_search(quads, quads.surface.mesh, {.threads = threads}), one);
    }
}

// Few quads remain to be searched on a tree with branches that are clear of each other.
TEST(TubeCrossings, AreExcludedForMostQuadsWithoutASearch) {
    const Quads quads = make_quads(random_tree(3000, 1), {});
    const pipeline_internal::TubeRows tube_rows(quads.surface.cage, quads.tubes, quads.levels);
    const std::size_t left = unproved_quads(quads.surface.mesh, tube_rows, {}).size();
    EXPECT_LT(left, quads.surface.mesh.quads.size() / 45);
}

}  // namespace
}  // namespace coppice
