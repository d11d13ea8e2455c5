#include "coppice/implicit/shape/curve.h"

#include "implicit/shape_support.h"

namespace coppice {
namespace {

constexpr CurveKind kKinds[] = {CurveKind::polyline, CurveKind::catmull_rom, CurveKind::natural};

std::vector<Vec3> helix(int count, float turns, float rise) {
    std::vector<Vec3> points;
    for (int i = 0; i < count; ++i) {
        const float a =
            turns * 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(count - 1);
        points.push_back({std::cos(a), std::sin(a), rise * a});
    }
    return points;
}

std::vector<Vec3> ring(int count) {
    std::vector<Vec3> points;
    for (int i = 0; i < count; ++i) {
        const float a = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(count);
        points.push_back({std::cos(a), std::sin(a), 0});
    }
    return points;
}

/// Returns the distance by sampling every arc densely.
double distance_by_steps(const Curve& curve, Vec3d p, int steps) {
    double least = 1e300;
    for (std::uint32_t i = 0; i < curve.arcs().size(); ++i)
        for (int k = 0; k <= steps; ++k)
            least = std::min(least, distance(curve.position({i, static_cast<double>(k) / steps}), p));
    return least;
}

TEST(Curve, PassesThroughItsPoints) {
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {1.5f, 2, 0.5f}, {0, 3, 1}, {-4, 0, 2}};
    for (const CurveKind kind : kKinds)
        for (const bool closed : {false, true}) {
            const Curve curve(points, {.kind = kind, .closed = closed});
            EXPECT_EQ(curve.span_count(), closed ? 5u : 4u);
            for (std::size_t i = 0; i < points.size(); ++i) {
                const Vec3d at = curve.position(curve.at_index(static_cast<double>(i)));
                EXPECT_LT(distance(at, Vec3d(points[i])), 1e-12);
            }
        }
}

TEST(Curve, TangentsAndCurvatureOfNaturalSplinesAreContinuous) {
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {1.5f, 2, 0.5f}, {0, 3, 1}, {-4, 0, 2}};
    for (const bool closed : {false, true}) {
        for (const CurveKind kind : {CurveKind::catmull_rom, CurveKind::natural}) {
            const Curve curve(points, {.kind = kind, .closed = closed});
            const auto arcs = curve.arcs();
            for (std::size_t i = 0; i + (closed ? 0 : 1) < arcs.size(); ++i) {
                const CurveArc &a = arcs[i], &b = arcs[(i + 1) % arcs.size()];
                EXPECT_LT(length(a.tangent(1) - b.tangent(0)), 1e-9);
                if (kind != CurveKind::natural) continue;
                const auto curvature = [](const CurveArc& arc, double t) {
                    return cross(arc.first(t), arc.second(t)) / std::pow(length(arc.first(t)), 3);
                };
                EXPECT_LT(length(curvature(a, 1) - curvature(b, 0)), 1e-8);
            }
            if (!closed && kind == CurveKind::natural) {
                EXPECT_LT(length(arcs.front().second(0)), 1e-9);
                EXPECT_LT(length(arcs.back().second(1)), 1e-9);
            }
        }
    }
}

TEST(Curve, ComputesLength) {
    const Curve line(std::vector<Vec3>{{0, 0, 0}, {3, 4, 0}, {3, 4, 2}}, {.kind = CurveKind::polyline});
    EXPECT_DOUBLE_EQ(line.length(), 7);
    EXPECT_NEAR(line.fraction(line.at_index(1)), 5.0 / 7, 1e-12);
    EXPECT_NEAR(line.position(line.at_fraction(6.0 / 7)).z, 1, 1e-12);
    // 64 points on a circle: the deviation of the spline is much smaller than that of the polygon, which has
    // 0.9996 of its length.
    for (const CurveKind kind : {CurveKind::catmull_rom, CurveKind::natural})
        EXPECT_NEAR(Curve(ring(64), {.kind = kind, .closed = true}).length(), 2 * std::numbers::pi, 1e-5);
}

