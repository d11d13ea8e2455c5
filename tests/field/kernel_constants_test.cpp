#include "coppice/field/kernel/kernel_constants.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "coppice/base/error.h"
#include "errors.h"
#include "field/support.h"

// The values of the tables were computed independently, without truncating the lines of infinite kernels, and
// by numerical integration if there was no closed form; the tolerance of 0.012 covers their rounding and the
// finite length of the lines.

namespace coppice {
namespace {

using test::DoubleField;

constexpr double kFar = 200;
constexpr double kPi = std::numbers::pi;
const Vec3d kOrigin{0, 0, 0}, kX{1, 0, 0}, kZ{0, 0, 1};

struct Column {
    const char* name;
    KernelConstants kernel;
};
const std::array<Column, 7> kColumns{{{"Cauchy 1", test::cauchy(1)},
                                      {"Cauchy 2", test::cauchy(2)},
                                      {"Cauchy 3", test::cauchy(3)},
                                      {"quartic 1.5", test::quartic(1.5)},
                                      {"quartic 2", test::quartic(2)},
                                      {"quartic 3", test::quartic(3)},
                                      {"SCALIS", test::scalis()}}};

template <class Measure>
void expect_row(const char* row, const std::array<double, 7>& expected, const Measure& measure,
                double tolerance = 0.012) {
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
        EXPECT_NEAR(measure(kColumns[i].kernel), expected[i], tolerance) << row << ", " << kColumns[i].name;
    }
}

TEST(KernelConstants, RadiusAtFreeEndsMatchesTheTable) {
    const auto line = [](const auto& k) { return DoubleField(k).add({-kFar, 0, 0}, kOrigin); };
    expect_row("radius at the end", {0.51, 0.73, 0.77, 0.78, 0.20, 0, 0.59},
               [&](const auto& k) { return line(k).reach(kOrigin, kZ); });
    expect_row("radius 1 inside", {0.90, 0.955, 0.964, 1.00, 0.954, 0.47, 0.98}, [&](const auto& k) {
        return line(k).reach({-1, 0, 0}, kZ);
    });
    expect_row("reach beyond", {0.24, 0.505, 0.556, 0.46, 0.03, 0, 0.25}, [&](const auto& k) {
        return std::max(0.0, line(k).reach({-0.01, 0, 0}, kX) - 0.01);
    });
}

TEST(KernelConstants, RadiusInTheMiddleOfShortSegmentsMatchesTheTable) {
    const auto middle = [](double l) {
        return [l](const auto& k) {
            return DoubleField(k).add({-l / 2, 0, 0}, {l / 2, 0, 0}).reach(kOrigin, kZ);
        };
    };
    expect_row("2", {0.79, 0.91, 0.93, 1.0, 0.89, 0, 0.96}, middle(2));
    expect_row("4", {0.94, 0.98, 0.98, 1.0, 1.0, 0.91, 1.0}, middle(4));
    expect_row("8", {0.99, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0}, middle(8));
    // The shortest isolated segment with a surface: the table's 0.37 and 1.09.
    EXPECT_LT(DoubleField(test::quartic(1.5)).add({-0.18, 0, 0}, {0.18, 0, 0}).value(kOrigin), 1);
    EXPECT_GT(DoubleField(test::quartic(1.5)).add({-0.19, 0, 0}, {0.19, 0, 0}).value(kOrigin), 1);
    EXPECT_LT(DoubleField(test::quartic(2)).add({-0.54, 0, 0}, {0.54, 0, 0}).value(kOrigin), 1);
    EXPECT_GT(DoubleField(test::quartic(2)).add({-0.55, 0, 0}, {0.55, 0, 0}).value(kOrigin), 1);
}

TEST(KernelConstants, RadiusAtBendsMatchesTheTable) {
    const auto bend = [](double degrees, double side) {
        const double h = degrees * kPi / 360;
        return [h, side](const auto& k) {
            return DoubleField(k)
                .add({-kFar, 0, 0}, kOrigin)
                .add(kOrigin, {kFar * std::cos(2 * h), 0, kFar * std::sin(2 * h)})
                .reach(kOrigin, {side * std::sin(h), 0, -side * std::cos(h)});
        };
    };
    expect_row("30 outer", {0.87, 0.90, 0.90, 0.905, 0.85, 0.77, 0.88}, bend(30, 1));
    expect_row("30 inner", {1.19, 1.15, 1.14, 1.13, 1.20, 1.33, 1.17}, bend(30, -1));
    expect_row("90 outer", {0.71, 0.77, 0.79, 0.78, 0.67, 0.52, 0.72}, bend(90, 1));
    expect_row("90 inner", {1.95, 1.79, 1.75, 1.61, 1.86, 2.39, 1.75}, bend(90, -1));
}

TEST(KernelConstants, RadiusAtNodesWithEqualChildrenMatchesTheTable) {
    const auto node = [](const auto& k, int children, double degrees) {
        DoubleField f(k);
        f.add({0, 0, -kFar}, kOrigin);
        const double polar = degrees * kPi / 180;
        for (int i = 0; i < children; ++i) {
            const double turn = 2 * kPi * i / children;
            f.add(kOrigin, kFar * Vec3d{std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                                        std::cos(polar)});
        }
        return f;
    };
    const auto horizontal = [&](int children, double degrees) {
        return [&node, children, degrees](const auto& k) {
            const auto f = node(k, children, degrees);
            double least = 1e9;
            for (int i = 0; i < 60; ++i) {
                least =
                    std::min(least, f.reach(kOrigin, {std::cos(i * kPi / 30), std::sin(i * kPi / 30), 0}));
            }
            return least;
        };
    };
    const auto up = [&](int children, double degrees) {
        return [&node, children, degrees](const auto& k) {
            return node(k, children, degrees).reach(kOrigin, kZ);
        };
    };
    expect_row("2 at 60 horizontal", {1.27, 1.18, 1.16, 1.09, 1.20, 1.48, 1.15}, horizontal(2, 60));
    expect_row("2 at 60 up", {1.57, 1.44, 1.41, 1.31, 1.48, 1.86, 1.41}, up(2, 60));
    expect_row("7 at 45 horizontal", {2.34, 1.99, 1.92, 1.48, 1.76, 2.43, 1.65}, horizontal(7, 45));
    expect_row("7 at 45 up", {3.41, 2.85, 2.73, 1.83, 2.29, 3.26, 2.14}, up(7, 45), 0.016);
}

TEST(KernelConstants, RadiusOfThinLateralsOnATrunkMatchesTheTable) {
    const auto lateral = [](double height) {
        return [height](const auto& k) {
            return DoubleField(k)
                       .add({-kFar, 0, 0}, {kFar, 0, 0})
                       .add(kOrigin, {0, 0, kFar}, 0.1, 0.1)
                       .reach({0, 0, 1 + 0.1 * height}, {0, 1, 0}) /
                   0.1;
        };
    };
    expect_row("1 above", {2.34, 1.75, 1.63, 1.18, 1.57, 2.46, 1.41}, lateral(1));
    expect_row("4 above", {1.55, 1.24, 1.20, 1.01, 1.23, 2.04, 1.11}, lateral(4));
    expect_row("10 above", {1.19, 1.07, 1.06, 1.00, 1.00, 1.44, 1.00}, lateral(10));
}

/// Returns the maximum relative error of the radius in one segment of an infinite taper: each segment is 3
/// radii long and ends with `ratio` times its initial radius.
double taper_error(const KernelConstants& k, double ratio, double weight = 1) {
    DoubleField f(k);
    double x = 0, r = 1;
    for (int i = 0; i < 14; ++i, x += 3 * r, r *= ratio)
        f.add({x, 0, 0}, {x + 3 * r, 0, 0}, r, r * ratio, weight);
    x = 0, r = 1 / ratio;
    for (int i = 0; i < 14; ++i, x -= 3 * r, r /= ratio)
        f.add({x - 3 * r, 0, 0}, {x, 0, 0}, r, r * ratio, weight);
    double worst = 0;
    for (int i = 0; i <= 60; ++i) {
        const double radius = 1 + (ratio - 1) * i / 60.0;
        const double error = f.reach({i / 20.0, 0, 0}, kZ) / radius - 1;
        if (std::abs(error) > std::abs(worst)) worst = error;
    }
    return worst;
}

TEST(KernelConstants, TaperErrorWithTheLocalRadiusIsBounded) {
    EXPECT_LT(std::abs(taper_error(test::quartic(1.5), 0.7)), 0.014);
    EXPECT_LT(std::abs(taper_error(test::quartic(1.5), 0.5)), 0.023);
    EXPECT_LT(std::abs(taper_error(test::quartic(2), 0.7)), 0.028);
    EXPECT_LT(std::abs(taper_error(test::quartic(2), 0.5)), 0.046);
    EXPECT_LT(std::abs(taper_error(test::cauchy(2), 0.7)), 0.015);
    EXPECT_LT(std::abs(taper_error(test::cauchy(2), 0.5)), 0.031);
}

TEST(KernelConstants, ScalisWeightCompensatesForTheTaper) {
    EXPECT_NEAR(taper_error(test::scalis(), 0.7), 0.009, 0.001);
    EXPECT_NEAR(taper_error(test::scalis(), 0.5), 0.025, 0.0015);
    // The builder's weight compensates for the slope.
    const SegmentBuilder builder({.kernel = Kernel::scalis});
    for (const float ratio : {0.7f, 0.5f}) {
        const auto s = builder.build({{0, 0, 0}, {3, 0, 0}, 1, ratio}, {0, 0, 1}, false, RootEnd::none);
        EXPECT_LT(std::abs(taper_error(test::scalis(), ratio, s.weight)), 0.002);
    }
}

/// Newton steps along the normal of an infinite line until |h - 1| < 1e-4, on g(F); 0 = no convergence.
template <class Transform>
int newton_steps(const KernelConstants& k, double h, const Transform& g) {
    const auto line = DoubleField(k).add({-1e4, 0, 0}, {1e4, 0, 0});
    for (int steps = 0; steps < 20; ++steps) {
        if (std::abs(h - 1) < 1e-4) return steps;
        const auto f = line.sample({0, h, 0});
        if (f.value <= 0) return 0;
        const auto [value, slope] = g(f.value);
        h = std::max(h - value / (slope * f.gy), 0.25 * h);  // a step never crosses the line
    }
    return 0;
}

using Pair = std::array<double, 2>;
Pair plain(double f) { return {f - 1, 1}; }
Pair logarithm(double f) { return {std::log(f), 1 / f}; }
Pair minus_two_thirds(double f) { return {std::pow(f, -2.0 / 3) - 1, -2.0 / 3 * std::pow(f, -5.0 / 3)}; }
Pair two_fifths(double f) { return {std::pow(f, 0.4) - 1, 0.4 * std::pow(f, -0.6)}; }

TEST(KernelConstants, NewtonConvergesFasterOnTheTransformedField) {
    const auto steps = [](const KernelConstants& k, const std::vector<double>& starts, Pair (*g)(double)) {
        std::vector<int> n;
        for (const double h : starts) n.push_back(newton_steps(k, h, g));
        return n;
    };
    const std::vector<double> starts{0.1, 0.3, 0.5, 0.7, 1.2, 1.41, 2, 3};
    EXPECT_EQ(steps(test::cauchy(2), starts, plain), (std::vector{4, 5, 5, 4, 3, 5, 6, 5}));
    EXPECT_EQ(steps(test::cauchy(2), starts, logarithm), (std::vector{5, 3, 3, 3, 2, 3, 4, 3}));
    EXPECT_EQ(steps(test::cauchy(2), starts, minus_two_thirds), (std::vector{6, 4, 4, 3, 3, 3, 4, 4}));
    const std::vector<double> inner{0.1, 0.3, 0.5, 0.7, 1.2, 1.41, 1.8, 1.95, 2.12};
    EXPECT_EQ(steps(test::quartic(2), inner, plain), (std::vector{0, 4, 3, 2, 2, 3, 4, 4, 0}));
    EXPECT_EQ(steps(test::quartic(2), inner, two_fifths), (std::vector{0, 4, 4, 3, 3, 3, 3, 4, 0}));
}

TEST(KernelConstants, TipExtensionMovesTheSurfaceOneRadiusBeyondTheTip) {
    const auto extension = [](const FieldOptions& o) { return SegmentBuilder(o).tip_extension(); };
    EXPECT_NEAR(extension({.kernel = Kernel::quartic, .support = 1.5f}), 0.540, 0.002);
    EXPECT_NEAR(extension({.kernel = Kernel::quartic, .support = 2.0f}), 0.973, 0.002);
    EXPECT_NEAR(extension({.kernel = Kernel::cauchy, .width = 2.0f}), 0.496, 0.002);
    EXPECT_NEAR(extension({.kernel = Kernel::scalis}), 0.750, 0.002);
}

TEST(KernelConstants, SteepSegmentsRemainInTheRangeOfScalis) {
    const SegmentBuilder builder({.kernel = Kernel::scalis});
    const auto s = builder.build({{0, 0, 0}, {1, 0, 0}, 5, 0.5f}, {0, 0, 1}, true, RootEnd::base);
    EXPECT_FLOAT_EQ(s.slope, -0.4f);
    EXPECT_FLOAT_EQ(s.radius + s.slope * s.length, 0.5f);
    EXPECT_GT(s.radius + s.slope * s.end, 0);
    EXPECT_GT(s.radius + s.slope * s.begin, 0);
}

TEST(KernelConstants, RejectsOptionsOutOfRangeByName) {
    EXPECT_EQ(test::error_of([] { SegmentBuilder({.support = 0.5f}); }),
              "field: support must be between 1.1 and 4, but is 0.5");
    EXPECT_THROW(SegmentBuilder({.width = NAN}), InvalidInput);
    EXPECT_THROW(SegmentBuilder({.tip_extension = 5}), InvalidInput);
}

}  // namespace
}  // namespace coppice
