#include "coppice/growth/guard.h"

#include <gtest/gtest.h>

#include <limits>

#include "coppice/base/error.h"
#include "coppice/base/random.h"
#include "coppice/growth/grow.h"
#include "errors.h"
#include "growth/fields.h"

namespace coppice {
namespace {

const SphereField kBall{{0, 0, 0}, 1};

/// Points outside a surface, at most `depth` away from it.
template <class Field>
std::vector<Vec3> shell_points(const Field& field, std::size_t count, float depth, double box) {
    const CounterRandom random(3, 0);
    std::vector<Vec3> points;
    for (std::uint64_t i = 0; points.size() < count; ++i) {
        const auto draw = [&](std::uint64_t k) {
            return static_cast<float>(random.uniform(3 * i + k, -box, box));
        };
        const Vec3 p{draw(0), draw(1), draw(2)};
        FieldSample v;
        field.sample(0, {&p, 1}, {&v, 1});
        if (v.value < 0 && v.value > -depth) points.push_back(p);
    }
    return points;
}

TEST(Guard, AllowsPointsBySideShellAndClearance) {
    const Guard outside{FieldRef(kBall)};
    EXPECT_TRUE(outside.allows({1.1f, 0, 0}));
    EXPECT_FALSE(outside.allows({0.9f, 0, 0}));
    const Guard shell(FieldRef(kBall), {.shell = 0.2f});
    EXPECT_TRUE(shell.allows({1.1f, 0, 0}));
    EXPECT_FALSE(shell.allows({1.3f, 0, 0}));
    EXPECT_FALSE(shell.allows({0.9f, 0, 0}));
    const Guard inside(FieldRef(kBall), {.side = GuardSide::inside, .clearance = 0.3f});
    EXPECT_TRUE(inside.allows({0.5f, 0, 0}));
    EXPECT_FALSE(inside.allows({0.8f, 0, 0}));
    EXPECT_FALSE(inside.allows({1.1f, 0, 0}));
    const Guard hollow(FieldRef(kBall), {.side = GuardSide::inside, .shell = 0.2f});
    EXPECT_TRUE(hollow.allows({0.9f, 0, 0}));
    EXPECT_FALSE(hollow.allows({0.5f, 0, 0}));
}

TEST(Guard, ChecksSegmentsAlongTheirLength) {
    const Guard outside{FieldRef(kBall)};
    EXPECT_FALSE(outside.allows_segment({-2, 0, 0.5f}, {2, 0, 0.5f}));
    EXPECT_TRUE(outside.allows_segment({-2, 0, 1.5f}, {2, 0, 1.5f}));
    EXPECT_FALSE(outside.allows_segment({0, 0, 0.5f}, {0, 0, 3}));
}

TEST(Guard, StepsStraightIfFreeAndSlidesOtherwise) {
    const Guard outside{FieldRef(kBall)};
    const auto away = outside.step({0, 0, 1.05f}, {0, 0, 1}, 0.2f);
    ASSERT_TRUE(away);
    EXPECT_FLOAT_EQ(away->z, 1.25f);
    const auto slid = outside.step({0, 0, 1.05f}, normalized(Vec3{1, 0, -1}), 0.2f);
    ASSERT_TRUE(slid);
    EXPECT_GT(slid->x, 0.1f);
    EXPECT_NEAR(distance(*slid, {0, 0, 1.05f}), 0.2f, 1e-6f);
    EXPECT_TRUE(outside.allows_segment({0, 0, 1.05f}, *slid));
}

TEST(Guard, ReturnsNoStepIfThereIsNone) {
    // A shell much thinner than the step: any segment of that length leaves it.
    const Guard thin(FieldRef(kBall), {.shell = 0.01f});
    EXPECT_FALSE(thin.step({0, 0, 1.005f}, {1, 0, 0}, 0.9f));
}

struct NoField {
    float level() const { return 0; }
    void sample(std::uint32_t, std::span<const Vec3>, std::span<FieldSample> out) const {
        const float nan = std::numeric_limits<float>::quiet_NaN();
        for (FieldSample& s : out) s = {nan, {nan, nan, nan}};
    }
};

TEST(Guard, NonFiniteFieldAllowsNothing) {
    const NoField field;
    const Guard guard{FieldRef(field)};
    EXPECT_FALSE(guard.allows({0, 0, 0}));
    EXPECT_FALSE(guard.allows_segment({0, 0, 0}, {1, 0, 0}));
    EXPECT_FALSE(guard.step({0, 0, 0}, {1, 0, 0}, 1));
}

TEST(Guard, RejectsOptionsOutOfRange) {
    const float kNan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(Guard(FieldRef(kBall), {.shell = -1}), InvalidInput);
    EXPECT_THROW(Guard(FieldRef(kBall), {.shell = kNan}), InvalidInput);
    EXPECT_THROW(Guard(FieldRef(kBall), {.clearance = -0.1f}), InvalidInput);
    EXPECT_THROW(Guard(FieldRef(kBall), {.clearance = 1e9f}), InvalidInput);
}

TEST(Guard, RejectsRootsInTheExcludedRegion) {
    const Guard outside{FieldRef(kBall)};
    const std::vector<Root> roots{{{0, 0, 2}, {}}, {{0, 0, 0.5f}, {}}};
    const std::string error = test::error_of([&] { grow({.roots = roots, .guard = &outside}); });
    EXPECT_NE(error.find("root 1"), std::string::npos) << error;
}

// Figure 7.7 a of the thesis: two marker points on opposite sides of a bulge pull a node into the solid.
TEST(Guard, AttractorsAroundABulgeCauseNoBranchesInside) {
    const std::vector<Vec3> attractors{{1.05f, 0, 0}, {-1.05f, 0, 0}};
    const std::vector<Root> roots{{{0, 0, 1.05f}, {}}};
    const GrowOptions options{.influence_radius = 3, .kill_radius = 0.1f, .step = 0.05f};
    const GrowResult bare = grow({.attractors = attractors, .roots = roots}, options);
    EXPECT_GT(range_along(bare.skeleton, kBall).high, 0.1f);  // deep inside

    const Guard guard{FieldRef(kBall)};
    const GrowResult kept = grow({.attractors = attractors, .roots = roots, .guard = &guard}, options);
    EXPECT_LT(range_along(kept.skeleton, kBall).high, 0);
    EXPECT_EQ(kept.stop, StopReason::attractors_spent);
}

// Figure 7.7 b: points on the far side of a torus pull branches away from its surface, across the hole.
TEST(Guard, BranchesFollowTheSurfaceOfATorus) {
    const TorusField torus{1, 0.3f};
    const std::vector<Vec3> attractors = shell_points(torus, 4000, 0.08f, 1.5);
    const std::vector<Root> roots{{{1.34f, 0, 0}, {}}};
    const GrowOptions options{.influence_radius = 2, .kill_radius = 0.08f, .step = 0.04f};
    const GrowResult bare = grow({.attractors = attractors, .roots = roots}, options);
    const FieldRange wild = range_along(bare.skeleton, torus);
    EXPECT_GT(wild.high, 0.01f);

    const Guard guard(FieldRef(torus), {.shell = 0.12f});
    const GrowResult kept = grow({.attractors = attractors, .roots = roots, .guard = &guard}, options);
    const FieldRange range = range_along(kept.skeleton, torus);
    EXPECT_LT(range.high, 0);
    EXPECT_GT(range.low, -0.12f);
    EXPECT_LT(kept.unreached.size(), attractors.size() / 50);
}

TEST(Guard, AttractorsAcrossAHoleAreNotReachedThroughIt) {
    const TorusField torus{1, 0.3f};
    // From the inner rim towards the opposite one: only air between.
    const std::vector<Vec3> attractors{{-0.65f, 0, 0}, {-0.64f, 0.05f, 0}};
    const std::vector<Root> roots{{{0.65f, 0, 0}, {}}};
    const GrowOptions options{.influence_radius = 5, .kill_radius = 0.1f, .step = 0.05f};
    const GrowResult bare = grow({.attractors = attractors, .roots = roots}, options);
    EXPECT_LT(range_along(bare.skeleton, torus).low, -0.5f);
    const Guard guard(FieldRef(torus), {.shell = 0.15f});
    const GrowResult kept = grow({.attractors = attractors, .roots = roots, .guard = &guard}, options);
    const FieldRange range = range_along(kept.skeleton, torus);
    EXPECT_LT(range.high, 0);
    EXPECT_GT(range.low, -0.15f);
}

TEST(Guard, BranchesRemainInsideWithClearance) {
    std::vector<Vec3> attractors = shell_points(SphereField{{0, 0, 0}, 0}, 2000, 1.2f, 1.2);
    const std::vector<Root> roots{{{0, 0, -0.7f}, {}}};
    const Guard guard(FieldRef(kBall), {.side = GuardSide::inside, .clearance = 0.2f});
    const GrowResult kept = grow({.attractors = attractors, .roots = roots, .guard = &guard},
                                 {.influence_radius = 0.5f, .kill_radius = 0.1f, .step = 0.05f});
    EXPECT_GT(range_along(kept.skeleton, kBall).low, 0.2f);
    EXPECT_GT(kept.skeleton.size(), 500u);
    EXPECT_FALSE(kept.unreached.empty());
}

}  // namespace
}  // namespace coppice
