#include "coppice/points/edit_points.h"

#include <gtest/gtest.h>

#include "points/support.h"

namespace coppice {
namespace {

using namespace points_support;

const Ball kBall;

/// Returns a lattice over a cube of side 4 about the origin: 17^3 points, some of them in the ball.
PointSet lattice() {
    PointSet set;
    for (int i = 0; i < 17 * 17 * 17; ++i) {
        set.positions.push_back(0.25f * Vec3(static_cast<float>(i % 17 - 8),
                                             static_cast<float>(i / 17 % 17 - 8),
                                             static_cast<float>(i / 289 - 8)));
    }
    return set;
}

std::size_t count_inside(const PointSet& set) {
    std::size_t n = 0;
    for (std::size_t i = 0; i < set.size(); ++i) n += length(set.world(i)) < 1;
    return n;
}

TEST(Thinned, RemovesTheExactFractionInsideAndPreservesTheOrder) {
    const PointSet all = lattice();
    const std::size_t inside = count_inside(all);
    ASSERT_GT(inside, 200u);
    for (const float percent : {0.0f, 12.5f, 80.0f, 100.0f}) {
        const PointSet left = remove_random(all, FieldRef(kBall), {.percent = percent});
        const auto gone = static_cast<std::size_t>(std::llround(static_cast<double>(inside) * percent / 100));
        EXPECT_EQ(count_inside(left), inside - gone);
        EXPECT_EQ(left.size(), all.size() - gone);
        std::size_t next = 0;  // the remaining points are a subsequence
        for (const Vec3 p : left.positions) {
            while (next < all.size() && all.positions[next] != p) ++next;
            ASSERT_LT(next, all.size());
        }
    }
}

TEST(Thinned, DependsOnTheSeedAndRespectsTheOrigin) {
    PointSet all = lattice();
    const PointSet one = remove_random(all, FieldRef(kBall), {.seed = 1}, {.threads = 1});
    EXPECT_EQ(remove_random(all, FieldRef(kBall), {.seed = 1}, {.threads = 7}), one);
    EXPECT_NE(remove_random(all, FieldRef(kBall), {.seed = 2}), one);
    all.origin = {100, 0, 0};
    EXPECT_EQ(remove_random(all, FieldRef(kBall)), all);
    EXPECT_TRUE(remove_random(PointSet{}, FieldRef(kBall)).empty());
}

TEST(Thinned, RejectsFractionsOutOfRange) {
    for (const float percent : {-1.0f, 101.0f, std::nanf("")}) {
        EXPECT_NE(error_of([&] { remove_random({}, FieldRef(kBall), {.percent = percent}); }).find("percent"),
                  std::string::npos);
    }
}

TEST(Densified, AppendsPointsAtTheMinimumDistance) {
    const PointSet old = lattice();
    const PointRegion region{FieldRef(kBall), ball_box(), DensityCurve(PointDensity::uniform, 1)};
    const PointSet more = densified(old, region, RadialKernel::disk(0.12f), {.count = 300});
    ASSERT_EQ(more.size(), old.size() + 300);
    EXPECT_TRUE(std::equal(old.positions.begin(), old.positions.end(), more.positions.begin()));
    EXPECT_GE(min_distance(more), static_cast<double>(0.12f));
    EXPECT_EQ(count_inside(more), count_inside(old) + 300);
}

}  // namespace
}  // namespace coppice
