#include "coppice/implicit/solid/solid_field.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cstring>
#include <iterator>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "implicit/trees.h"

namespace coppice {
namespace {

FieldSample at(const Solid& solid, Vec3 p) {
    FieldSample out;
    SolidField(solid).sample(0, std::span(&p, 1), std::span(&out, 1));
    return out;
}

std::vector<FieldSample> samples(const SolidField& field, std::span<const Vec3> points) {
    std::vector<FieldSample> out(points.size());
    field.sample(0, points, out);
    return out;
}

void expect_field(const Twin& twin, int count, double tolerance) {
    const SolidField field(twin.solid);
    const auto points = random_points_in(twin.solid.bounds(), count);
    const auto got = samples(field, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double expected = twin.field(Vec3d(points[i]));
        ASSERT_NEAR(got[i].value, expected, tolerance * (1 + expected))
            << points[i].x << ' ' << points[i].y << ' ' << points[i].z;
    }
}

/// Compares gradients with differences of the field in double precision; points near an edge of the field are
/// skipped.
int expect_gradients(const Twin& twin, int count) {
    const SolidField field(twin.solid);
    const auto points = random_points_in(twin.solid.bounds(), count, 11);
    const auto got = samples(field, points);
    int checked = 0;
    constexpr double kStep = 1e-5;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3d p(points[i]);
        Vec3d there{}, wide{};
        for (int axis = 0; axis < 3; ++axis) {
            Vec3d e{};
            e[axis] = kStep;
            there[axis] = (twin.field(p + e) - twin.field(p - e)) / (2 * kStep);
            wide[axis] = (twin.field(p + e * 50.0) - twin.field(p - e * 50.0)) / (100 * kStep);
        }
        if (length(there - wide) > 1e-3 * (1 + length(there))) continue;
        ++checked;
        EXPECT_LT(length(Vec3d(got[i].gradient) - there), 4e-3 * (1 + length(there)))
            << points[i].x << ' ' << points[i].y << ' ' << points[i].z;
    }
    return checked;
}

// Wyvill's (1 - d^2/R^2)^3 with R = 2: (3/4)^3 at d = 1, and its slope -6 d/R^2 (3/4)^2 there.
TEST(SolidField, SphereMatchesTheWyvillLaw) {
    const double radius = 2 * std::sqrt(1 - std::cbrt(0.5));
    const Solid s = sphere({}, {.radius = static_cast<float>(radius)});
    EXPECT_NEAR(at(s, {}).value, 1, 1e-6);
    const FieldSample one = at(s, {0, 1, 0});
    EXPECT_NEAR(one.value, 0.421875, 1e-6);
    EXPECT_NEAR(one.gradient.y, -0.84375, 1e-5);
    EXPECT_EQ(one.gradient.x, 0);
    EXPECT_NEAR(at(s, {static_cast<float>(radius), 0, 0}).value, 0.5, 1e-6);
    EXPECT_EQ(at(s, {2.001f, 0, 0}).value, 0);
    // With an influence of 4 the factor is 0.5 / (1 - (1/4)^2)^3.
    EXPECT_NEAR(at(sphere({}, {.radius = 1, .influence = 4}), {}).value, 0.5 / std::pow(0.9375, 3), 1e-6);
}

// The law of soft objects: 1 - 22/9 x^2 + 17/9 x^4 - 4/9 x^6 of the share x of the influence, 2 radii.
TEST(SolidField, TheSoftLawIsOneHalfAtHalfItsInfluence) {
    const Solid s = sphere({}, {.radius = 1, .law = FieldLaw::soft});
    EXPECT_EQ(at(s, {}).value, 1);
    EXPECT_NEAR(at(s, {0, 1, 0}).value, 0.5, 1e-6);
    // x = 3/4: 1 - 1.375 + 0.59765625 - 0.0791015625; and its slope per metre, half the derivative by x.
    const FieldSample far = at(s, {0, 0, 1.5f});
    EXPECT_NEAR(far.value, 0.1435546875, 1e-6);
    EXPECT_NEAR(far.gradient.z, 0.5 * (-44.0 / 9 * 0.75 + 68.0 / 9 * 0.421875 - 24.0 / 9 * 0.2373046875),
                1e-5);
    EXPECT_EQ(at(s, {2.001f, 0, 0}).value, 0);
    EXPECT_NEAR(s.bounds().high.x, 2, 1e-4);
    EXPECT_NEAR(s.surface_bounds().high.x, 1, 1e-4);
    EXPECT_NEAR(s.bounds_at(far.value).high.x, 1.5, 1e-4);
    // With an influence of 4 radii the factor is 0.5 divided by the law at 1/4.
    const double quarter = 1 - 22.0 / 9 / 16 + 17.0 / 9 / 256 - 4.0 / 9 / 4096;
    EXPECT_NEAR(at(sphere({}, {.radius = 1, .influence = 4, .law = FieldLaw::soft}), {}).value, 0.5 / quarter,
                1e-6);
}

TEST(SolidField, EveryPrimitiveMatchesItsFormula) {
    auto twins = primitive_twins();
    std::ranges::move(primitive_twins(FieldLaw::soft), std::back_inserter(twins));
    for (const Twin& twin : twins) {
        SCOPED_TRACE(twin.solid.kind());
        expect_field(twin, 4000, 2e-5);
        EXPECT_GT(expect_gradients(twin, 1000), 300);
        TreeMaker maker(5);
        expect_field(maker.mapped(twin), 4000, 5e-5);
    }
}

TEST(SolidField, EveryWarpMatchesItsFormula) {
    TreeMaker maker(8);
    for (int i = 0; i < 12; ++i) {
        const Twin twin = maker.warped(maker.mapped(primitive_twins()[static_cast<std::size_t>(i % 10)]));
        SCOPED_TRACE(twin.solid.kind());
        expect_field(twin, 4000, 2e-4);
        EXPECT_GT(expect_gradients(twin, 1000), 200);
    }
}

TEST(SolidField, RandomTreesMatchDoublePrecision) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(seed);
        TreeMaker maker(seed);
        const Twin twin = maker.tree(1 + static_cast<int>(seed % 5));
        expect_field(twin, 1500, 1e-3);
        if (seed % 4 == 0) expect_gradients(twin, 300);
    }
}

