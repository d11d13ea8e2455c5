#include "coppice/pipeline/remesh/zip_internal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace coppice {
namespace {

const LoopAxis kUp{{0, 0, 0}, {0, 0, 1}};

// Appends a ring of n points at a height, starting at an angle, and returns its loop.
Loop ring(std::vector<Vec3>& x, std::uint32_t n, float height, float from, float sense = 1) {
    Loop out;
    for (std::uint32_t k = 0; k < n; ++k) {
        const float a =
            from + sense * 2 * std::numbers::pi_v<float> * static_cast<float>(k) / static_cast<float>(n);
        out.push_back(static_cast<std::uint32_t>(x.size()));
        x.push_back({std::cos(a), std::sin(a), height + 0.1f * std::sin(3 * a)});
    }
    return out;
}

TEST(Zip, CountsWindingsAroundAnAxis) {
    std::vector<Vec3> x;
    const Loop left = ring(x, 7, 0, 0.3f), right = ring(x, 7, 0, 0.3f, -1);
    EXPECT_EQ(winding(left, x, kUp), 1);
    EXPECT_EQ(winding(right, x, kUp), -1);
    EXPECT_EQ(winding(left, x, {{3, 0, 0}, {0, 0, 1}}), 0);
}

TEST(Zip, ConnectsRingsOfAnySizesByAClosedBand) {
    for (const std::uint32_t inner : {3u, 8u, 23u}) {
        for (const float from : {0.0f, 2.0f, -3.1f}) {
            std::vector<Vec3> x;
            const Loop a = ring(x, 8, 1, 0), b = ring(x, inner, 0, from);
            // Seen from outside, the faces below the upper ring traverse it backwards.
            Loop upper(a.rbegin(), a.rend());
            Loop lower(b.rbegin(), b.rend());
            const auto band = zip(upper, lower, x, kUp);
            ASSERT_TRUE(band);
            EXPECT_EQ(band->size(), 8 + inner);
            const Boundary ends = compute_boundary(*band);
            ASSERT_EQ(ends.loops.size(), 2u);
            EXPECT_EQ(ends.loops[0].size() + ends.loops[1].size(), 8 + inner);
            for (const Triangle& t : *band) {
                const Vec3 n = cross(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]]);
                const Vec3 out = x[t[0]] + x[t[1]] + x[t[2]];
                EXPECT_GT(dot(n, Vec3(out.x, out.y, 0)), 0) << inner << " " << from;
            }
        }
    }
}

TEST(Zip, RejectsLoopsOfOppositeWinding) {
    std::vector<Vec3> x;
    const Loop a = ring(x, 8, 1, 0), b = ring(x, 8, 0, 0, -1);
    EXPECT_FALSE(zip(a, b, x, kUp));
}

}  // namespace
}  // namespace coppice
