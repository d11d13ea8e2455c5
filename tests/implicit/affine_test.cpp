#include "coppice/implicit/solid/affine.h"

#include <gtest/gtest.h>

#include <numbers>

#include "implicit/trees.h"

namespace coppice {
namespace {

void expect_near(Vec3d a, Vec3d b) { EXPECT_LT(distance(a, b), 1e-12) << a.x << ' ' << a.y << ' ' << a.z; }

TEST(Affine, RotationIsRightHanded) {
    const Affine quarter = Affine::rotation({0, 0, 1}, std::numbers::pi / 2);
    expect_near(quarter.point({1, 0, 5}), {0, 1, 5});
    EXPECT_NEAR(quarter.determinant(), 1, 1e-12);
}

TEST(Affine, ProductAppliesTheRightFactorFirst) {
    const Affine move = Affine::translation({1, 0, 0}), grow = Affine::scaling({2, 3, 4});
    expect_near((grow * move).point({1, 1, 1}), {4, 3, 4});
    expect_near((move * grow).point({1, 1, 1}), {3, 3, 4});
}

TEST(Affine, InverseRevertsTheMap) {
    TreeMaker maker(3);
    for (int i = 0; i < 50; ++i) {
        const Affine m{Vec3d(maker.point(2)), Vec3d(maker.point(2)), Vec3d(maker.point(2)),
                       Vec3d(maker.point(9))};
        if (std::abs(m.determinant()) < 0.1) continue;
        const Vec3d p(maker.point(5));
        EXPECT_LT(distance(m.inverse().point(m.point(p)), p), 1e-10);
    }
}

TEST(Affine, FrameIsRigidAtItsOrigin) {
    for (const Vec3d axis : {Vec3d{0, 0, 1}, Vec3d{0, 0, -1}, Vec3d{0.6, 0, 0.8}}) {
        const Affine f = Affine::frame({1, 2, 3}, axis);
        expect_near(f.point({0, 0, 2}), Vec3d{1, 2, 3} + axis * 2.0);
        EXPECT_NEAR(f.determinant(), 1, 1e-12);
        EXPECT_NEAR(dot(f.x, f.z), 0, 1e-12);
    }
}

}  // namespace
}  // namespace coppice