TEST(Curve, FractionAndPlaceAreInverse) {
    for (const CurveKind kind : kKinds) {
        const Curve curve(helix(9, 1.5f, 0.2f), {.kind = kind});
        for (int i = 0; i <= 100; ++i)
            EXPECT_NEAR(curve.fraction(curve.at_fraction(0.01 * i)), 0.01 * i, 1e-10);
        EXPECT_EQ(curve.fraction(curve.at_fraction(-3)), 0);
        EXPECT_EQ(curve.fraction(curve.at_fraction(7)), 1);
    }
}

TEST(Curve, FindsTheClosestPointOfSpirals) {
    // Turns are 0.13 apart along the axis: many local minima.
    for (const CurveKind kind : kKinds) {
        const Curve curve(helix(200, 12, 0.02f), {.kind = kind});
        for (const Vec3 p : points_in(curve.bounds(), 300, 0.2f)) {
            const Vec3d q(p);
            const double found = distance(curve.position(curve.closest(q)), q);
            EXPECT_LE(found, distance_by_steps(curve, q, 64) + 1e-12);
            EXPECT_GE(found, distance_by_steps(curve, q, 64) - 1e-3);
        }
    }
}

TEST(Curve, ClosestPointOfATightLoopIsGlobal) {
    const Curve curve(
        std::vector<Vec3>{{0, 0, 0}, {2, 0, 0}, {2, 0.2f, 0}, {0, 0.2f, 0}, {1, 2, 0}, {1, -2, 0.3f}});
    for (const Vec3 p : points_in(curve.bounds(), 500, 0.5f)) {
        const Vec3d q(p);
        EXPECT_LE(distance(curve.position(curve.closest(q)), q), distance_by_steps(curve, q, 256) + 1e-12);
    }
}

TEST(Curve, HintDoesNotAffectTheClosestPoint) {
    const Curve curve(helix(50, 5, 0.05f));
    for (const Vec3 p : points_in(curve.bounds(), 200, 0.2f)) {
        const CurvePlace plain = curve.closest(Vec3d(p)),
                         hinted = curve.closest(Vec3d(p), curve.at_fraction(0.7));
        EXPECT_EQ(plain.arc, hinted.arc);
        EXPECT_EQ(plain.t, hinted.t);
    }
}

TEST(Curve, FramesAreOrthonormalAndRotationMinimizing) {
    const Curve curve(helix(40, 3, 0.1f));
    Vec3d last = curve.frame({0, 0}).normal;
    for (int i = 0; i <= 1000; ++i) {
        const CurveFrame f = curve.frame(curve.at_fraction(0.001 * i));
        EXPECT_NEAR(length(f.normal), 1, 1e-12);
        EXPECT_NEAR(dot(f.normal, f.tangent), 0, 1e-12);
        EXPECT_LT(length(cross(f.normal, f.binormal) - f.tangent), 1e-12);
        // The derivative of the normal is parallel to the tangent: perpendicular to it, steps are second
        // order.
        const Vec3d step = f.normal - last;
        EXPECT_LT(std::abs(dot(step, f.binormal)), 2e-4);
        last = f.normal;
    }
}

TEST(Curve, FramesOfAHelixHaveTheTheoreticalRotation) {
    // Relative to Frenet's frame, the rotation-minimizing one turns by minus torsion times length. Radius 1
    // and rise 0.5 per radian: torsion 0.5 / 1.25 = 0.4, length sqrt(1.25) per radian; one turn: -2.8099.
    const Curve curve(helix(400, 1, 0.5f), {.kind = CurveKind::natural});
    const auto angle_to_frenet = [&](double fraction) {
        const CurveFrame f = curve.frame(curve.at_fraction(fraction));
        const Vec3d inward = normalized(Vec3d{-f.position.x, -f.position.y, 0});
        return std::atan2(dot(f.normal, cross(f.tangent, inward)), dot(f.normal, inward));
    };
    // The ends of a natural spline are straight; the test uses the middle half, half a turn.
    const double turn = angle_to_frenet(0.75) - angle_to_frenet(0.25);
    EXPECT_NEAR(std::remainder(turn + 0.4 * std::sqrt(1.25) * std::numbers::pi, 2 * std::numbers::pi), 0,
                2e-3);
}