TEST(SolidField, ClosedShapesDecreaseFromOneToZeroAcrossTheSurface) {
    const auto ball = std::make_shared<BallShape>(Vec3{1, 0, 0}, 2.0f);
    const Solid s = make_solid(ball, {.influence = 0.8f});
    EXPECT_NEAR(at(s, {3, 0, 0}).value, 0.5, 1e-6);
    // The slope at the surface is -15/16 per influence.
    EXPECT_NEAR(at(s, {3, 0, 0}).gradient.x, -15.0 / 16 / 0.8, 1e-4);
    EXPECT_EQ(at(s, {3.81f, 0, 0}).value, 0);
    EXPECT_EQ(at(s, {1.5f, 0, 0}).value, 1);
    // At half an influence 1/2 - (15 - 10/4 + 3/16) / 32.
    EXPECT_NEAR(at(s, {3.4f, 0, 0}).value, 0.5 - (15 - 2.5 + 3.0 / 16) / 32, 1e-5);
    // Moved and scaled by 2: twice the distance.
    const Solid moved = scaled(s, {2, 2, 2});
    EXPECT_NEAR(at(moved, {6, 0, 0}).value, 0.5, 1e-6);
    EXPECT_NEAR(at(moved, {6, 0, 0}).gradient.x, -15.0 / 16 / 1.6, 1e-4);
}

