#include "coppice/render/frame_view.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "coppice/base/error.h"
#include "coppice/render/render.h"

namespace coppice {
namespace {

PolygonMesh pyramid() {
    PolygonMesh m;
    m.positions = {{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0}, {1, 1, 4}};
    for (const Triangle& t : {Triangle{0, 3, 2}, Triangle{0, 2, 1}, Triangle{0, 1, 4}, Triangle{1, 2, 4},
                              Triangle{2, 3, 4}, Triangle{3, 0, 4}})
        m.add_face(t);
    m.origin = {500'000, -40, 7};
    return m;
}

RenderOptions small() {
    RenderOptions o;
    o.camera.width = 96;
    o.camera.height = 64;
    o.samples = 4;
    o.camera.azimuth = 0.8f;
    o.camera.elevation = 0.4f;
    o.ground = false;
    o.transparent = true;
    return o;
}

TEST(FrameView, MatchesTheCameraOfRender) {
    const PolygonMesh mesh = pyramid();
    std::vector<Vec3d> points;
    for (const Vec3 p : mesh.positions) points.push_back(Vec3d(p) + mesh.origin);
    const SketchView view = frame_view(points, small().camera);
    const Image by_options = render({.mesh = &mesh}, small());
    const Image by_view = render({.mesh = &mesh, .view = &view}, small());
    std::size_t differing = 0;
    for (std::size_t i = 0; i < by_view.pixels.size(); ++i) {
        const int change = by_view.pixels[i][3] - by_options.pixels[i][3];
        differing += change > 64 || change < -64 ? 1 : 0;
    }
    EXPECT_LT(differing, by_view.pixels.size() / 200);
}

TEST(FrameView, PointsFillTheImageUpToTheMargin) {
    const std::vector<Vec3d> points{{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}};
    RenderOptions o = small();
    o.camera.azimuth = o.camera.elevation = 0;
    o.camera.margin = 0.125f;
    double left = 1e9, right = 0, top = 1e9, bottom = 0;
    for (const Vec3d& p : points) {
        const PicturePoint at = project(frame_view(points, o.camera), p);
        left = std::min(left, at.x), right = std::max(right, at.x);
        top = std::min(top, at.y), bottom = std::max(bottom, at.y);
    }
    // The object fills the height of 64 pixels: 8 are free above and below, 48 for a square in the middle.
    EXPECT_NEAR(top, 8, 0.01);
    EXPECT_NEAR(bottom, 56, 0.01);
    EXPECT_NEAR(left, 24, 0.01);
    EXPECT_NEAR(right, 72, 0.01);
}

TEST(FrameView, RejectsPointsWithoutExtent) {
    EXPECT_THROW(frame_view({}, small().camera), InvalidInput);
    EXPECT_THROW(frame_view(std::vector<Vec3d>{{1, 2, 3}}, small().camera), InvalidInput);
}

}  // namespace
}  // namespace coppice
