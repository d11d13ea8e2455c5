#include "coppice/implicit/shape/revolution.h"

#include "implicit/shape_support.h"

namespace coppice {
namespace {

Profile open_line(std::vector<Vec2d> points, CurveKind kind = CurveKind::polyline) {
    return Profile(points, kind, false);
}

TEST(Revolution, LineParallelToTheAxisIsACylinder) {
    const Revolution cylinder(open_line({{1, 0}, {1, 3}}));
    EXPECT_TRUE(cylinder.is_closed());
    EXPECT_FLOAT_EQ(at(cylinder, {0, 0, 1.5f}).value, -1);
    EXPECT_FLOAT_EQ(at(cylinder, {0.2f, 0, 0.5f}).value, -0.5f);  // the flat end is nearest
    EXPECT_FLOAT_EQ(at(cylinder, {0, 3, 1}).value, 2);
    EXPECT_FLOAT_EQ(at(cylinder, {0, 4, 7}).value, 5);
    EXPECT_LT(length(at(cylinder, {0, 4, 7}).gradient - Vec3{0, 0.6f, 0.8f}), 1e-6f);
    EXPECT_FLOAT_EQ(at(cylinder, {0.3f, 0.4f, -2}).value, 2);
    const Box3 box = cylinder.bounds();
    EXPECT_NEAR(box.low.x, -1, 1e-6);
    EXPECT_NEAR(box.high.z, 3, 1e-6);
}

TEST(Revolution, HalfCircleIsASphere) {
    std::vector<Vec2d> half;
    for (int i = 0; i <= 512; ++i) {
        const double a = std::numbers::pi * (i / 512.0 - 0.5);
        half.push_back({std::max(0.0, 2 * std::cos(a)), 2 * std::sin(a)});
    }
    const Revolution sphere(open_line(half), {.origin = {1, 2, 3}, .direction = {1, 1, 0}});
    for (const Vec3 p : points_in(sphere.bounds(), 500, 0.5f)) {
        const Vec3 v = p - Vec3{1, 2, 3};
        EXPECT_NEAR(at(sphere, p).value, length(v) - 2, 1e-4);
        if (length(v) > 2) {
            EXPECT_LT(length(at(sphere, p).gradient - normalized(v)), 0.01f);
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(sphere.bounds().low[axis], Vec3(1, 2, 3)[axis] - 1.9999f);
        EXPECT_GE(sphere.bounds().high[axis], Vec3(1, 2, 3)[axis] + 1.9999f);
    }
}

TEST(Revolution, ClosedProfileIsATorus) {
    const Revolution torus(Profile(circle_contour({3, 0}, 1, 1024)));
    for (const Vec3 p : points_in(torus.bounds(), 500, 0.3f)) {
        const float r = std::hypot(p.x, p.y) - 3;
        EXPECT_NEAR(at(torus, p).value, std::hypot(r, p.z) - 1, 1e-4);
    }
}

TEST(Revolution, GradientsMatchFiniteDifferences) {
    const Revolution vase(open_line({{0, 0}, {1, 0.2}, {0.4, 1}, {0.9, 2}, {0, 2.5}}, CurveKind::catmull_rom),
                          {.direction = {0, 1, 2}});
    EXPECT_LT(share_of_wrong_gradients(vase, points_in(vase.bounds(), 1000, 0.3f), 1e-3f, 0.02f), 0.03);
    expect_bounds_hold_the_inside(vase);
    expect_survives_strange_points(vase);
    expect_batch_does_not_matter(vase);
}

TEST(Revolution, RejectsInvalidProfiles) {
    EXPECT_NE(error_of([] {
                  Revolution(open_line({{-1, 0}, {1, 1}}));
              }).find("beyond the axis"),
              std::string::npos);
    EXPECT_NE(error_of([] {
                  Revolution(open_line({{0, 0}, {0, 1}}));
              }).find("are on the axis"),
              std::string::npos);
    EXPECT_NE(error_of([] {
                  Revolution(open_line({{1, 0}, {1, 1}}), {.direction = {0, 0, 0}});
              }).find("direction"),
              std::string::npos);
    EXPECT_NE(error_of([] {
                  Revolution(open_line({{1, 0}, {1, 1}}), {.origin = {kNan, 0, 0}});
              }).find("origin"),
              std::string::npos);
    EXPECT_NE(error_of([] { Revolution(open_line({{1, 1}, {2, 1}})); }).find("no volume"), std::string::npos);
}

}  // namespace
}  // namespace coppice
