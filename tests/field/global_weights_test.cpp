#include "coppice/field/weights/global_weights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "coppice/base/error.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/field/convolution_field.h"
#include "coppice/skeleton/random_tree.h"
#include "zoo.h"

namespace coppice {
namespace {

FieldOptions global(Kernel kernel = Kernel::quartic) {
    return {.kernel = kernel, .weights = Weights::global};
}

/// Without length: a ball of the greater radius.
Segment segment_or_ball(const Skeleton& s, NodeId n) {
    const Vec3 p = s.position(n);
    Segment g = s.is_root(n) ? Segment{p, p, s.radius(n), s.radius(n)} : s.segment(n);
    if (g.a == g.b) g.radius_a = g.radius_b = std::max(g.radius_a, g.radius_b);
    return g;
}

/// Returns the distance from p divided by the radius at the closest point.
double rho(const Segment& s, Vec3 p) {
    const Vec3d q(p);
    const ClosestParameters c = closest_parameters(Vec3d(s.a), Vec3d(s.b), q, q);
    return distance(lerp(Vec3d(s.a), Vec3d(s.b), c.on_a), q) /
           (s.radius_a + c.on_a * (double{s.radius_b} - s.radius_a));
}

TEST(SurfaceConstraints, AreOnTheSurfaceAndOutsideOfOtherBranches) {
    for (const auto& [name, s] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const auto points = surface_constraints(s, {});
        EXPECT_FALSE(points.empty());
        const double rounding = 1e-6 * (length(Vec3d(s.bounds().center())) + s.bounds().diagonal());
        for (const WeightConstraint& c : points) {
            const Segment own = segment_or_ball(s, c.segment);
            const float least = std::min(own.radius_a, own.radius_b);
            EXPECT_NEAR(rho(own, c.position), 1, 0.06 + rounding / least);  // the tolerance allows for cones
            for (const NodeId n : nodes(s)) {
                if (n == c.segment || s.is_root(n)) continue;
                const Segment other = segment_or_ball(s, n);
                EXPECT_GE(rho(other, c.position), 0.98 - rounding / std::min(other.radius_a, other.radius_b));
            }
        }
        EXPECT_TRUE(std::is_sorted(points.begin(), points.end(), [](const auto& a, const auto& b) {
            return a.segment.index() < b.segment.index();
        }));
    }
}

TEST(SurfaceConstraints, AreProportionalToLengthOverRadius) {
    // Two trees far apart: 10 radii long each, but the second ten times as large; then one of 20 radii.
    const Skeleton s({NodeId{}, NodeId(0), NodeId{}, NodeId(2), NodeId{}, NodeId(4)},
                     {{0, 0, 0}, {0, 0, 10}, {500, 0, 0}, {500, 0, 100}, {0, 500, 0}, {0, 500, 20}},
                     {1, 1, 10, 10, 1, 1});
    const auto points = surface_constraints(s, {.constraint_density = 32});
    const auto count = [&](std::uint32_t n) {
        return std::count_if(points.begin(), points.end(),
                             [&](const auto& c) { return c.segment == NodeId(n); });
    };
    // 3 segments of 32 points are 24 circles of 4: a quarter, a quarter and a half.
    EXPECT_EQ(count(1), 24);
    EXPECT_EQ(count(3), 24);
    EXPECT_EQ(count(5), 48);
}

TEST(GlobalWeights, LongSegmentHasTheLocalWeight) {
    const Skeleton s({NodeId{}, NodeId(0)}, {{0, 0, 0}, {0, 0, 200}}, {1, 1});
    for (const Kernel k : {Kernel::quartic, Kernel::cauchy, Kernel::scalis, Kernel::balls}) {
        const GlobalWeights w = global_weights(s, global(k));
        ASSERT_EQ(w.factors.size(), 2u);
        EXPECT_NEAR(w.factors[1], 1, 0.01) << name_of(k);
        EXPECT_EQ(w.factors[0], 1);  // a root with children has no segment
        EXPECT_EQ(w.zero, 0u);
        EXPECT_EQ(w.unseen, 0u);
        EXPECT_TRUE(w.converged);
    }
}

TEST(GlobalWeights, BallPreservesItsRadius) {
    const Skeleton s({NodeId{}}, {{1, 2, 3}}, {0.5f});
    EXPECT_NEAR(global_weights(s, global()).factors[0], 1, 1e-3);
}

TEST(GlobalWeights, TwoCoincidentSegmentsShareTheirWeight) {
    const Skeleton s({NodeId{}, NodeId(0), NodeId{}, NodeId(2)},
                     {{0, 0, 0}, {0, 0, 30}, {0, 0, 0}, {0, 0, 30}}, {1, 1, 1, 1});
    // The trees are not connected: each fits only its own points. As one tree their weights would be halved.
    EXPECT_NEAR(global_weights(s, global()).factors[1], 1, 0.01);
    const Skeleton one({NodeId{}, NodeId(0), NodeId(0)}, {{0, 0, 0}, {0, 0, 30}, {0, 0, 30}}, {1, 1, 1});
    const GlobalWeights w = global_weights(one, global());
    EXPECT_NEAR(w.factors[1] + w.factors[2], 1, 0.02);
    EXPECT_NEAR(w.local.largest, 1, 0.05);  // the plain sum of both is 2
    EXPECT_LT(w.global.rms, 0.05);
}

TEST(GlobalWeights, AveragingMixesAdjacentSegments) {
    // A stem with a fork of a thick and a thin branch, the thin one of two segments; and a separate tree.
    const Skeleton s({NodeId{}, NodeId(0), NodeId(1), NodeId(1), NodeId(3), NodeId{}, NodeId(5)},
                     {{0, 0, 0}, {0, 0, 9}, {5, 0, 14}, {-3, 0, 12}, {-7, 0, 13}, {90, 0, 0}, {90, 0, 5}},
                     {2, 2, 1.5f, 0.5f, 0.3f, 1, 1});
    FieldOptions options = global();
    const std::vector<float> w = global_weights(s, options).factors;
    options.weight_averaging = 1;
    const std::vector<float> once = global_weights(s, options).factors;
    EXPECT_NEAR(once[1], (w[1] + w[2] + w[3]) / 3, 1e-6);
    EXPECT_NEAR(once[2], (w[1] + w[2] + w[3]) / 3, 1e-6);
    EXPECT_NEAR(once[3], (w[1] + w[2] + w[3] + w[4]) / 4, 1e-6);
    EXPECT_NEAR(once[4], (w[3] + w[4]) / 2, 1e-6);
    EXPECT_EQ(once[6], w[6]) << "it has no neighbours";
    EXPECT_GT(std::abs(w[3] - w[1]), 0.01f) << "there was something to average";
    options.weight_averaging = 100;
    const std::vector<float> many = global_weights(s, options).factors;
    EXPECT_NEAR(many[4], many[1], 1e-3);
}

TEST(GlobalWeights, ResidualsAreNotAboveThoseOfLocalWeightsOnTheZoo) {
    for (const auto& [name, s] : skeleton_zoo()) {
        for (const Kernel k : {Kernel::quartic, Kernel::cauchy, Kernel::scalis}) {
            SCOPED_TRACE(name + ", " + std::string(name_of(k)));
            const GlobalWeights w = global_weights(s, global(k));
            EXPECT_LE(w.global.rms, w.local.rms * (1 + 1e-6) + 1e-9);
            EXPECT_TRUE(w.converged);
            for (const float f : w.factors) EXPECT_TRUE(f >= 0 && std::isfinite(f));
        }
    }
}

TEST(GlobalWeights, ResidualMatchesTheField) {
    const Skeleton s = random_tree(80, 3);
    const GlobalWeights w = global_weights(s, global());
    ConvolutionField field(s, global());
    field.scale_weights(w.factors);
    const auto points = surface_constraints(s, global());
    double largest = 0, squares = 0;
    for (const WeightConstraint& c : points) {
        Box3 box;
        for (const WeightConstraint& d : points)
            if (d.segment == c.segment) box.extend(d.position);
        const FieldRegion region[] = {{box, c.segment}};
        field.set_regions(region);
        FieldSample sample[1];
        field.sample(0, std::span(&c.position, 1), sample);
        largest = std::max(largest, std::abs(sample[0].value - 1.0));
        squares += std::pow(sample[0].value - 1.0, 2);
    }
    EXPECT_EQ(points.size(), w.constraints);
    EXPECT_NEAR(largest, w.global.largest, 1e-4);
    EXPECT_NEAR(std::sqrt(squares / static_cast<double>(points.size())), w.global.rms, 1e-4);
    EXPECT_LT(w.global.rms, w.local.rms);
}

TEST(GlobalWeights, AcceptsGivenPoints) {
    // Points on a circle of 1.2 radii around the middle: the segment must get the weight of that thickness.
    const Skeleton s({NodeId{}, NodeId(0)}, {{0, 0, 0}, {0, 0, 20}}, {1, 1});
    std::vector<Vec3> points;
    for (int i = 0; i < 12; ++i)
        points.push_back(
            {1.2f * std::cos(static_cast<float>(i)), 1.2f * std::sin(static_cast<float>(i)), 10});
    const GlobalWeights w = global_weights(s, global(), points);
    EXPECT_EQ(w.constraints, 12u);
    ConvolutionField field(s, global());
    FieldSample before[1], after[1];
    field.sample_everywhere(std::span(points.data(), 1), before);
    field.scale_weights(w.factors);
    field.sample_everywhere(std::span(points.data(), 1), after);
    EXPECT_NEAR(after[0].value, 1, 1e-4);
    EXPECT_NEAR(w.factors[1], 1 / before[0].value, 1e-4);
}

TEST(GlobalWeights, SegmentsWithoutConstraintsHaveTheirLocalWeight) {
    const Skeleton s({NodeId{}, NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 20}, {0, 0, 40}}, {1, 1, 1});
    const std::vector<Vec3> points{{1.1f, 0, 10}, {0, 1.1f, 10}};
    const GlobalWeights w = global_weights(s, global(), points);
    EXPECT_GT(w.factors[1], 1.1f);
    EXPECT_EQ(w.factors[2], 1);
    EXPECT_EQ(w.unseen, 1u);
}

TEST(GlobalWeights, AreBitIdenticalForAnyNumberOfThreads) {
    const Skeleton s = random_tree(700, 5);
    const GlobalWeights one = global_weights(s, global(), {}, {.threads = 1});
    for (const unsigned threads : {2u, 7u}) {
        const GlobalWeights many = global_weights(s, global(), {}, {.threads = threads});
        EXPECT_EQ(std::memcmp(one.factors.data(), many.factors.data(), one.factors.size() * sizeof(float)),
                  0);
        EXPECT_EQ(one.global.rms, many.global.rms);
    }
}

TEST(GlobalWeights, FieldUsesTheBlendOne) {
    const Skeleton s = zoo_skeleton("fork_60");
    const Vec3 p = s.position(NodeId(1)) + Vec3{0, 0.7f * s.radius(NodeId(1)), 0};
    FieldSample sum[1], with_blend[1];
    ConvolutionField(s, {.blend = 1}).sample_everywhere(std::span(&p, 1), sum);
    ConvolutionField(s, {.blend = 8, .weights = Weights::global})
        .sample_everywhere(std::span(&p, 1), with_blend);
    EXPECT_EQ(sum[0].value, with_blend[0].value);
    EXPECT_THROW(ConvolutionField(s, {.blend = 3, .weights = Weights::global}), InvalidInput);
}

TEST(GlobalWeights, RejectsUnsolvableConstraints) {
    const Skeleton s({NodeId{}, NodeId(0)}, {{0, 0, 0}, {0, 0, 20}}, {1, 1});
    const std::vector<Vec3> far{{50, 0, 0}},
        broken{{1, 0, 0}, {std::numeric_limits<float>::quiet_NaN(), 0, 0}};
    try {
        global_weights(s, global(), far);
        FAIL();
    } catch (const InvalidInput& e) {
        EXPECT_STREQ(e.what(), "weights: no constraint is near the skeleton; provide points on its surface");
    }
    try {
        global_weights(s, global(), broken);
        FAIL();
    } catch (const InvalidInput& e) {
        EXPECT_STREQ(e.what(), "weights: constraint 2 is not finite; remove it");
    }
    EXPECT_THROW(global_weights(s, {.constraint_density = 0}), InvalidInput);
    EXPECT_THROW(surface_constraints(s, {.constraint_density = 1000}), InvalidInput);
}

}  // namespace
}  // namespace coppice
