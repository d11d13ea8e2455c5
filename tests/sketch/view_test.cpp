#include "coppice/sketch/view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "errors.h"

namespace coppice {
namespace {

using test::error_of;

/// A camera at (0, -5, 1) that looks along +y.
SketchView pinhole() {
    SketchView view;
    view.name = "front";
    view.k = {{{1000, 0, 500}, {0, 1000, 400}, {0, 0, 1}}};
    view.r = {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}};
    view.t = {0, 1, 5};
    return view;
}

TEST(View, PinholeProjectsDistantObjectsSmaller) {
    // (1, 0, 1) is at a depth of 5 m and 1 m to the right: 1000 / 5 pixels from the centre.
    EXPECT_EQ(project(pinhole(), {1, 0, 1}), (PicturePoint{700, 400}));
    // Up is towards smaller y; at a depth of 10 m.
    EXPECT_EQ(project(pinhole(), {0, 5, 2}), (PicturePoint{500, 300}));
    EXPECT_DOUBLE_EQ(pixels_per_metre(pinhole(), {0, 5, 2}), 100);
    EXPECT_DOUBLE_EQ(depth(pinhole(), {3, 5, 2}), 10);
}

TEST(View, RaysPassThroughTheProjectedPoints) {
    SketchView view = pinhole();
    view.distortion = {-0.2, 0.05, 0.001, -0.002, 0.01};
    for (const Vec3d p : {Vec3d{0.3, -0.5, 1.8}, Vec3d{-1, 2, 0.1}, Vec3d{0, 0, 1}}) {
        const ViewRay r = ray(view, project(view, p));
        EXPECT_NEAR(length(cross(p - r.origin, r.direction)), 0, 1e-9);
        EXPECT_GT(dot(p - r.origin, r.direction), 0);
        // The undistorted image shows it at the intersection of the undistorted ray.
        const PicturePoint straight = undistorted(view, project(view, p));
        EXPECT_NEAR(length(straight - project(without_distortion(view), p)), 0, 1e-6);
    }
}

TEST(View, DrawingsHaveTheirSide) {
    const Vec3d p{1, 2, 3};
    const auto shown = [&](DrawingSide side) { return project(drawing_view(side, 10, {100, 200}), p); };
    EXPECT_EQ(shown(DrawingSide::front), (PicturePoint{110, 170}));
    EXPECT_EQ(shown(DrawingSide::back), (PicturePoint{90, 170}));
    EXPECT_EQ(shown(DrawingSide::side), (PicturePoint{120, 170}));
    EXPECT_EQ(shown(DrawingSide::left), (PicturePoint{80, 170}));
    EXPECT_EQ(shown(DrawingSide::top), (PicturePoint{110, 180}));
    const ViewRay r = ray(drawing_view(DrawingSide::side, 10, {100, 200}), {120, 170});
    EXPECT_NEAR(length(cross(p - r.origin, r.direction)), 0, 1e-12);
    EXPECT_EQ(r.direction, (Vec3d{-1, 0, 0}));
}

TEST(View, ProjectionChangeMatchesFiniteDifferences) {
    for (const SketchView& view : {pinhole(), drawing_view(DrawingSide::top, 50, {0, 0})}) {
        const Vec3d p{0.4, 0.7, 1.6};
        const auto [x, y] = projection_change(view, p);
        for (int axis = 0; axis < 3; ++axis) {
            Vec3d step{};
            step[axis] = 1e-5;
            const PicturePoint change = (project(view, p + step) - project(view, p - step)) * (1 / 2e-5);
            EXPECT_NEAR(change.x, x[axis], 1e-4);
            EXPECT_NEAR(change.y, y[axis], 1e-4);
        }
    }
}

TEST(View, RejectsInvalidCameras) {
    SketchView view = pinhole();
    EXPECT_EQ(error_of([&] { validate(view, "views[0]"); }), "no error");
    view.r[2] = {0, -1, 0};  // a mirror
    EXPECT_EQ(error_of([&] { validate(view, "views[0]"); }), "views[0].R must be a rotation");
    view = pinhole();
    view.k[0][0] = 0;
    EXPECT_EQ(error_of([&] { validate(view, "views[0]"); }),
              "views[0].K must be [[fx, skew, cx], [0, fy, cy], [0, 0, 1]] with fx and fy above 0");
    view = pinhole();
    view.t.x = NAN;
    EXPECT_EQ(error_of([&] { validate(view, "views[0]"); }), "views[0].t must contain finite numbers");
    EXPECT_EQ(error_of([&] { drawing_view(DrawingSide::front, 0, {}); }),
              "the scale of a drawing must be above 0 pixels per metre");
}

}  // namespace
}  // namespace coppice
