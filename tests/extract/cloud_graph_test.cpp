#include "coppice/base/id.h"
#include "coppice/extract/points/gaps_internal.h"
#include "coppice/extract/points/graph_internal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "coppice/base/random.h"
#include "coppice/extract/points/clean_internal.h"

namespace coppice::extract_internal {
namespace {

std::vector<Vec3> strewn(std::uint64_t count, std::uint64_t seed) {
    std::vector<Vec3> points;
    const CounterRandom random(seed, 1);
    for (std::uint64_t i = 0; i < count; ++i) {
        points.push_back(
            Vec3(Vec3d{random.uniform(3 * i), random.uniform(3 * i + 1), random.uniform(3 * i + 2)}));
    }
    return points;
}

TEST(CloudGraph, NeighboursAreTheNearestPoints) {
    const auto points = strewn(300, 1);
    const Neighbours near = nearest_neighbours(points, 5, {});
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        std::vector<float> all;
        for (std::uint32_t j = 0; j < points.size(); ++j) {
            if (j != i) all.push_back(static_cast<float>(distance(Vec3d(points[i]), Vec3d(points[j]))));
        }
        std::ranges::sort(all);
        for (std::size_t k = 0; k < 5; ++k) EXPECT_FLOAT_EQ(near.distances(i)[k], all[k]);
    }
    EXPECT_EQ(nearest_neighbours(std::span(points).first(3), 5, {}).count, 2u);
}

TEST(CloudGraph, StepIsTheDistanceToThePointsNextToEach) {
    std::vector<Vec3> line, plane;
    for (int i = 0; i < 40; ++i) {
        line.push_back({0.1f * static_cast<float>(i), 0, 0});
        for (int j = 0; j < 40; ++j)
            plane.push_back({0.1f * static_cast<float>(i), 0.1f * static_cast<float>(j), 0});
    }
    // The fourth neighbour is two points away along a line, and next to the point on a surface.
    const Buffer<float> along = local_step(nearest_neighbours(line, 12, {}), 4);
    const Buffer<float> across = local_step(nearest_neighbours(plane, 12, {}), 4);
    EXPECT_NEAR(along[20], 0.1, 0.035);  // the estimated dimension of regular points on a line is 1.2
    EXPECT_NEAR(across[20 * 40 + 20], 0.1, 0.01);
}

TEST(CloudGraph, BridgesAreAMinimalSpanningTree) {
    // Clusters of one point each: compares bridges with Prim's algorithm.
    const auto points = strewn(120, 2);
    const std::vector<std::uint8_t> used(points.size(), 0);
    Components alone;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        alone.of.push_back(i);
        alone.size.push_back(1);
    }
    double sum = 0;
    const auto bridges = bridge_gaps(points, used, alone, 10, {});
    for (const Link& link : bridges) sum += link.length;
    EXPECT_EQ(bridges.size(), points.size() - 1);
    std::vector<double> reach(points.size(), 1e9);
    std::vector<bool> in(points.size(), false);
    reach[0] = 0;
    double least = 0;
    for (std::size_t turn = 0; turn < points.size(); ++turn) {
        std::size_t next = points.size();
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!in[i] && (next == points.size() || reach[i] < reach[next])) next = i;
        }
        in[next] = true;
        least += reach[next];
        for (std::size_t i = 0; i < points.size(); ++i) {
            reach[i] = std::min(reach[i], distance(Vec3d(points[i]), Vec3d(points[next])));
        }
    }
    EXPECT_NEAR(sum, least, 1e-4);
    EXPECT_TRUE(bridge_gaps(points, used, alone, 1e-6, {}).empty());
}

TEST(CloudGraph, PathsPreferManyShortSteps) {
    // A path with steps of 1 and a straight link of 3: 1 + 1 + 1 < 9.
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0.1f, 0}, {2, 0.1f, 0}, {3, 0, 0}};
    const Neighbours near = nearest_neighbours(points, 3, {});
    const Graph graph = make_graph(near, std::vector<std::uint8_t>(4, 0), {}, {});
    const std::vector<float> spacing(4, 1);
    const std::vector<std::uint32_t> root{0}, free(4, kNoIndex);
    const Paths paths = shortest_paths(graph, root, free, {spacing}, {});
    EXPECT_EQ(paths.parent[3], 2u);
    EXPECT_EQ(paths.parent[2], 1u);
    EXPECT_NEAR(paths.distance[3], 3.02, 1e-5);
}

