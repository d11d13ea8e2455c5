#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "coppice/base/hash.h"
#include "coppice/base/id.h"
#include "coppice/base/random.h"
#include "coppice/growth/attractor_set_internal.h"

namespace coppice {
namespace {

std::vector<Vec3> random_points(std::size_t count, std::uint64_t stage) {
    const CounterRandom random(7, stage);
    std::vector<Vec3> points;
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto draw = [&](std::uint64_t k) { return static_cast<float>(random.uniform(3 * i + k)); };
        points.push_back({draw(0), draw(1), draw(2)});
    }
    return points;
}

struct Expected {
    std::vector<Vec3d> pull;
    std::vector<std::uint32_t> count;
    std::vector<std::uint32_t> left;
};

/// The same in batches by testing all pairs.
Expected brute_force(const std::vector<Vec3>& attractors, const std::vector<Vec3>& nodes, std::size_t batch,
                     float influence, float kill) {
    Expected e{std::vector<Vec3d>(nodes.size()), std::vector<std::uint32_t>(nodes.size()), {}};
    for (std::uint32_t a = 0; a < attractors.size(); ++a) {
        float best = influence * influence;
        std::size_t nearest = nodes.size();
        bool spent = false;
        for (std::size_t n = 0; n < nodes.size() && !spent; ++n) {
            const float d = length_squared(attractors[a] - nodes[n]);
            if (d < best) {
                best = d;
                nearest = n;
            }
            if ((n + 1) % batch == 0) spent = best <= kill * kill;
        }
        if (spent || best <= kill * kill) continue;
        e.left.push_back(a);
        if (nearest == nodes.size()) continue;
        e.pull[nearest] += normalized(Vec3d(attractors[a]) - Vec3d(nodes[nearest]));
        ++e.count[nearest];
    }
    return e;
}

TEST(AttractorSet, MatchesExhaustiveSearch) {
    for (const std::size_t count : {1u, 7u, 8u, 9u, 65u, 2000u}) {
        const std::vector<Vec3> attractors = random_points(count, 0), nodes = random_points(400, 1);
        const float influence = 0.2f, kill = 0.05f;
        AttractorSet set(attractors, influence, kill, {});
        std::vector<Pull> pulls(nodes.size());
        for (std::uint32_t first = 0; first < nodes.size(); first += 100) {
            set.add_nodes(std::span(nodes).first(first + 100), first, pulls, {});
        }
        const Expected expected = brute_force(attractors, nodes, 100, influence, kill);
        EXPECT_EQ(set.remaining(), expected.left);
        EXPECT_EQ(set.spent(), count - expected.left.size());
        for (std::size_t n = 0; n < nodes.size(); ++n) {
            EXPECT_EQ(pulls[n].count, expected.count[n]) << n;
            const Vec3d pull = Vec3d(static_cast<double>(pulls[n].x), static_cast<double>(pulls[n].y),
                                     static_cast<double>(pulls[n].z)) *
                               0x1p-30;
            EXPECT_LT(distance(pull, expected.pull[n]), 1e-6) << n;
        }
    }
}

// Batches of several ranges, shared by threads: each visits most attractors many times.
TEST(AttractorSet, IsBitIdenticalForAnyNumberOfThreads) {
    const std::vector<Vec3> attractors = random_points(5000, 0), nodes = random_points(8000, 1);
    std::uint64_t first_hash = 0;
    for (const unsigned threads : {1u, 2u, 7u, 7u}) {
        AttractorSet set(attractors, 0.5f, 0.01f, {.threads = threads});
        std::vector<Pull> pulls(nodes.size());
        for (std::uint32_t first = 0; first < nodes.size(); first += 2000) {
            set.add_nodes(std::span(nodes).first(first + 2000), first, pulls, {.threads = threads});
        }
        const std::vector<std::uint32_t> left = set.remaining();
        ASSERT_LT(left.size(), attractors.size());
        const std::uint64_t hash = Hash().add(std::span(std::as_const(pulls))).add(std::span(left)).value();
        if (first_hash == 0) first_hash = hash;
        EXPECT_EQ(hash, first_hash) << threads;
    }
}

TEST(AttractorSet, PullIsZeroAfterAttractorsChangeTheirNode) {
    const std::vector<Vec3> attractors{{1, 0.3f, 0.2f}, {0.9f, -0.1f, 0.7f}};
    const std::vector<Vec3> nodes{{0, 0, 0}, {0.5f, 0, 0.3f}};
    AttractorSet set(attractors, 5, 0.1f, {});
    std::vector<Pull> pulls(2);
    set.add_nodes(std::span(nodes).first(1), 0, pulls, {});
    EXPECT_EQ(pulls[0].count, 2u);
    set.add_nodes(nodes, 1, pulls, {});
    EXPECT_EQ(pulls[0].count, 0u);
    EXPECT_EQ(pulls[0].x, 0);
    EXPECT_EQ(pulls[0].y, 0);
    EXPECT_EQ(pulls[0].z, 0);
    EXPECT_EQ(pulls[0].changed, 1);
    EXPECT_EQ(pulls[1].count, 2u);
}

TEST(AttractorSet, FindsTheNearestAttractorOfANodeAndOfAll) {
    const std::vector<Vec3> attractors{{1, 0, 0}, {3, 0, 0}, {0, 0.5f, 0}};
    const std::vector<Vec3> nodes{{0, 0, 0}, {2.5f, 0, 0}};
    AttractorSet set(attractors, 2, 0.1f, {});
    std::vector<Pull> pulls(2);
    set.add_nodes(nodes, 0, pulls, {});
    const auto of_first = set.find_nearest(0, nodes[0]);
    EXPECT_EQ(set.position(of_first.place), attractors[2]);
    EXPECT_FLOAT_EQ(of_first.distance_squared, 0.25f);
    EXPECT_EQ(set.position(set.find_nearest(1, nodes[1]).place), attractors[1]);
    EXPECT_EQ(set.position(set.nearest({2.2f, 0, 0}).place), attractors[1]);
    set.drop(of_first.place, pulls);
    EXPECT_EQ(set.position(set.find_nearest(0, nodes[0]).place), attractors[0]);
    EXPECT_EQ(pulls[0].count, 1u);
    // A dropped attractor is still assigned to a node that is nearer.
    const std::vector<Vec3> more{nodes[0], nodes[1], {0, 0.2f, 0}};
    pulls.resize(3);
    set.add_nodes(more, 2, pulls, {});
    EXPECT_EQ(pulls[2].count, 1u);
}

TEST(AttractorSet, AcceptsAnEmptySet) {
    AttractorSet set({}, 1, 0.5f, {});
    std::vector<Pull> pulls(1);
    const std::vector<Vec3> nodes{{0, 0, 0}};
    set.add_nodes(nodes, 0, pulls, {});
    EXPECT_EQ(set.nearest({}).place, kNoIndex);
    EXPECT_TRUE(set.remaining().empty());
}

}  // namespace
}  // namespace coppice
