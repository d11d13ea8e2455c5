#include "coppice/spatial/kd_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "coppice/base/random.h"

namespace coppice {
namespace {

std::vector<Vec3> random_points(std::size_t count) {
    const CounterRandom random(1, 0);
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) {
        const auto draw = [&](std::size_t axis) { return random.uniform(3 * i + axis); };
        points.push_back(Vec3(Vec3d{draw(0), draw(1), 0.01 * draw(2)}));
    }
    return points;
}

double squared(Vec3 a, Vec3 b) { return length_squared(Vec3d(a) - Vec3d(b)); }

TEST(KdTree, MatchesExhaustiveSearch) {
    const std::vector<Vec3> points = random_points(2000);
    const KdTree tree(points);
    constexpr std::size_t kCount = 7;
    for (const Vec3 p : random_points(100)) {
        std::vector<double> expected;
        for (const Vec3 q : points) expected.push_back(squared(p, q));
        std::ranges::sort(expected);
        std::array<std::uint32_t, kCount> index{};
        std::array<double, kCount> found{};
        tree.nearest(p, index, found);
        for (std::size_t k = 0; k < kCount; ++k) {
            EXPECT_EQ(found[k], expected[k]);
            EXPECT_EQ(squared(p, points[index[k]]), found[k]);
        }
        EXPECT_EQ(tree.nearest(p).squared, expected[0]);
    }
}

TEST(KdTree, AcceptsCoincidentPoints) {
    const std::vector<Vec3> heap(5000, Vec3{1, 2, 3});
    const KdTree tree(heap);
    EXPECT_EQ(tree.nearest({1, 2, 5}).squared, 4);
    std::vector<std::uint32_t> index(heap.size());
    std::vector<double> distance(heap.size());
    tree.nearest({1, 2, 3}, index, distance);
    EXPECT_EQ(std::accumulate(distance.begin(), distance.end(), 0.0), 0);
}

TEST(KdTree, ConstructionStopsWhenCancelled) {
    std::stop_source source;
    source.request_stop();
    EXPECT_THROW(KdTree(random_points(50'000), {.stop = source.get_token()}), Cancelled);
}

TEST(KdTree, AcceptsOnePoint) {
    const std::vector<Vec3> one{{1, 0, 0}};
    const KdTree tree(one);
    EXPECT_EQ(tree.nearest({3, 0, 0}).index, 0u);
    EXPECT_EQ(tree.nearest({3, 0, 0}).squared, 4);
}

}  // namespace
}  // namespace coppice