TEST(CloudGraph, PathsFromAssignedPointsAreTheShortest) {
    // Nine of ten points are taken and are sources, some twice, most with only taken neighbours.
    const auto points = strewn(600, 6);
    const Neighbours near = nearest_neighbours(points, 4, {});
    const Graph graph = make_graph(near, std::vector<std::uint8_t>(points.size(), 0), {}, {});
    const std::vector<float> spacing = std::vector<float>(points.size(), 0.1f);
    std::vector<std::uint32_t> taken(points.size(), 0), sources;
    std::vector<double> least(points.size(), 0);
    for (std::uint32_t p = 0; p < points.size(); ++p) {
        const bool is_free = points[p].x < 0.3f && points[p].y < 0.4f && p != 0;
        if (is_free) {
            taken[p] = kNoIndex;
            least[p] = std::numeric_limits<double>::infinity();
        } else {
            sources.insert(sources.end(), p % 7 == 0 ? 2 : 1, p);
        }
    }
    const Paths paths = shortest_paths(graph, sources, taken, {spacing}, {});
    for (bool better = true; better;) {  // Bellman-Ford
        better = false;
        for (std::uint32_t p = 0; p < points.size(); ++p) {
            for (std::uint32_t e = graph.first[p]; e < graph.first[p + 1]; ++e) {
                const double share = double{graph.length[e]} / 0.1f, cost = least[p] + share * share;
                if (!(cost < least[graph.to[e]])) continue;
                least[graph.to[e]] = cost;
                better = true;
            }
        }
    }
    std::size_t reached = 0;
    for (std::uint32_t p = 0; p < points.size(); ++p) {
        if (taken[p] != kNoIndex) continue;
        EXPECT_FLOAT_EQ(paths.distance[p], static_cast<float>(least[p])) << p;
        reached += std::isfinite(least[p]);
    }
    EXPECT_GT(reached, 40u);
    EXPECT_EQ(paths.order.size(), reached);
    EXPECT_TRUE(std::ranges::is_sorted(paths.order, {}, [&](std::uint32_t p) { return paths.distance[p]; }));
    // A free source is on its path once, even if it is listed twice.
    const std::vector<std::uint32_t> free(points.size(), kNoIndex), twice{5, 5};
    EXPECT_EQ(std::ranges::count(shortest_paths(graph, twice, free, {spacing}, {}).order, 5u), 1);
}

TEST(CloudGraph, ComponentsMatchThoseOfTheGraph) {
    const auto points = strewn(400, 7);
    const Neighbours near = nearest_neighbours(points, 3, {});
    std::vector<std::uint8_t> ignored(points.size(), 0);
    for (std::size_t i = 0; i < points.size(); i += 5) ignored[i] = 1;
    const std::vector<Link> more{{1, 398, 1}, {10, 11, 1}};
    const Components expected = components(make_graph(near, ignored, more, {}, 0.08), {});
    const Components found = components(near, ignored, more, {}, 0.08);
    EXPECT_GT(expected.size.size(), 100u);
    EXPECT_EQ(found.of, expected.of);
    EXPECT_EQ(found.size, expected.size);
}

TEST(CloudGraph, StopsWhenCancelled) {
    const auto points = strewn(100, 3);
    const Neighbours near = nearest_neighbours(points, 6, {});
    std::stop_source source;
    source.request_stop();
    EXPECT_THROW(
        make_graph(near, std::vector<std::uint8_t>(points.size(), 0), {}, {.stop = source.get_token()}),
        Cancelled);
}

