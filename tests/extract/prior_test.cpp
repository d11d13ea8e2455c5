#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/base/id.h"
#include "coppice/base/random.h"
#include "coppice/extract/prior/evidence_internal.h"
#include "coppice/extract/prior/radii_internal.h"
#include "coppice/extract/prior/smooth_axes_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr float kSpacing = 0.02f;

/// Tree with its samples.
struct Scene {
    InitialTree tree;
    std::vector<Vec3> points;
    std::vector<std::uint32_t> node;
    std::uint64_t draw = 0;
    CounterRandom random{7, 7};

    /// Adds a straight axis of `segments` segments; its points are on the surface if `hollow`, otherwise they
    /// fill it. Returns its last node.
    std::uint32_t add_axis(std::uint32_t from, Vec3d to, int segments, double radius, double surface,
                           int points_each, bool hollow) {
        const Vec3d start = tree.position[from];
        const Vec3d along = normalized(to - start), u = perpendicular(along), v = cross(along, u);
        for (int k = 1; k <= segments; ++k) {
            const Vec3d a = tree.position[from], b = lerp(start, to, static_cast<double>(k) / segments);
            from = tree.add(from, b, radius);
            for (int i = 0; i < points_each; ++i) {
                const double turn = random.uniform(draw++, 0, 2 * std::numbers::pi);
                const double r = surface * (hollow ? 1 : std::sqrt(random.uniform(draw++)));
                const Vec3d p = lerp(a, b, random.uniform(draw++));
                points.push_back(Vec3(p + (std::cos(turn) * u + std::sin(turn) * v) * r));
                node.push_back(from);
            }
        }
        return from;
    }
    std::vector<NodeEvidence> evidence() const {
        const FitSamples samples{points, {}, node};
        return gather_evidence(tree, samples, std::vector<float>(points.size(), kSpacing), {});
    }
};

Scene trunk(double radius = 0.2) {
    Scene s;
    s.tree.add(kNoIndex, {}, radius);
    s.add_axis(0, {0, 0, 5}, 10, radius, radius, 60, true);
    return s;
}

TEST(Evidence, DistinguishesTubesFromFilledVolumes) {
    Scene s = trunk();
    const std::uint32_t tube = s.add_axis(10, {2, 0, 6}, 8, 0.05, 0.05, 30, true);
    const std::uint32_t cluster = s.add_axis(10, {-2, 0, 6}, 8, 0.1, 0.15, 30, false);
    const auto e = s.evidence();
    EXPECT_LT(e[tube - 3].filled(), 0.05);
    EXPECT_NEAR(e[tube - 3].radius, 0.05, 0.002);
    EXPECT_GT(e[tube - 3].precision(), 100);
    EXPECT_GT(e[cluster - 3].filled(), 0.4);
    EXPECT_LT(e[cluster - 3].precision(), 0.5 * e[tube - 3].precision());
}

TEST(Evidence, MeasuresTheRadiusOfThePoints) {
    Scene s;
    s.tree.add(kNoIndex, {}, 0.1);
    s.add_axis(0, {0, 0, 5}, 10, 0.1, 0.2, 60, true);
    EXPECT_NEAR(s.evidence()[5].radius, 0.2, 1e-3);
}

TEST(Evidence, PrecisionIsZeroWithoutPoints) {
    Scene s = trunk();
    const std::uint32_t tip = s.add_axis(10, {2, 0, 6}, 8, 0.05, 0.05, 0, true);
    const NodeEvidence e = s.evidence()[tip];
    EXPECT_EQ(e.precision(), 0);
    EXPECT_FLOAT_EQ(static_cast<float>(e.spacing), kSpacing);
}

TEST(Radii, NeverIncreaseTowardsTheTipsAndMatchTheMeasurement) {
    Scene s = trunk();
    s.add_axis(10, {2, 0, 6}, 8, 0.06, 0.06, 40, true);
    const RadiusEstimate belief = believe_radii(s.tree, s.evidence(), 0);
    for (std::uint32_t n = 1; n < s.tree.size(); ++n) {
        EXPECT_LE(s.tree.radius[n], s.tree.radius[s.tree.parent[n]]);
        EXPECT_LT(belief.low[n], s.tree.radius[n]);
        EXPECT_LT(s.tree.radius[n], belief.high[n]);
    }
    EXPECT_NEAR(s.tree.radius[5], 0.2, 0.004);
    EXPECT_NEAR(s.tree.radius[15], 0.06, 0.003);
    EXPECT_GT(belief.measured[15], 0.9);
}