TEST(SolidField, SoftLawOfClosedShapesIsOneAtTheDepthOfTheInfluence) {
    const PrimitiveOptions o{.influence = 0.8f, .law = FieldLaw::soft};
    const Solid s = make_solid(std::make_shared<BallShape>(Vec3{1, 0, 0}, 2.0f), o);
    // So the law's influence is 1.6, and its slope at the half is -19/12 divided by that.
    EXPECT_NEAR(at(s, {3, 0, 0}).value, 0.5, 1e-6);
    EXPECT_NEAR(at(s, {3, 0, 0}).gradient.x, -19.0 / 12 / 1.6, 1e-4);
    EXPECT_NEAR(at(s, {3.4f, 0, 0}).value, 0.1435546875, 1e-5);
    EXPECT_EQ(at(s, {3.81f, 0, 0}).value, 0);
    EXPECT_EQ(at(s, {1.5f, 0, 0}).value, 1);
    EXPECT_NEAR(s.bounds_at(0.1435546875f).high.x, 3.4, 1e-4);
    EXPECT_NEAR(s.surface_bounds().high.x, 3, 1e-4);
}

TEST(SolidField, CombinationsSatisfyTheLawsOfSets) {
    const Solid a = sphere({0, 0, 0}), b = sphere({1, 0, 0}),
                c = line({0, -1, 0}, {0, 1, 1}, {.radius = 0.6f});
    const auto points = random_points_in({{-2, -2, -2}, {3, 2, 2}}, 3000);
    const auto same = [&](const Solid& left, const Solid& right) {
        const auto l = samples(SolidField(left), points), r = samples(SolidField(right), points);
        for (std::size_t i = 0; i < points.size(); ++i) ASSERT_FLOAT_EQ(l[i].value, r[i].value);
    };
    const auto u = [](const Solid& x, const Solid& y) { return unite(std::array{x, y}); };
    const auto n = [](const Solid& x, const Solid& y) { return intersect(std::array{x, y}); };
    same(u(a, b), u(b, a));
    same(u(u(a, b), c), u(a, u(b, c)));
    same(n(a, u(b, c)), u(n(a, b), n(a, c)));
    same(u(a, n(b, c)), n(u(a, b), u(a, c)));
    same(u(a, a), a);
    same(subtract(a, std::array{b, c}), subtract(subtract(a, std::array{b}), std::array{c}));
    same(ricci_blend(std::array{a, b, c}, 1), blend(std::array{a, b, c}));
    // The difference of a and b: inside a only.
    for (const Vec3 p : points) {
        const bool left = at(subtract(a, std::array{b}), p).value > 0.5f;
        EXPECT_EQ(left, at(a, p).value > 0.5f && at(b, p).value < 0.5f);
    }
}

TEST(SolidField, RicciBlendOfTwoEqualValuesIsTheirNorm) {
    // The blend of two equal values v is 2^(1/n) v.
    const Solid a = sphere({0, 0, 0}), b = sphere({1, 0, 0});
    const float v = at(a, {0.5f, 0.3f, 0}).value;
    for (const float n : {1.0f, 2.0f, 5.0f, 100.0f}) {
        EXPECT_NEAR(at(ricci_blend(std::array{a, b}, n), {0.5f, 0.3f, 0}).value, std::exp2(1 / n) * v, 1e-5)
            << n;
    }
}

TEST(SolidField, SamplesAreIdenticalInAnyBatch) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        TreeMaker maker(100 + seed);
        const Twin twin = maker.tree(4);
        const SolidField field(twin.solid);
        const auto points = random_points_in(twin.solid.bounds(), 700);
        const auto whole = samples(field, points);
        std::vector<float> values(points.size());
        field.values(points, values);
        for (std::size_t i = 0; i < points.size(); ++i) {
            FieldSample alone;
            field.sample(0, std::span(&points[i], 1), std::span(&alone, 1));
            ASSERT_EQ(alone.value, whole[i].value);
            ASSERT_EQ(alone.gradient, whole[i].gradient);
            ASSERT_EQ(values[i], whole[i].value);
        }
    }
}

