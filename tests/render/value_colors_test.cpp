#include "coppice/render/value_colors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "coppice/render/colors.h"
#include "coppice/render/render.h"
#include "mesh/shapes.h"

namespace coppice {
namespace {

Rgb stop(float t) { return to_srgb(deviation_color(t)); }

TEST(ValueColors, LinearScaleIsFromBlueToRed) {
    const std::vector<float> values{3, 1, 2};
    const ValueColors out = value_colors(values, ValueScale::linear);
    EXPECT_EQ(out.min, 1);
    EXPECT_EQ(out.max, 3);
    EXPECT_EQ(out.colors, (std::vector<Rgb>{stop(1), stop(-1), stop(0)}));
}

TEST(ValueColors, LogarithmicScaleHasTheGeometricMeanInTheMiddle) {
    const std::vector<float> values{0.1f, 0.2f, 0.4f, 0, -1};
    const ValueColors out = value_colors(values, ValueScale::logarithmic);
    EXPECT_EQ(out.min, 0.1f);  // 0 and -1 are unknown
    EXPECT_EQ(out.max, 0.4f);
    EXPECT_EQ(out.colors[0], stop(-1));
    EXPECT_EQ(out.colors[1], stop(0));
    EXPECT_EQ(out.colors[2], stop(1));
    EXPECT_EQ(out.colors[3], stop(NAN));
    EXPECT_EQ(out.colors[4], stop(NAN));
}

TEST(ValueColors, NumbersHaveColoursOfTheirOwn) {
    const std::vector<float> values{0, 7, 7, 1e30f, -5};
    const ValueColors out = value_colors(values, ValueScale::numbers);
    EXPECT_EQ(out.colors[0], numbered_color(0));
    EXPECT_EQ(out.colors[1], numbered_color(7));
    EXPECT_EQ(out.colors[2], numbered_color(7));
    EXPECT_EQ(out.colors[4], numbered_color(0));
}

TEST(ValueColors, UnknownNumbersAreLeftOut) {
    const std::vector<float> values{NAN, INFINITY, 5};
    const ValueColors out = value_colors(values, ValueScale::linear);
    EXPECT_EQ(out.min, 5);
    EXPECT_EQ(out.max, 5);
    EXPECT_EQ(out.colors, (std::vector<Rgb>{stop(NAN), stop(NAN), stop(0)}));
    EXPECT_TRUE(value_colors({}, ValueScale::linear).colors.empty());
}

// Numbers of the vertices by height: 1 at the bottom, 5 at the top.
TEST(ValueColors, AreDrawnOnMeshes) {
    const PolygonMesh mesh = shapes::box({-1, -1, 0}, {1, 1, 2});
    std::vector<float> values;
    for (const Vec3 p : mesh.positions) values.push_back(1 + 2 * p.z);
    RenderOptions o;
    o.camera.width = o.camera.height = 200;
    o.camera.azimuth = o.camera.elevation = 0;
    o.samples = 1;
    o.ground = false;
    for (const RenderColor color : {RenderColor::order, RenderColor::along, RenderColor::radius}) {
        o.color = color;
        const Image image = render({.mesh = &mesh, .vertex_values = values}, o);
        const Image::Pixel top = image.at(100, 50), bottom = image.at(100, 150);
        EXPECT_GT(top[0], top[2] + 20) << name_of(color);
        EXPECT_GT(bottom[2], bottom[0] + 20) << name_of(color);
    }
    o.color = RenderColor::order;
    values.pop_back();
    EXPECT_THROW(render({.mesh = &mesh, .vertex_values = values}, o), InvalidInput);
    EXPECT_THROW(render({.mesh = &mesh}, o), InvalidInput);
}

}  // namespace
}  // namespace coppice