TEST(Radii, OfClustersFollowThePrior) {
    Scene s = trunk();
    // A ball of leaves half a metre wide at the end of a twig without points.
    const std::uint32_t twig = s.add_axis(10, {1, 0, 6}, 4, 0.05, 0.05, 0, true);
    const std::uint32_t ball = s.add_axis(twig, {1.5, 0, 6.2}, 3, 0.25, 0.3, 40, false);
    const RadiusEstimate belief = believe_radii(s.tree, s.evidence(), 0);
    EXPECT_LT(s.tree.radius[ball], 0.18);
    EXPECT_LT(belief.measured[ball], 0.9);
    EXPECT_GT(belief.high[ball] / belief.low[ball], 2);
    EXPECT_NEAR(s.tree.radius[5], 0.2, 0.004);
}

TEST(Radii, OfManyBranchesAreLimitedByAMeasuredStem) {
    Scene s = trunk();
    const std::uint32_t top = s.tree.size() - 1;
    std::vector<std::uint32_t> tips;
    for (int k = 0; k < 12; ++k)
        tips.push_back(s.add_axis(top, {4 * std::cos(k), 4 * std::sin(k), 7}, 8, 0.15, 0.15, 60, true));
    const InitialTree wide = s.tree;
    believe_radii(s.tree, s.evidence(), 2);
    EXPECT_NEAR(s.tree.radius[tips[5]], 0.15, 0.01) << "the stem was not measured";
    s.tree = wide;
    for (std::uint32_t n = 0; n <= top; ++n) s.tree.fixed[n] = 1;
    const RadiusEstimate belief = believe_radii(s.tree, s.evidence(), 2);
    double area = 0;
    for (const std::uint32_t tip : tips) {
        const std::uint32_t n = tip - 4;
        area += s.tree.radius[n] * s.tree.radius[n];
        EXPECT_TRUE(belief.limited[n]);
        EXPECT_EQ(belief.measured[n], 0);
        EXPECT_LE(s.tree.radius[tip], s.tree.radius[n]);
    }
    EXPECT_NEAR(area, 2 * 0.2 * 0.2, 0.02 * 0.2 * 0.2);
    EXPECT_FALSE(belief.limited[top]);
    EXPECT_NEAR(s.tree.radius[top], 0.2, 1e-3);
}

TEST(Radii, PriorFollowsTheMeasuredBranches) {
    Scene s = trunk();
    // All measured branches are twice as thick as usual, and so is the twig without points.
    for (int k = 0; k < 6; ++k)
        s.add_axis(10, {2 * std::cos(k), 2 * std::sin(k), 6}, 8, 0.12, 0.12, 40, true);
    const Allometry thick = fit_allometry(s.tree, s.evidence());
    Scene t = trunk();
    for (int k = 0; k < 6; ++k)
        t.add_axis(10, {2 * std::cos(k), 2 * std::sin(k), 6}, 8, 0.04, 0.04, 40, true);
    const Allometry thin = fit_allometry(t.tree, t.evidence());
    EXPECT_LT(thick.exponent, thin.exponent);
    EXPECT_NEAR(std::exp(thick.log_base_radius[0]), 0.2, 0.01);
}

TEST(SmoothAxes, StraightensSharpTurnsAndPreservesWellMeasuredAxes) {
    Scene s = trunk();
    std::uint32_t n = 10;
    for (int k = 1; k <= 12; ++k)
        n = s.add_axis(n, {0.3 * k, k % 2 == 0 ? 0.3 : -0.3, 5 + 0.05 * k}, 1, 0.02, 0.2, 4, false);
    const InitialTree before = s.tree;
    smooth_axes(s.tree, s.evidence(), {});
    for (std::uint32_t m = 12; m < n; ++m) {
        const Vec3d a = s.tree.position[m] - s.tree.position[m - 1],
                    b = s.tree.position[m + 1] - s.tree.position[m];
        EXPECT_GT(dot(a, b), 0.5 * length(a) * length(b));
    }
    for (std::uint32_t m = 1; m < 9; ++m) EXPECT_LT(distance(s.tree.position[m], before.position[m]), 0.02);
}

TEST(SmoothAxes, AcceptsCoincidentNodes) {
    Scene s = trunk();
    const std::uint32_t a = s.tree.add(10, s.tree.position[10], 0.05);
    const std::uint32_t b = s.tree.add(a, s.tree.position[10], 0.05);
    s.tree.add(b, {1, 0, 6}, 0.05);
    smooth_axes(s.tree, s.evidence(), {});
    for (const Vec3d p : s.tree.position) EXPECT_TRUE(is_finite(p) && length(p) < 10);
}

}  // namespace
}  // namespace coppice::extract_internal