TEST(CloudGraph, IgnoredPointsHaveNoLinks) {
    const auto points = strewn(100, 3);
    const Neighbours near = nearest_neighbours(points, 6, {});
    std::vector<std::uint8_t> ignored(points.size(), 0);
    ignored[7] = 1;
    const Graph graph = make_graph(near, ignored, {}, {});
    EXPECT_EQ(graph.first[7], graph.first[8]);
    EXPECT_EQ(std::ranges::count(graph.to, 7u), 0);
    std::size_t both = 0;
    for (std::uint32_t i = 0; i < graph.size(); ++i) {
        for (std::uint32_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
            const std::uint32_t j = graph.to[e];
            both +=
                std::count(graph.to.begin() + graph.first[j], graph.to.begin() + graph.first[j + 1], i) == 1;
        }
    }
    EXPECT_EQ(both, graph.to.size());
}

TEST(CloudClean, SortsAndRemovesDuplicates) {
    auto points = strewn(500, 4);
    const auto once = sorted_without_duplicates(points, {});
    EXPECT_EQ(once.size(), points.size());
    points.insert(points.end(), points.begin(), points.begin() + 100);
    EXPECT_EQ(sorted_without_duplicates(points, {}), once);
    points.push_back({1e30f, 1e30f, 1e30f});  // moves all others into one cell of the sorting
    EXPECT_EQ(sorted_without_duplicates(points, {}).size(), once.size() + 1);
}

TEST(CloudClean, DownsamplesToOnePointPerVoxel) {
    const std::vector<Vec3> points{{0, 0, 0}, {0.2f, 0, 0}, {0.4f, 0, 0}, {1.5f, 0, 0}};
    const auto kept = voxel_downsample(points, 1, {});
    ASSERT_EQ(kept.size(), 2u);
    EXPECT_FLOAT_EQ(kept[0].x, 0.2f);
    EXPECT_FLOAT_EQ(kept[1].x, 1.5f);
    const auto many = strewn(5000, 5);
    const auto few = downsample_to({many.begin(), many.end()}, 700, {});
    EXPECT_LE(few.size(), 700u);
    EXPECT_GE(few.size(), 200u);
}

TEST(CloudGraph, PathsPreferStraightAndOutwardSteps) {
    // From 0 to 4 there are two paths of two equal steps: one is straight, the other one turns by 90 degrees.
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}, {2, 1, 0}};
    const std::vector<Link> links{{0, 1, 1}, {1, 2, 1}, {1, 3, 1}, {2, 4, 1}, {3, 4, 1}};
    const Graph graph = make_graph({0, {}, {}}, std::vector<std::uint8_t>(5, 1), links, {});
    const std::vector<float> spacing(5, 1);
    const std::vector<std::uint32_t> root{0}, free(5, kNoIndex);
    EXPECT_EQ(shortest_paths(graph, root, free, {spacing, points}, {}).parent[4], 2u);
    // If branches grow along y, the path begins with the step along y.
    const std::vector<Vec3> outward(5, {0, 1, 0});
    const std::vector<Vec3> aside{{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {1, 1, 0}, {1, 2, 0}};
    EXPECT_EQ(shortest_paths(graph, root, free, {spacing, aside, outward}, {}).parent[4], 2u);
}

TEST(CloudGraph, BridgesWideGapsToLargeComponentsOnly) {
    // Rows of 40 and 30 points at intervals of 0.1, a gap of 0.8 between them, and an outlier at the same
    // distance.
    std::vector<Vec3> points;
    for (int i = 0; i < 40; ++i) points.push_back({0.1f * static_cast<float>(i), 0, 0});
    for (int i = 0; i < 30; ++i) points.push_back({4.7f + 0.1f * static_cast<float>(i), 0, 0});
    points.push_back({2, 0.8f, 0});
    const std::vector<std::uint8_t> used(points.size(), 0);
    const Neighbours near = nearest_neighbours(points, 6, {});
    std::vector<std::uint8_t> ignored = used;
    ignored.back() = 1;
    const ConnectedGraph narrow = connect_points(points, near, ignored, {0.3, 0.3}, {});
    EXPECT_EQ(narrow.components.size.size(), 3u);
    const ConnectedGraph wide = connect_points(points, near, ignored, {0.3, 1.5}, {});
    EXPECT_EQ(wide.components.size.size(), 2u);
    EXPECT_EQ(wide.wide, 1u);
}

}  // namespace
}  // namespace coppice::extract_internal
