#include "coppice/implicit/shape/sweep.h"

#include "implicit/shape_support.h"

namespace coppice {
namespace {

const std::vector<Vec2d> kSquare{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

Curve line(std::vector<Vec3> points, bool closed = false) {
    return Curve(points, {.kind = CurveKind::polyline, .closed = closed});
}

Profile circle(double radius, Vec2d center = {}) { return Profile(circle_contour(center, radius, 512)); }

Curve arch() { return Curve(std::vector<Vec3>{{0, 0, 0}, {0, 0, 4}, {3, 1, 6}, {6, 0, 4}, {6, 0, 0}}); }

TEST(Sweep, ASquareAlongALineIsABox) {
    const Sweep box(line({{0, 0, 0}, {0, 0, 4}}), Profile(kSquare));
    EXPECT_TRUE(box.is_closed());
    EXPECT_FLOAT_EQ(at(box, {0, 0, 2}).value, -1);
    EXPECT_FLOAT_EQ(at(box, {0, 0, 0.25f}).value, -0.25f);
    EXPECT_LT(length(at(box, {0, 0, 0.25f}).gradient - Vec3{0, 0, -1}), 1e-6f);
    EXPECT_FLOAT_EQ(at(box, {3, 0, 2}).value, 2);
    EXPECT_FLOAT_EQ(at(box, {0.5f, 0.5f, 7}).value, 3);
    EXPECT_FLOAT_EQ(at(box, {1, 4, 8}).value, 5);
    EXPECT_LT(length(at(box, {1, 4, 8}).gradient - Vec3{0, 0.6f, 0.8f}), 1e-6f);
    EXPECT_FLOAT_EQ(at(box, {3, 4, -6}).value, 7);  // 2, 3 and 6 from the corner
    EXPECT_NEAR(box.bounds().low.z, 0, 1e-5);
    EXPECT_NEAR(box.bounds().high.x, 1, 1e-5);
}

TEST(Sweep, CircleAlongARingIsATorus) {
    std::vector<Vec3> points;
    for (int i = 0; i < 128; ++i) {
        const float a = std::numbers::pi_v<float> * static_cast<float>(i) / 64;
        points.push_back({3 * std::cos(a), 3 * std::sin(a), 0});
    }
    const Sweep torus(Curve(points, {.closed = true}), circle(1));
    for (const Vec3 p : points_in(torus.bounds(), 500, 0.2f)) {
        const float r = std::hypot(p.x, p.y);
        if (r < 0.1f) continue;
        EXPECT_NEAR(at(torus, p).value, std::hypot(r - 3, p.z) - 1, 2e-4);
    }
}

TEST(Sweep, CircleAlongASplineIsATube) {
    const Curve path = arch();
    const Sweep tube(path, circle(0.5));
    const CurveShape axis(path);
    for (const Vec3 p : points_in(path.bounds(), 1000, 0.2f)) {
        const CurvePlace nearest = path.closest(Vec3d(p));
        const double f = path.fraction(nearest);
        const float d = at(axis, p).value;
        if (f < 0.1 || f > 0.9 || d < 0.05f) continue;
        EXPECT_NEAR(at(tube, p).value, d - 0.5f, 1e-4);
    }
}

TEST(Sweep, CornersOfPolylinesAreRounded) {
    // Outside the corner of an L, the tube is a ball around the corner.
    const Sweep pipe(line({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}}), circle(0.5));
    EXPECT_NEAR(at(pipe, {5, -1, 0}).value, std::sqrt(2.0) - 0.5, 1e-4);
    EXPECT_NEAR(at(pipe, {4.6f, -0.8f, 0.3f}).value, std::sqrt(0.36 + 0.64 + 0.09) - 0.5, 1e-4);
    EXPECT_NEAR(at(pipe, {2, 2, 0}).value, 1.5, 1e-4);
    // The value is continuous where the corner begins.
    EXPECT_NEAR(at(pipe, {3.9999f, -2, 0.7f}).value, at(pipe, {4.0001f, -2, 0.7f}).value, 1e-3);
    const Sweep beam(line({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}}), Profile(kSquare));
    for (const float z : {-0.7f, 0.2f, 1.5f})
        EXPECT_NEAR(at(beam, {3.9999f, -2, z}).value, at(beam, {4.0001f, -2, z}).value, 1e-3);
}

TEST(Sweep, AppliesScaleTwistAndRoll) {
    const std::vector<ScaleAt> scales{{0, 1}, {1, 2}};
    const Sweep cone(line({{0, 0, 0}, {0, 0, 10}}), circle(1), scales);
    // At half height the radius is 1.5; the value is a distance in the plane.
    EXPECT_NEAR(at(cone, {2, 0, 5}).value, 0.5, 1e-4);
    EXPECT_NEAR(at(cone, {1.25f, 0, 5}).value, -0.25, 1e-4);
    EXPECT_NEAR(at(cone, {2, 0, 5}).gradient.z, -0.1, 1e-3);
    EXPECT_NEAR(cone.bounds().high.x, 2, 1e-4);

    const Sweep screw(line({{0, 0, 0}, {0, 0, 8}}), Profile(kSquare), {},
                      {.twist = 2 * std::numbers::pi_v<float>});
    // After an eighth of a turn the corner is on the x axis.
    EXPECT_NEAR(at(screw, {1.4f, 0, 1}).value, -0.0142136 / std::sqrt(2.0), 1e-5);
    EXPECT_NEAR(at(screw, {1.4f, 0, 2}).value, 0.4, 1e-5);
    const Sweep rolled(line({{0, 0, 0}, {0, 0, 8}}), Profile(kSquare), {},
                       {.roll = std::numbers::pi_v<float> / 4});
    EXPECT_NEAR(at(rolled, {std::sqrt(2.0f), 0, 4}).value, 0, 1e-6);
}

TEST(Sweep, ValuesAreContinuousAcrossTheMedialAxisOfThePath) {
    // Off-centre profiles: with the nearest place of the path only, the halves of the arch would not match.
    const Sweep tube(arch(), circle(0.4, {0.3, 0.2}));
    for (int i = 0; i < 200; ++i) {
        const float z = 0.03f * static_cast<float>(i), y = 0.3f;
        const float left = at(tube, {2.9995f, y, z}).value, right = at(tube, {3.0005f, y, z}).value;
        EXPECT_NEAR(left, right, 2e-3) << z;
    }
}

TEST(Sweep, GradientsMatchFiniteDifferences) {
    const std::vector<ScaleAt> scales{{0.1f, 1}, {0.6f, 0.5f}, {1, 1.2f}};
    const Sweep all(arch(), Profile(circle_contour({0.1, 0.2}, 0.7, 7)), scales, {.roll = 0.3f, .twist = 2});
    // Creases are where the nearest edge, cap, or section of the path changes.
    EXPECT_LT(share_of_wrong_gradients(all, points_in(all.bounds(), 2000, 0.05f), 5e-4f, 0.03f), 0.04);
    expect_bounds_hold_the_inside(all);
    expect_survives_strange_points(all);
    expect_batch_does_not_matter(all);
}

TEST(Sweep, BoundsContainSweptPolylines) {
    expect_bounds_hold_the_inside(
        Sweep(line({{0, 0, 0}, {4, 0, 0}, {4, 4, 1}, {0, 5, 2}}), Profile(circle_contour({0.3, 0}, 0.6, 5))));
    expect_bounds_hold_the_inside(Sweep(line({{0, 0, 0}, {4, 0, 0}, {4, 4, 1}}, true),
                                        Profile(circle_contour({0, 0.4}, 0.5, 4)), {},
                                        {.twist = 4 * std::numbers::pi_v<float>}));
}

TEST(Sweep, RejectsInvalidOptions) {
    const auto with_scales = [](std::vector<ScaleAt> scales) {
        return error_of([&] { Sweep(line({{0, 0, 0}, {0, 0, 1}}), circle(1), scales); });
    };
    EXPECT_NE(with_scales({{0, 0}}).find("above 0"), std::string::npos);
    EXPECT_NE(with_scales({{0, kNan}}).find("above 0"), std::string::npos);
    EXPECT_NE(with_scales({{0, 1e6f}}).find("at most 1000"), std::string::npos);
    EXPECT_NE(with_scales({{0.5f, 1}, {0.5f, 2}}).find("increase"), std::string::npos);
    EXPECT_NE(with_scales({{-1, 1}}).find("increase"), std::string::npos);
    EXPECT_NE(error_of([] {
                  Sweep(line({{0, 0, 0}, {0, 0, 1}}), Profile(kSquare, CurveKind::polyline, false));
              }).find("open"),
              std::string::npos);
    EXPECT_NE(error_of([] {
                  Sweep(line({{0, 0, 0}, {0, 0, 1}, {0, 0, 0.5f}}), circle(1));
              }).find("turns back"),
              std::string::npos);
    EXPECT_NE(error_of([] {
                  Sweep(line({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, true), circle(0.1), {}, {.twist = 1});
              }).find("whole number of turns"),
              std::string::npos);
    EXPECT_NE(error_of([] {
                  Sweep(line({{0, 0, 0}, {0, 0, 1}}), circle(1), {}, {.roll = kNan});
              }).find("roll"),
              std::string::npos);
}

}  // namespace
}  // namespace coppice
