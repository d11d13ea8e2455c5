#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "coppice/base/random.h"
#include "coppice/implicit/shape/shape.h"
#include "errors.h"

namespace coppice {

using test::error_of;

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInfinite = std::numeric_limits<float>::infinity();

inline FieldSample at(const Shape& shape, Vec3 p) {
    FieldSample sample[1];
    shape.distance(std::span(&p, 1), sample);
    return sample[0];
}

inline std::vector<FieldSample> all_at(const Shape& shape, std::span<const Vec3> points) {
    std::vector<FieldSample> samples(points.size());
    shape.distance(points, samples);
    return samples;
}

/// Returns random points in the box, enlarged on all sides by `margin` of its diagonal.
inline std::vector<Vec3> points_in(const Box3& box, std::size_t count, float margin, std::uint64_t seed = 1) {
    const CounterRandom random(seed, 0);
    const Box3 wide = box.inflated(margin * box.diagonal());
    std::vector<Vec3> points(count);
    for (std::size_t i = 0; i < count; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            const auto u = static_cast<float>(random.uniform(3 * i + static_cast<std::size_t>(axis)));
            points[i][axis] = wide.low[axis] + u * wide.size()[axis];
        }
    return points;
}

/// Returns the share of points with a gradient that differs from differences over `step` by more than
/// `tolerance`, as at creases.
inline double share_of_wrong_gradients(const Shape& shape, std::span<const Vec3> points, float step,
                                       float tolerance) {
    std::size_t wrong = 0;
    for (const Vec3 p : points) {
        const Vec3 g = at(shape, p).gradient;
        Vec3 d;
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 h;
            h[axis] = step;
            d[axis] = (at(shape, p + h).value - at(shape, p - h).value) / (2 * step);
        }
        if (!(length(g - d) <= tolerance * std::max(1.0f, length(g)))) ++wrong;
    }
    return static_cast<double>(wrong) / static_cast<double>(points.size());
}

/// Checks, with 20,000 points around the box, that points inside the shape are in the box.
inline void expect_bounds_hold_the_inside(const Shape& shape) {
    const Box3 box = shape.bounds();
    std::size_t inside = 0;
    for (const Vec3 p : points_in(box, 20000, 0.3f)) {
        if (at(shape, p).value >= 0) continue;
        ++inside;
        Box3 point;
        point.extend(p);
        EXPECT_TRUE(box.overlaps(point)) << p.x << ' ' << p.y << ' ' << p.z;
    }
    EXPECT_GT(inside, 20u);
}

/// Checks that samples of NaN or huge points return, and that the results of other points do not depend on
/// them.
inline void expect_survives_strange_points(const Shape& shape) {
    const Vec3 fair = shape.bounds().center();
    const std::vector<Vec3> points{fair, {kNan, 0, 0},       fair, {kInfinite, 0, 0},
                                   fair, {1e30f, -1e30f, 0}, fair};
    const std::vector<FieldSample> samples = all_at(shape, points);
    for (const std::size_t i : {2u, 4u, 6u}) {
        EXPECT_EQ(samples[i].value, samples[0].value);
        EXPECT_EQ(samples[i].gradient, samples[0].gradient);
    }
    EXPECT_FALSE(samples[1].value < 0);
    EXPECT_FALSE(samples[3].value < 0);
    EXPECT_GT(samples[5].value, 1e29f);
}

/// Checks that a sample depends only on its point, not on the batch (bit-identical).
inline void expect_batch_does_not_matter(const Shape& shape) {
    std::vector<Vec3> points = points_in(shape.bounds(), 500, 0.2f, 9);
    const std::vector<FieldSample> forward = all_at(shape, points);
    std::reverse(points.begin(), points.end());
    std::vector<FieldSample> backward = all_at(shape, points);
    std::reverse(backward.begin(), backward.end());
    for (std::size_t i = 0; i < forward.size(); ++i) {
        EXPECT_EQ(forward[i].value, backward[i].value) << i;
        EXPECT_EQ(forward[i].gradient, backward[i].gradient) << i;
    }
}

}  // namespace coppice
