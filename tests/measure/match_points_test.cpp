#include "coppice/measure/match/match_points_internal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "coppice/base/id.h"
#include "coppice/base/random.h"

namespace coppice {
namespace {

using measure_internal::match_points;
using Matches = std::vector<std::uint32_t>;

Matches match(const std::vector<Vec3d>& a, double reach, const std::vector<Vec3d>& b, unsigned threads = 1) {
    return match_points(a, std::vector<double>(a.size(), reach), b, {.threads = threads});
}

std::vector<Vec3d> cloud(std::size_t count, std::uint64_t seed) {
    const CounterRandom random(seed, 0);
    std::vector<Vec3d> points(count);
    for (std::size_t i = 0; i < count; ++i)
        points[i] = {random.uniform(3 * i), random.uniform(3 * i + 1), random.uniform(3 * i + 2)};
    return points;
}

/// All pairs, sorted.
Matches by_trying_all(const std::vector<Vec3d>& a, double reach, const std::vector<Vec3d>& b) {
    std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> pairs;
    for (std::uint32_t i = 0; i < a.size(); ++i) {
        for (std::uint32_t j = 0; j < b.size(); ++j)
            if (distance(a[i], b[j]) <= reach) pairs.emplace_back(distance(a[i], b[j]), i, j);
    }
    std::sort(pairs.begin(), pairs.end());
    Matches of_a(a.size(), kNoIndex), of_b(b.size(), kNoIndex);
    for (const auto& [d, i, j] : pairs) {
        if (of_a[i] != kNoIndex || of_b[j] != kNoIndex) continue;
        of_a[i] = j;
        of_b[j] = i;
    }
    return of_a;
}

TEST(MatchPoints, PairsTheNearestPointsFirst) {
    // 1.0 is nearest to 1.2, so 0.0 is paired with 2.0, which is farther than 1.2.
    EXPECT_EQ(match({{0, 0, 0}, {1, 0, 0}}, 3, {{1.2, 0, 0}, {2, 0, 0}}), (Matches{1, 0}));
    EXPECT_EQ(match({{0, 0, 0}, {1, 0, 0}}, 1.9, {{1.2, 0, 0}, {2, 0, 0}}), (Matches{kNoIndex, 0}));
}

TEST(MatchPoints, ReachBelongsToTheFirstSet) {
    EXPECT_EQ(match_points(std::vector<Vec3d>{{0, 0, 0}, {5, 0, 0}}, std::vector<double>{1, 2},
                           std::vector<Vec3d>{{0, 0, 1.5}, {5, 0, 1.5}}, {}),
              (Matches{kNoIndex, 1}));
}

TEST(MatchPoints, AcceptsEmptySets) {
    EXPECT_EQ(match({}, 1, {{0, 0, 0}}), Matches{});
    EXPECT_EQ(match({{0, 0, 0}}, 1, {}), Matches{kNoIndex});
}

TEST(MatchPoints, MatchesExhaustiveSearch) {
    const auto a = cloud(300, 1), b = cloud(250, 2);
    for (const double reach : {0.01, 0.05, 0.15})
        EXPECT_EQ(match(a, reach, b), by_trying_all(a, reach, b)) << reach;
}

TEST(MatchPoints, CoincidentPointsAllHaveAPartner) {
    const std::vector<Vec3d> a(20000, Vec3d{1, 2, 3});
    Matches m = match(a, 1, a);
    std::sort(m.begin(), m.end());
    for (std::uint32_t i = 0; i < m.size(); ++i) ASSERT_EQ(m[i], i);
}

TEST(MatchPoints, WorstCaseTerminates) {
    // Every point of a prefers the same point of b, then the same next one, and so on: the worst case.
    std::vector<Vec3d> a, b;
    for (int i = 0; i < 20000; ++i) {
        a.push_back({-1e-6 * i, 0, 0});
        b.push_back({1e-6 * i, 0, 0});
    }
    const Matches m = match(a, 1, b);
    EXPECT_EQ(m[0], 0u);
    const auto matched = std::count_if(m.begin(), m.end(), [](std::uint32_t i) { return i != kNoIndex; });
    EXPECT_GE(matched, 32);
}

TEST(MatchPoints, IsBitIdenticalForAnyNumberOfThreads) {
    const auto a = cloud(2000, 3), b = cloud(2000, 4);
    const Matches one = match(a, 0.05, b, 1);
    EXPECT_EQ(one, match(a, 0.05, b, 2));
    EXPECT_EQ(one, match(a, 0.05, b, 7));
}

}  // namespace
}  // namespace coppice
