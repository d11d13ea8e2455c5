#include "coppice/extract/tree/capsule_fit_internal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coppice/base/id.h"
#include "coppice/base/random.h"

namespace coppice {
namespace {

/// Returns points on the lateral surface of a cylinder along z.
std::vector<Vec3> cylinder(double radius, double low, double high, Vec3d middle = {}) {
    const CounterRandom random(1, 9);
    std::vector<Vec3> out;
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const double a = 2 * std::numbers::pi * random.uniform(2 * i),
                     z = random.uniform(2 * i + 1, low, high);
        out.push_back(Vec3(middle + Vec3d(radius * std::cos(a), radius * std::sin(a), z)));
    }
    return out;
}

InitialTree chain(const std::vector<Vec3d>& at, double radius) {
    InitialTree t;
    for (const Vec3d p : at) t.add(t.size() == 0 ? kNoIndex : t.size() - 1, p, radius);
    return t;
}

TEST(FitCapsules, FitsACylinder) {
    const std::vector<Vec3> points = cylinder(0.2, 0, 3);
    InitialTree tree = chain({{0.05, 0, 0}, {-0.04, 0.05, 1}, {0.03, -0.05, 2}, {0, 0.04, 3}}, 0.15);
    FitSamples samples{points, {}, std::vector<std::uint32_t>(points.size(), 1)};
    fit_capsules(tree, samples, {.iterations = 20}, {});
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        EXPECT_LT(std::hypot(tree.position[n].x, tree.position[n].y), 0.004) << n;
        EXPECT_NEAR(tree.radius[n], 0.2, 0.004) << n;
    }
    for (const float r : fit_residuals(tree, samples, {})) EXPECT_LT(std::abs(r), 0.01f);
}

TEST(FitCapsules, OutliersHaveLittleInfluence) {
    std::vector<Vec3> points = cylinder(0.2, 0, 3);
    for (int i = 0; i < 200; ++i) points.push_back({0.6f, 0, 0.015f * static_cast<float>(i)});
    InitialTree tree = chain({{0, 0, 0}, {0, 0, 1.5}, {0, 0, 3}}, 0.17);
    FitSamples samples{points, {}, std::vector<std::uint32_t>(points.size(), 1)};
    fit_capsules(tree, samples, {.iterations = 20, .robust = 0.15}, {});
    for (std::uint32_t n = 0; n < tree.size(); ++n) EXPECT_NEAR(tree.radius[n], 0.2, 0.01);
}

// Of two touching tubes, a sample belongs to the one with a surface normal similar to its own.
TEST(FitCapsules, NormalsDistinguishAdjacentBranches) {
    InitialTree tree;
    tree.add(kNoIndex, {0, 0, 0}, 0.1);
    tree.add(0, {-0.1, 0, 2}, 0.1);
    tree.add(0, {0.1, 0, 2}, 0.1);
    const std::vector<Vec3> points{{0, 0, 2}}, normals{{1, 0, 0}};
    FitSamples samples{points, normals, {2}};
    fit_capsules(tree, samples, {.iterations = 0}, {});
    EXPECT_EQ(samples.node[0], 1u);
}

TEST(FitCapsules, NodesWithoutSamplesRemainFinite) {
    const std::vector<Vec3> points = cylinder(0.2, 0, 1);
    InitialTree tree = chain({{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 2}, {0, 0, 2}}, 0.2);
    FitSamples samples{points, {}, std::vector<std::uint32_t>(points.size(), 1)};
    fit_capsules(tree, samples, {}, {});
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        EXPECT_TRUE(is_finite(tree.position[n]));
        EXPECT_GT(tree.radius[n], 0.05);
    }
}

TEST(FitCapsules, IsBitIdenticalForAnyNumberOfThreads) {
    const std::vector<Vec3> points = cylinder(0.2, 0, 3);
    const auto fitted = [&](unsigned threads) {
        InitialTree tree = chain({{0.05, 0, 0}, {-0.04, 0.05, 1}, {0.03, -0.05, 2}, {0, 0.04, 3}}, 0.15);
        FitSamples samples{points, {}, std::vector<std::uint32_t>(points.size(), 1)};
        Context ctx;
        ctx.threads = threads;
        fit_capsules(tree, samples, {}, ctx);
        return tree;
    };
    const InitialTree one = fitted(1);
    for (const unsigned threads : {2u, 7u}) {
        const InitialTree many = fitted(threads);
        EXPECT_EQ(one.position, many.position);
        EXPECT_EQ(one.radius, many.radius);
    }
}

}  // namespace
}  // namespace coppice
