// Roots with several branches, and tips: the surface has the volume that the skeleton specifies.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "coppice/measure/surface_report.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {
namespace {

constexpr NodeId kRoot = NodeId::none();

SurfaceReport check(const Skeleton& s, const MeshOptions& options = {}) {
    return check_surface(to_polygons(mesh_skeleton(s, options)), &s);
}
VolumeReport compute_volume(const Skeleton& s) { return *check(s).volume; }

/// Two branches of two segments each that leave a root at an angle.
Skeleton fork_at_root(float degrees, float ratio) {
    const float half = degrees / 2 * std::numbers::pi_v<float> / 180;
    const auto at = [&](float side, float way) {
        return Vec3{side * way * std::sin(half), 0, way * std::cos(half)};
    };
    const float thin = 0.1f * ratio;
    return Skeleton({kRoot, NodeId(0), NodeId(1), NodeId(0), NodeId(3)},
                    {{0, 0, 0}, at(1, 0.7f), at(1, 1.4f), at(-1, 0.7f), at(-1, 1.4f)},
                    {0.1f, 0.1f, 0.1f, thin, thin});
}

TEST(Roots, WithTwoBranchesHaveTheirVolume) {
    for (const float degrees : {20.0f, 40.0f, 60.0f, 80.0f, 100.0f, 120.0f, 150.0f, 180.0f}) {
        for (const float ratio : {1.0f, 0.8f, 0.6f, 0.4f, 0.25f}) {
            SCOPED_TRACE(std::to_string(degrees) + " degrees, ratio " + std::to_string(ratio));
            const VolumeReport report = compute_volume(fork_at_root(degrees, ratio));
            EXPECT_LT(report.missing_percent(), 0.01);
            EXPECT_GT(report.ratio(), 0.96);
            EXPECT_LT(report.ratio(), 1.05);  // the crotch is webbed
        }
    }
}

/// Branches that leave a ball of radius 3 in these directions.
Skeleton ball(const std::vector<Vec3>& directions) {
    std::vector<NodeId> parent{kRoot};
    std::vector<Vec3> position{{0, 0, 0}};
    std::vector<float> radius{3};
    for (const Vec3 d : directions) {
        parent.push_back(NodeId(0));
        position.push_back(normalized(d) * 5.0f);
        parent.push_back(NodeId(static_cast<std::uint32_t>(parent.size() - 1)));
        position.push_back(normalized(d) * 9.0f);
        radius.insert(radius.end(), {0.4f, 0.3f});
    }
    return Skeleton(parent, position, radius);
}

TEST(Roots, MuchThickerThanTheirBranchesAreBalls) {
    const std::vector<std::vector<Vec3>> cases{
        {{1, 0, 0}, {-1, 0, 0}},
        {{1, 0, 0}, {0, 1, 0}},
        {{1, 0, 0}, {-1, 0.2f, 0}, {0, 1, 0.1f}},
        {{1, 1, 1}, {-1, -1, 1}, {1, -1, -1}, {-1, 1, -1}},
        {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
    for (const auto& directions : cases) {
        SCOPED_TRACE(directions.size());
        const Skeleton s = ball(directions);
        const VolumeReport report = compute_volume(s);
        EXPECT_LT(report.missing_percent(), 0.1);
        EXPECT_GT(report.ratio(), 0.95);
        EXPECT_LT(report.ratio(), 1.05);  // a ball of many faces requires less compensation
        // The side of the ball that faces away from each branch's tip is present.
        const double ball_alone = 4.0 / 3 * std::numbers::pi * 27;
        EXPECT_GT(report.cones, ball_alone);
        EXPECT_LT(report.cones, 1.25 * ball_alone);
    }
}

TEST(Roots, WithSeveralBranchesAreClosedByEveryMethod) {
    MeshOptions options;
    for (const MeshMethod method : {MeshMethod::quads, MeshMethod::ramifications, MeshMethod::tetrahedra}) {
        options.method = method;
        SCOPED_TRACE(static_cast<int>(method));
        for (const Skeleton& s : {fork_at_root(50, 0.7f), ball({{1, 0, 0}, {-1, 0.2f, 0}, {0, 1, 0.1f}})}) {
            const SurfaceReport report = check(s, options);
            EXPECT_TRUE(report.sound());
            EXPECT_LT(report.volume->missing_percent(), 1);
        }
    }
}

TEST(Tips, OfLongTapersAreReached) {
    for (const float thin : {0.2f, 0.0635f, 0.01f}) {
        const Skeleton s({kRoot, NodeId(0)}, {{0, 0, 0}, {0, 0, 7.8f}}, {0.2f, thin});
        const PolygonMesh mesh = to_polygons(mesh_skeleton(s));
        float top = 0;
        for (const Vec3 p : mesh.positions) top = std::max(top, p.z);
        EXPECT_NEAR(top, 7.8f + thin, 0.02f * thin) << thin;
        EXPECT_LT(compute_volume(s).missing_percent(), 0.01);
    }
}

}  // namespace
}  // namespace coppice
