#include "coppice/points/sampling/dart_throwing.h"

#include <gtest/gtest.h>

#include <array>
#include <stop_token>

#include "coppice/base/random.h"
#include "points/support.h"

namespace coppice {
namespace {

using namespace points_support;

const Ball kBall;
const Ramp kRamp;

PointRegion ball(PointDensity density = PointDensity::uniform, float width = 0.1f) {
    return {FieldRef(kBall), ball_box(), DensityCurve(density, 1, width)};
}

/// Returns a region with the density `curve` of x.
PointRegion rod(Vec3 high, std::vector<DensityCurve::Knot> curve) {
    return {FieldRef(kRamp), {{0, 0, 0}, high}, DensityCurve(std::move(curve))};
}

TEST(Lane, DensitiesAreExactWithinCells) {
    // Density x over [0, 1]: the share below x is x^2. 8 cells, 20 bins: the result does not depend on the
    // cells.
    const auto set =
        sample_dart_throwing(rod({1, 0.2f, 0.2f}, {{0, 0}, {1, 1}}), {}, {.count = 20000, .resolution = 8})
            .points;
    std::array<double, 20> seen{}, expected{};
    for (const Vec3 p : set.positions) ++seen[static_cast<std::size_t>(p.x * 20)];
    for (std::size_t b = 0; b < 20; ++b) expected[b] = 20000.0 * (2.0 * static_cast<double>(b) + 1) / 400;
    EXPECT_LT(chi_square(seen, expected), 43.8);  // 19 degrees of freedom, 0.1 %
}

TEST(Lane, SecondPointFollowsTheRemainingDensity) {
    // On a line of length 1 with a minimum distance of 1/2, the second point has the density log(1 / (2 x))
    // for x below 1/2: the share below x is x (1 + log(1 / (2 x))); above 1/2 it is the mirror image.
    constexpr int kRuns = 4000;
    const PointRegion line = rod({1, 1e-3f, 1e-3f}, {{0, 1}, {1, 1}});
    std::array<double, 10> seen{}, expected{};
    for (int run = 0; run < kRuns; ++run) {
        const auto set =
            sample_dart_throwing(line, RadialKernel::disk(0.5f), {.count = 2, .resolution = 8, .seed = run})
                .points;
        ASSERT_EQ(set.size(), 2u);
        const float x = set.positions[1].x;
        ++seen[static_cast<std::size_t>(10 * std::min(x, 1 - x) * 2)];
    }
    const auto below = [](double x) { return x > 0 ? 2 * x * (1 + std::log(1 / (2 * x))) : 0; };
    for (int b = 0; b < 10; ++b) {
        expected[static_cast<std::size_t>(b)] = kRuns * (below((b + 1) / 20.0) - below(b / 20.0));
    }
    EXPECT_LT(chi_square(seen, expected), 27.9);  // 9 degrees of freedom, 0.1 %
}

TEST(Lane, KernelsIncreaseTheDensityOfCells) {
    // Eight cells in a row; those with centres within 1.2 of the first point count three times.
    constexpr int kRuns = 4000;
    const PointRegion row = rod({8, 1, 1}, {{0, 1}, {8, 1}});
    const RadialKernel kernel({{0, 3}, {1.2f, 3}, {1.2f, 1}});
    std::array<double, 8> seen{}, expected{};
    double raised_seen = 0, raised_expected = 0, variance = 0;
    for (int run = 0; run < kRuns; ++run) {
        const auto set = sample_dart_throwing(row, kernel, {.count = 2, .resolution = 8, .seed = run}).points;
        const Vec3d first(set.positions[0]);
        std::array<double, 8> weight{};
        double total = 0, raised = 0;
        for (std::size_t c = 0; c < 8; ++c) {
            const bool near = distance(first, Vec3d(static_cast<double>(c) + 0.5, 0.5, 0.5)) < 1.2;
            total += weight[c] = near ? 3 : 1;
            raised += near ? 3 : 0;
        }
        for (std::size_t c = 0; c < 8; ++c) expected[c] += weight[c] / total;
        const auto cell = static_cast<std::size_t>(set.positions[1].x);
        ++seen[cell];
        raised_seen += weight[cell] == 3;
        raised_expected += raised / total;
        variance += raised / total * (1 - raised / total);
    }
    EXPECT_LT(chi_square(seen, expected), 24.3);  // 7 degrees of freedom, 0.1 %
    EXPECT_LT(std::abs(raised_seen - raised_expected), 3.3 * std::sqrt(variance));
}

TEST(Lane, PointsRespectTheMinimumDistance) {
    for (const float r : {0.3f, 0.1f, 0.07f}) {
        for (const RadialKernel& kernel : {RadialKernel::disk(r), RadialKernel::clustered(r, 4 * r, 8)}) {
            const auto result = sample_dart_throwing(ball(), kernel, {.count = 3000, .seed = 7});
            EXPECT_GE(min_distance(result.points), static_cast<double>(r));
            EXPECT_LT(min_distance(result.points), 1.2 * static_cast<double>(r));
            for (const Vec3 p : result.points.positions) EXPECT_LT(length(p), 1);
        }
    }
}

TEST(Lane, FillsTheWholeRegion) {
    const float r = 0.25f;
    const auto result = sample_dart_throwing(ball(), RadialKernel::disk(r), {.count = 0});
    EXPECT_EQ(result.stop, PointStop::full);
    EXPECT_GE(min_distance(result.points), static_cast<double>(r));
    const CounterRandom random(1, 2);
    int gaps = 0;
    for (std::uint64_t i = 0; i < 50000; ++i) {
        const Vec3 p(Vec3d(random.uniform(3 * i, -1, 1), random.uniform(3 * i + 1, -1, 1),
                           random.uniform(3 * i + 2, -1, 1)));
        if (length(p) >= 1) continue;
        const bool covered = std::any_of(result.points.positions.begin(), result.points.positions.end(),
                                         [&](Vec3 q) { return distance(p, q) < r; });
        gaps += !covered;
    }
    EXPECT_EQ(gaps, 0);
    EXPECT_EQ(sample_dart_throwing(ball(), RadialKernel::disk(r), {.count = 100000}).points, result.points);
}

TEST(Lane, ThinShellsAreFilledOnBothSides) {
    for (const auto density : {PointDensity::inside_boundary, PointDensity::outside_boundary}) {
        const auto result =
            sample_dart_throwing(ball(density, 0.001f), RadialKernel::disk(0.08f), {.count = 1000});
        EXPECT_EQ(result.stop, PointStop::count_reached);
        const bool inside = density == PointDensity::inside_boundary;
        for (const Vec3 p : result.points.positions) {
            EXPECT_NEAR(length(p), inside ? 0.9995f : 1.0005f, 0.00051f);
        }
    }
}

TEST(Lane, ExistingPointsRespectTheMinimumDistance) {
    PointSet old = sample_dart_throwing(ball(), RadialKernel::disk(0.2f), {.count = 100}).points;
    for (Vec3& p : old.positions) p.x -= 1024;
    old.origin = {1024, 0, 0};
    const auto added =
        sample_dart_throwing(ball(), RadialKernel::disk(0.15f), old, {.count = 500, .seed = 4}).points;
    EXPECT_EQ(added.size(), 500u);
    double least = 1e9;
    for (const Vec3 p : added.positions) {
        for (std::size_t i = 0; i < old.size(); ++i)
            least = std::min(least, distance(Vec3d(p), old.world(i)));
    }
    EXPECT_GE(least, 0.15 - 1e-6);
    PointSet heap;
    heap.positions.assign(200000, Vec3{0.5f, 0, 0});
    EXPECT_EQ(sample_dart_throwing(ball(), RadialKernel::disk(0.3f), heap, {.count = 50}).points.size(), 50u);
}

TEST(Lane, IsBitIdenticalForAnyNumberOfThreadsAndDependsOnTheSeed) {
    const RadialKernel kernel = RadialKernel::clustered(0.05f, 0.2f, 3);
    const DartThrowingOptions options{.count = 4000, .seed = 3};
    const auto one = sample_dart_throwing(ball(), kernel, options, {.threads = 1}).points;
    EXPECT_EQ(sample_dart_throwing(ball(), kernel, options, {.threads = 2}).points, one);
    EXPECT_EQ(sample_dart_throwing(ball(), kernel, options, {.threads = 7}).points, one);
    EXPECT_NE(sample_dart_throwing(ball(), kernel, {.count = 4000, .seed = 4}).points, one);
    const auto full =
        sample_dart_throwing(ball(), RadialKernel::disk(0.2f), {.count = 0}, {.threads = 1}).points;
    EXPECT_EQ(sample_dart_throwing(ball(), RadialKernel::disk(0.2f), {.count = 0}, {.threads = 7}).points,
              full);
}

TEST(Lane, RejectsInvalidInput) {
    const auto catch_message = [](const PointRegion& region, const RadialKernel& kernel,
                                  const DartThrowingOptions& options) {
        return error_of([&] { sample_dart_throwing(region, kernel, options); });
    };
    const RadialKernel disk = RadialKernel::disk(0.1f);
    EXPECT_NE(catch_message(ball(), disk, {.count = -1}).find("count must be between"), std::string::npos);
    EXPECT_NE(catch_message(ball(), {}, {.count = 0}).find("distance above 0"), std::string::npos);
    EXPECT_NE(catch_message(ball(), disk, {.resolution = 5000}).find("resolution"), std::string::npos);
    EXPECT_NE(catch_message(ball(), disk, {.max_factor = std::nanf("")}).find("max_factor"),
              std::string::npos);
    EXPECT_NE(catch_message(ball(), disk, {.resolution = 1024, .max_memory = 64}).find("max_memory"),
              std::string::npos);
    EXPECT_NE(catch_message(ball(), disk, {.count = 100000000, .max_memory = 512}).find("max_memory"),
              std::string::npos);
    EXPECT_NE(catch_message(ball(), RadialKernel::clustered(0, 2, 3), {.count = 100000, .resolution = 256})
                  .find("reach"),
              std::string::npos);
    PointRegion far = ball();
    far.box = {{1e6f, 0, 0}, {1e6f + 1, 1, 1}};
    EXPECT_NE(catch_message(far, disk, {}).find("closer to the origin"), std::string::npos);
    PointRegion empty = ball();
    empty.box = {{5, 5, 5}, {6, 6, 6}};
    EXPECT_NE(catch_message(empty, disk, {}).find("density is 0"), std::string::npos);
    for (const float bad : {0.0f, -1.0f, std::nanf(""), std::numeric_limits<float>::infinity()}) {
        PointRegion region = ball();
        region.box.high.y = region.box.low.y + bad;
        EXPECT_NE(catch_message(region, disk, {}).find("have a volume"), std::string::npos);
    }
}

TEST(Lane, StopsWhenCancelled) {
    std::stop_source source;
    source.request_stop();
    EXPECT_THROW(sample_dart_throwing(ball(), {}, {.count = 100000}, {.stop = source.get_token()}),
                 Cancelled);
}

/// Field with values that are not numbers.
struct Broken {
    float value;
    float level() const { return 1; }
    void sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
        for (std::size_t i = 0; i < points.size(); ++i) out[i] = {value, {value, value, value}};
    }
};

TEST(Lane, TerminatesForNonFiniteFields) {
    const Broken nan{std::nanf("")};
    const PointRegion region{FieldRef(nan), ball_box(), DensityCurve(PointDensity::uniform, 1)};
    const auto result = sample_dart_throwing(region, RadialKernel::disk(0.2f),
                                             {.count = 10, .resolution = 8, .max_memory = 1});
    EXPECT_TRUE(result.points.empty());
    const Broken infinite{std::numeric_limits<float>::infinity()};
    const PointRegion dense{FieldRef(infinite), ball_box(), DensityCurve(PointDensity::proportional, 1)};
    EXPECT_LE(sample_dart_throwing(dense, {}, {.count = 10, .resolution = 8, .max_memory = 1}).points.size(),
              10u);
}

}  // namespace
}  // namespace coppice