TEST(SolidField, EveryInstructionSetMatches) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        TreeMaker maker(700 + seed);
        const SolidField field(maker.tree(3).solid);
        const auto points = random_points_in(field.bounds(), 500);
        const auto best = samples(field, points);
        for (const auto target : {HWY_SCALAR, HWY_SSE4, HWY_AVX2}) {
            SCOPED_TRACE(hwy::TargetName(target));
            // Targets that this machine or build does not support use scalar code.
            hwy::SetSupportedTargetsForTest((hwy::SupportedTargets() & target) | HWY_SCALAR);
            const auto other = samples(field, points);
            hwy::SetSupportedTargetsForTest(0);
            for (std::size_t i = 0; i < points.size(); ++i) {
                ASSERT_NEAR(other[i].value, best[i].value, 2e-4 * (1 + best[i].value));
            }
        }
    }
}

TEST(SolidField, GroupingManyPartsPreservesTheField) {
    std::vector<Solid> spheres;
    const CounterRandom random(1, 1);
    std::vector<Vec3> centers;
    for (std::uint64_t i = 0; i < 500; ++i) {
        centers.push_back(
            Vec3(Vec3d{random.uniform(3 * i), random.uniform(3 * i + 1), random.uniform(3 * i + 2)} * 10.0));
        spheres.push_back(sphere(centers.back(), {.radius = 0.3f}));
    }
    for (const bool sum : {false, true}) {
        const SolidField field(sum ? blend(spheres) : unite(spheres));
        const auto points = random_points_in({{0, 0, 0}, {10, 10, 10}}, 2000);
        const auto got = samples(field, points);
        for (std::size_t i = 0; i < points.size(); ++i) {
            double expected = 0;
            for (const Vec3 c : centers) {
                const double v = wyvill(distance(Vec3d(c), Vec3d(points[i])), {.radius = 0.3f});
                expected = sum ? expected + v : std::max(expected, v);
            }
            ASSERT_NEAR(got[i].value, expected, 1e-4);
        }
    }
}

TEST(SolidField, LongPolylinesMatchTheirSegments) {
    std::vector<Vec3> points;
    for (int i = 0; i < 500; ++i) {
        const float t = 0.05f * static_cast<float>(i);
        points.push_back({3 * std::cos(t), 3 * std::sin(t), 0.2f * t});
    }
    const Solid s = polyline(points, false, {.radius = 0.1f});
    expect_field({s,
                  [&](Vec3d p) {
                      double least = 1e300;
                      for (std::size_t i = 0; i + 1 < points.size(); ++i) {
                          least =
                              std::min(least, segment_distance(p, Vec3d(points[i]), Vec3d(points[i + 1])));
                      }
                      return wyvill(least, {.radius = 0.1f});
                  }},
                 4000, 1e-4);
}

/// Checks that the ranges of boxes of many sizes in and around the solid contain the values of points within
/// them.
void expect_ranges(const Solid& solid, float size, std::uint64_t seed) {
    const SolidField field(solid);
    std::vector<Box3> boxes;
    const auto centers = random_points_in(solid.bounds(), 200, seed);
    for (std::size_t i = 0; i < centers.size(); ++i) {
        const float half = size * static_cast<float>(1 + i % 40);
        boxes.push_back({centers[i] - Vec3{half, 2 * half, half}, centers[i] + Vec3{half, half, half}});
    }
    std::vector<ValueRange> ranges(boxes.size());
    field.ranges(boxes, ranges);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        std::vector<Vec3> within = random_points_in(boxes[i], 40, i);
        for (Vec3& p : within) {
            for (int axis = 0; axis < 3; ++axis) {
                p[axis] = std::clamp(p[axis], boxes[i].low[axis], boxes[i].high[axis]);
            }
        }
        std::vector<float> values(within.size());
        field.values(within, values);
        for (const float v : values) {
            ASSERT_LE(ranges[i].low, v) << i;
            ASSERT_GE(ranges[i].high, v) << i;
        }
    }
}

