#include "coppice/pipeline/remesh/smooth_patch_internal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace coppice {
namespace {

// A field that is 1 on the unit ball and decreases like the fifth power of a quartic kernel.
struct Ball {
    float level() const { return 1; }
    void sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const float left = std::max(0.0f, (2 - length_squared(points[i])));
            out[i] = {std::pow(left, 2.5f), -5 * std::pow(left, 1.5f) * points[i]};
        }
    }
};

// A grid of n x n quads on part of the ball with displaced inner vertices.
struct Patch {
    std::vector<Vec3> x;
    std::vector<Quad> quads;
    std::vector<PatchVertex> moving;
};

Patch shaken_patch(std::uint32_t n) {
    Patch out;
    for (std::uint32_t j = 0; j <= n; ++j) {
        for (std::uint32_t i = 0; i <= n; ++i) {
            const float u = static_cast<float>(i) / static_cast<float>(n) - 0.5f;
            const float v = static_cast<float>(j) / static_cast<float>(n) - 0.5f;
            const auto k = static_cast<std::uint32_t>(out.x.size());
            Vec3 p = normalized(Vec3(u, v, 1));
            if (i > 0 && j > 0 && i < n && j < n) {
                p += Vec3(0.02f * std::sin(7.0f * static_cast<float>(k)),
                          0.02f * std::cos(3.0f * static_cast<float>(k)), 0.03f);
                out.moving.push_back({k, 0, 1});
            }
            out.x.push_back(p);
            if (i < n && j < n) out.quads.push_back({k, k + 1, k + n + 2, k + n + 1});
        }
    }
    return out;
}

TEST(SmoothPatch, MovesVerticesToTheSurfaceAndPreservesTheRim) {
    Patch patch = shaken_patch(8);
    const std::vector<Vec3> before = patch.x;
    const Ball ball;
    smooth_patch(patch.x, patch.quads, patch.moving, FieldRef(ball), 10);
    std::vector<bool> moves(patch.x.size());
    for (const PatchVertex& m : patch.moving) moves[m.vertex] = true;
    for (std::size_t v = 0; v < patch.x.size(); ++v) {
        EXPECT_NEAR(length(patch.x[v]), 1, 1e-4f);
        if (!moves[v]) {
            EXPECT_EQ(patch.x[v], before[v]);
        }
    }
}

// Six patches of the same number of quads as this one enclose the ball.
TEST(SmoothPatch, QuadsEncloseTheVolumeOfTheSurface) {
    const auto volume_below = [](const Patch& patch) {
        double sum = 0;
        for (const Quad& q : patch.quads) {
            const Vec3d a(patch.x[q[0]]), b(patch.x[q[1]]), c(patch.x[q[2]]), d(patch.x[q[3]]);
            sum += dot(a, cross(b, c)) + dot(a, cross(c, d));
        }
        return sum / 6;
    };
    Patch patch = shaken_patch(8);
    for (Vec3& p : patch.x) p = normalized(p);
    Patch fine = shaken_patch(64);
    for (Vec3& p : fine.x) p = normalized(p);
    const double before = volume_below(patch), exact = volume_below(fine);
    enclose_volume(patch.x, patch.quads, patch.moving);
    EXPECT_LT(before, 0.995 * exact);
    EXPECT_NEAR(volume_below(patch), exact, 0.25 * (exact - before));
}

TEST(SmoothPatch, IsBitIdenticalForAnyNumberOfThreads) {
    const Ball ball;
    Patch one = shaken_patch(40), many = one;
    smooth_patch(one.x, one.quads, one.moving, FieldRef(ball), 5, {.threads = 1});
    smooth_patch(many.x, many.quads, many.moving, FieldRef(ball), 5, {.threads = 7});
    EXPECT_EQ(std::memcmp(one.x.data(), many.x.data(), one.x.size() * sizeof(Vec3)), 0);
}

}  // namespace
}  // namespace coppice
