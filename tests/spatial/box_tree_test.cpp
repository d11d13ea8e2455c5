#include "coppice/spatial/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "coppice/base/random.h"

namespace coppice {
namespace {

/// Returns boxes of very different sizes; every fifth touches the previous one exactly in a face.
std::vector<Box3> boxes(std::uint32_t n) {
    const CounterRandom random(3, n);
    std::vector<Box3> out;
    for (std::uint32_t i = 0; i < n; ++i) {
        const auto draw = [&](std::uint32_t k) { return static_cast<float>(random.uniform(8 * i + k)); };
        Vec3 low{draw(0), draw(1), draw(2)};
        if (i % 5 == 4) low = {out.back().high.x, out.back().low.y, out.back().low.z};
        const float size = 0.2f * draw(6) * draw(6) * draw(6);
        out.push_back({low, low + size * Vec3{draw(3), draw(4), draw(5)}});
    }
    return out;
}

using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

TEST(BoxTree, FindsEveryOverlapOnce) {
    for (const std::uint32_t n : {0u, 1u, 2u, 8u, 9u, 64u, 65u, 700u}) {
        const auto all = boxes(n);
        Pairs expected, found;
        for (std::uint32_t i = 0; i < n; ++i) {
            for (std::uint32_t j = i + 1; j < n; ++j) {
                if (all[i].overlaps(all[j])) expected.emplace(i, j);
            }
        }
        const BoxTree tree(all, {});
        std::size_t visits = 0;
        for (std::uint32_t g = 0; g < tree.group_count(); ++g) {
            tree.overlaps(g, [&](std::uint32_t p, std::uint32_t q) {
                found.insert(std::minmax(tree.item(p), tree.item(q)));
                ++visits;
            });
        }
        EXPECT_EQ(found, expected) << n;
        EXPECT_EQ(visits, expected.size()) << n;
    }
}

TEST(BoxTree, SearchFindsTheNearestBox) {
    const auto all = boxes(500);
    const BoxTree tree(all, {});
    for (const Vec3d p : {Vec3d{0.5, 0.5, 0.5}, Vec3d{-3, 0.2, 0.9}, Vec3d{1, 1, 1}, Vec3d{100, 100, -100}}) {
        double expected = 1e300, least = 1e300;
        for (const Box3& b : all) expected = std::min(expected, distance_squared(b, p));
        std::size_t visits = 0;
        tree.search([&](std::uint32_t l, std::uint32_t i) { return distance_squared(tree.level(l)[i], p); },
                    least,
                    [&](std::uint32_t item) {
                        ++visits;
                        least = std::min(least, distance_squared(all[item], p));
                    });
        EXPECT_EQ(least, expected);
        EXPECT_LT(visits, 50u);
    }
}

TEST(BoxTree, AcceptsEqualAndExtremeBoxes) {
    constexpr float kMax = std::numeric_limits<float>::max();
    std::vector<Box3> all(100, Box3{{1, 1, 1}, {1, 1, 1}});
    all.push_back({{-kMax, -kMax, -kMax}, {kMax, kMax, kMax}});
    const BoxTree tree(all, {});
    std::size_t visits = 0;
    for (std::uint32_t g = 0; g < tree.group_count(); ++g) tree.overlaps(g, [&](auto, auto) { ++visits; });
    EXPECT_EQ(visits, 101u * 100 / 2);
}

TEST(BoxTree, IsBitIdenticalForAnyNumberOfThreads) {
    const auto all = boxes(100'000);
    const BoxTree one(all, {.threads = 1});
    for (const unsigned threads : {2u, 7u}) {
        const BoxTree tree(all, {.threads = threads});
        for (std::uint32_t p = 0; p < one.size(); ++p) ASSERT_EQ(tree.item(p), one.item(p));
    }
}

TEST(ExtendOutward, ContainsThePoint) {
    for (const double x : {0.1, -0.1, 1e300, -1e300, 0.0, 16777217.0}) {
        Box3 box;
        extend_outward(box, {x, 0, 0});
        constexpr double kMax = std::numeric_limits<float>::max();
        const double clamped = std::clamp(x, -kMax, kMax);
        EXPECT_LE(box.low.x, clamped);
        EXPECT_GE(box.high.x, clamped);
        EXPECT_TRUE(is_finite(box.low) && is_finite(box.high));
    }
}

}  // namespace
}  // namespace coppice