TEST(SolidField, RangesContainEveryValue) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(seed);
        TreeMaker maker(200 + seed);
        const Twin twin =
            seed % 4 == 0 ? maker.warped(maker.tree(2)) : maker.tree(static_cast<int>(seed % 5));
        expect_ranges(twin.solid, 0.02f, seed);
    }
}

TEST(SolidField, RangesOfTheSoftLawContainEveryValue) {
    for (const Twin& twin : primitive_twins(FieldLaw::soft)) {
        SCOPED_TRACE(twin.solid.kind());
        expect_ranges(twin.solid, 0.02f, 3);
    }
    const PrimitiveOptions o{.influence = 0.8f, .law = FieldLaw::soft};
    expect_ranges(make_solid(std::make_shared<BallShape>(Vec3{1, 0, 0}, 2.0f), o), 0.05f, 4);
}

TEST(SolidField, RangesOfStrongWarpsContainEveryValue) {
    const Solid rod = line({1, 0, -2}, {1, 0.2f, 2}, {.radius = 0.2f});
    for (const float size : {0.002f, 0.01f, 0.05f}) {
        expect_ranges(twisted(rod, {}, {0, 0, 1}, 4), size, 1);
        expect_ranges(tapered(rod, {0, 0, -0.1f}, {0, 0, 0.1f}, 0.05f), size, 2);
        expect_ranges(bent(rod, {0, 0, -2}, {0, 0, 2.6f}, {1, 0, 0}, std::numbers::pi_v<float>), size, 3);
    }
}

TEST(SolidField, RangesOfSmallBoxesAreTight) {
    const SolidField field(blend(std::array{sphere({0, 0, 0}), sphere({1, 0, 0})}));
    const Box3 box{{0.99f, 0.29f, -0.01f}, {1.01f, 0.31f, 0.01f}};
    ValueRange range;
    field.ranges(std::span(&box, 1), std::span(&range, 1));
    EXPECT_LT(range.high - range.low, 0.06f);
    const Box3 far{{9, 9, 9}, {10, 10, 10}};
    field.ranges(std::span(&far, 1), std::span(&range, 1));
    EXPECT_EQ(range.high, 0);
}

TEST(SolidField, NonFinitePointsAreZeroAndDoNotAffectOthers) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    const SolidField field(
        unite(std::array{sphere({}), twisted(box({{-1, -1, -1}, {1, 1, 1}}), {}, {0, 0, 1}, 1)}));
    const std::vector<Vec3> points{{nan, 0, 0}, {0, 0, 0},    {0, inf, 0},
                                   {1, 0, 0},   {0, 0, -inf}, {3e38f, 0, 0}};
    const auto got = samples(field, points);
    for (const std::size_t i : {0, 2, 4, 5}) EXPECT_EQ(got[i].value, 0);
    EXPECT_EQ(got[1].value,
              at(unite(std::array{sphere({}), twisted(box({{-1, -1, -1}, {1, 1, 1}}), {}, {0, 0, 1}, 1)}), {})
                  .value);
    EXPECT_GT(got[3].value, 0.4f);
}

TEST(SolidField, EmptySolidIsZeroEverywhere) {
    const SolidField field(intersect(std::array{sphere({0, 0, 0}), sphere({100, 0, 0})}));
    EXPECT_TRUE(field.bounds().empty());
    const Vec3 p{};
    FieldSample s{1, {1, 1, 1}};
    field.sample(0, std::span(&p, 1), std::span(&s, 1));
    EXPECT_EQ(s.value, 0);
    field.sample(0, {}, {});
}

TEST(SolidField, SatisfiesFieldRef) {
    const SolidField field(sphere({}));
    const FieldRef ref(field);
    EXPECT_EQ(ref.level(), 0.5f);
    const Vec3 p{1, 0, 0};
    FieldSample s;
    ref.sample(0, std::span(&p, 1), std::span(&s, 1));
    EXPECT_NEAR(s.value, 0.5f, 1e-6f);
}

}  // namespace
}  // namespace coppice