TEST(Curve, FramesOfClosedCurvesAgreeAtTheSeam) {
    std::vector<Vec3> points = ring(12);
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i].z = 0.6f * std::sin(static_cast<float>(i) * 2.5f);
    for (const CurveKind kind : kKinds) {
        const Curve curve(points, {.kind = kind, .closed = true});
        const CurveFrame start = curve.frame(curve.at_fraction(0)), end = curve.frame(curve.at_fraction(1));
        if (kind == CurveKind::polyline) continue;  // they differ by the corner
        EXPECT_LT(length(start.normal - end.normal), 1e-6);
        EXPECT_GT(std::abs(curve.closing_roll()), 1e-3);
    }
}

TEST(Curve, FrameOfAVerticalLineHasTheWorldAxes) {
    const Curve up(std::vector<Vec3>{{0, 0, 0}, {0, 0, 1}});
    EXPECT_EQ(up.frame({0, 0.5}).normal, (Vec3d{1, 0, 0}));
    EXPECT_EQ(up.frame({0, 0.5}).binormal, (Vec3d{0, 1, 0}));
}

TEST(Curve, CentripetalSplinesHaveNoLoopsAtShortPieces) {
    const Curve curve(std::vector<Vec3>{{0, 0, 0}, {10, 0, 0}, {10.01f, 0.01f, 0}, {10, 10, 0}});
    const Box3 box = curve.bounds();
    EXPECT_LT(box.high.x, 10.5f);
    EXPECT_GT(box.low.y, -0.5f);
}

TEST(CurveShape, ComputesDistanceAndGradient) {
    const CurveShape line(Curve(std::vector<Vec3>{{0, 0, 0}, {2, 0, 0}}, {.kind = CurveKind::polyline}));
    EXPECT_FALSE(line.is_closed());
    EXPECT_EQ(at(line, {1, 3, 4}).value, 5);
    EXPECT_LT(length(at(line, {1, 3, 4}).gradient - Vec3{0, 0.6f, 0.8f}), 1e-6f);
    EXPECT_EQ(at(line, {5, 4, 0}).value, 5);
    EXPECT_EQ(at(line, {1, 0, 0}).value, 0);
    EXPECT_NEAR(length(at(line, {1, 0, 0}).gradient), 1, 1e-6);
    for (const CurveKind kind : kKinds) {
        const CurveShape shape(Curve(helix(30, 2, 0.3f), {.kind = kind}));
        EXPECT_LT(share_of_wrong_gradients(shape, points_in(shape.bounds(), 1000, 0.3f), 1e-3f, 1e-2f), 0.02);
        expect_survives_strange_points(shape);
        expect_batch_does_not_matter(shape);
    }
}

TEST(Curve, RejectsInvalidPoints) {
    const auto curve = [](std::vector<Vec3> points, bool closed = false) {
        return error_of([&] { Curve(points, {.closed = closed}); });
    };
    EXPECT_EQ(curve({{0, 0, 0}}), "curve: an open curve needs 2 to 1000000 points, but has 1");
    EXPECT_EQ(curve({{0, 0, 0}, {1, 0, 0}}, true),
              "curve: a closed curve needs 3 to 1000000 points, but has 2");
    EXPECT_EQ(curve({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}), "curve: points 2 and 3 coincide; remove one");
    EXPECT_EQ(curve({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}}, true),
              "curve: points 4 and 1 coincide; remove one");
    EXPECT_NE(curve({{0, 0, 0}, {kNan, 0, 0}}).find("point 2"), std::string::npos);
    EXPECT_NE(curve({{0, 0, kInfinite}, {1, 0, 0}}).find("point 1"), std::string::npos);
    EXPECT_NE(curve({{0, 2e9f, 0}, {1, 0, 0}}).find("1e9 m"), std::string::npos);
    EXPECT_EQ(curve({{-1e9f, 0, 0}, {1e9f, 1e-3f, 0}, {1e9f, 1e9f, 0}}), "no error");
}

}  // namespace
}  // namespace coppice
