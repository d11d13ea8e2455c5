#include "coppice/implicit/shape/variational.h"

#include "coppice/implicit/shape/variational_internal.h"
#include "implicit/shape_support.h"

namespace coppice {
namespace {

struct Sample {
    std::vector<Vec3> points, normals;
};

/// Evenly distributed on a sphere, along a spiral.
Sample ball(int count, float radius, Vec3 center) {
    Sample s;
    for (int i = 0; i < count; ++i) {
        const float z = 1 - (2 * static_cast<float>(i) + 1) / static_cast<float>(count),
                    a = 2.3999632f * static_cast<float>(i);
        const float r = std::sqrt(1 - z * z);
        s.normals.push_back({r * std::cos(a), r * std::sin(a), z});
        s.points.push_back(center + radius * s.normals.back());
    }
    return s;
}

TEST(Variational, ReconstructsASphere) {
    const Vec3 center{10, -20, 5};
    const Sample s = ball(200, 3, center);
    const Variational v(s.points, s.normals);
    EXPECT_TRUE(v.is_closed());
    for (std::size_t i = 0; i < s.points.size(); ++i) {
        EXPECT_NEAR(at(v, s.points[i]).value, 0, 1e-4);
        EXPECT_LT(length(at(v, s.points[i]).gradient - s.normals[i]), 0.02f);
    }
    for (const Vec3 u : ball(57, 1, {}).points) {
        EXPECT_NEAR(at(v, center + 3.0f * u).value, 0, 0.005);
        EXPECT_NEAR(at(v, center + 3.2f * u).value, 0.2, 0.02);
        EXPECT_NEAR(at(v, center + 2.8f * u).value, -0.2, 0.02);
    }
    EXPECT_LT(at(v, center).value, -1);
    EXPECT_GT(at(v, {100, 0, 0}).value, 80);
}

TEST(Variational, GradientsMatchFiniteDifferences) {
    Sample s = ball(60, 1, {});
    for (Vec3& p : s.points)
        p = {2 * p.x, p.y,
             0.5f * p.z};  // normals are slightly inconsistent, and the surface bends accordingly
    const Variational v(s.points, s.normals);
    EXPECT_LT(share_of_wrong_gradients(v, points_in(v.bounds(), 500, 0.0f), 1e-3f, 0.02f), 0.03);
    EXPECT_LT(share_of_wrong_gradients(v, points_in(v.bounds(), 500, 0.5f), 1e-3f, 0.02f), 0.03);
    expect_bounds_hold_the_inside(v);
    expect_survives_strange_points(v);
    expect_batch_does_not_matter(v);
}

TEST(Variational, ComputesSumsOfCubes) {
    // One centre at the origin of weight 2, p = (3, 4, 0): r = 5; value 250, gradient 6 r p, and in xy 6 x y
    // / r.
    const std::vector<double> zero{0}, two{2};
    const CubeSums s = sum_cubes({zero, zero, zero, two}, {3, 4, 0});
    EXPECT_DOUBLE_EQ(s.value, 250);
    EXPECT_DOUBLE_EQ(s.gradient.x, 90);
    EXPECT_DOUBLE_EQ(s.gradient.y, 120);
    EXPECT_DOUBLE_EQ(s.xx, 6 * (5 + 9.0 / 5));
    EXPECT_DOUBLE_EQ(s.xy, 6 * 12.0 / 5);
    EXPECT_DOUBLE_EQ(s.zz, 30);
    // At a centre everything is 0; a tail shorter than a vector is fully included.
    EXPECT_EQ(sum_cubes({zero, zero, zero, two}, {}).xx, 0);
    const std::vector<double> x(11, 0.0), w(11, 1.0);
    EXPECT_DOUBLE_EQ(sum_cubes({x, x, x, w}, {0, 0, 2}).value, 88);
}

TEST(Variational, EndsAtTheMarginWithoutPoints) {
    const Sample whole = ball(200, 1, {});
    Sample half;
    for (std::size_t i = 0; i < whole.points.size(); ++i) {
        if (whole.points[i].z > 0) continue;
        half.points.push_back(whole.points[i]);
        half.normals.push_back(whole.normals[i]);
    }
    const Variational bowl(half.points, half.normals);
    expect_bounds_hold_the_inside(bowl);
    for (const Vec3 p : points_in(bowl.bounds(), 1000, 1.0f))
        if (p.z > bowl.bounds().high.z) {
            EXPECT_GT(at(bowl, p).value, 0);
        }
}

TEST(Variational, IsBitIdenticalForAnyNumberOfThreads) {
    const Sample s = ball(150, 2, {1, 1, 1});
    const Variational one(s.points, s.normals, {}, {.threads = 1}),
        seven(s.points, s.normals, {}, {.threads = 7});
    for (const Vec3 p : points_in(one.bounds(), 100, 0.2f)) EXPECT_EQ(at(one, p).value, at(seven, p).value);
}

TEST(Variational, RejectsUnsolvablePoints) {
    const Sample s = ball(20, 1, {});
    const auto with = [&](auto change) {
        Sample other = s;
        change(other);
        return error_of([&] { Variational(other.points, other.normals); });
    };
    EXPECT_NE(with([](Sample& x) { x.points.resize(3); }).find("needs 4 to 5000 points, but has 3"),
              std::string::npos);
    EXPECT_NE(with([](Sample& x) { x.points.resize(5001); }).find("but has 5001; give fewer"),
              std::string::npos);
    EXPECT_NE(with([](Sample& x) { x.normals.pop_back(); }).find("there are 19"), std::string::npos);
    EXPECT_NE(with([](Sample& x) { x.points[4].y = kNan; }).find("point 5"), std::string::npos);
    EXPECT_NE(with([](Sample& x) { x.normals[6] = {}; }).find("normal 7"), std::string::npos);
    EXPECT_NE(with([](Sample& x) { x.points[6] = x.points[2]; }).find("points 3 and 7 coincide"),
              std::string::npos);
    EXPECT_NE(with([](Sample& x) {
                  for (std::size_t i = 0; i < x.points.size(); ++i)
                      x.points[i].z = 0, x.normals[i] = {1, 0, 0};
              }).find("one plane"),
              std::string::npos);
    EXPECT_NE(with([](Sample& x) {
                  for (Vec3& p : x.points) p = {1, 1, 1};
              }).find("coincide"),
              std::string::npos);
    EXPECT_NE(error_of([&] { Variational(s.points, s.normals, {.offset = 0}); }).find("offset"),
              std::string::npos);
}

}  // namespace
}  // namespace coppice
