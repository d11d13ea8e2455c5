#include "coppice/points/sampling/near_mesh.h"

#include <gtest/gtest.h>

#include <limits>

#include "points/support.h"

namespace coppice {
namespace {

using namespace points_support;

/// Returns a sheet of 4 x 1 at z = 0 with many small triangles in its right quarter.
TriMesh sheet() {
    TriMesh mesh;
    mesh.positions = {{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 1, 1}};  // the last has no area
    for (std::uint32_t i = 0; i < 10; ++i) {
        const float y0 = 0.1f * static_cast<float>(i), y1 = 0.1f * static_cast<float>(i + 1);
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const Vec3 p : {Vec3{3, y0, 0}, Vec3{4, y0, 0}, Vec3{4, y1, 0}, Vec3{3, y1, 0}}) {
            mesh.positions.push_back(p);
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    }
    return mesh;
}

double share_right(const PointSet& set) {
    double right = 0;
    for (const Vec3 p : set.positions) right += p.x > 3;
    return right / static_cast<double>(set.size());
}

TEST(NearMesh, OffsetsAreWithinTheirLimits) {
    for (const bool even : {false, true}) {
        const PointSet set = near_mesh(sheet(), {.count = 4000, .low = 0.1f, .high = 0.3f, .even = even});
        ASSERT_EQ(set.size(), 4000u);
        double mean = 0;
        for (const Vec3 p : set.positions) {
            EXPECT_TRUE(p.z >= 0.1f && p.z <= 0.3f && p.x >= 0 && p.x <= 4 && p.y >= 0 && p.y <= 1);
            mean += p.z / 4000;
        }
        EXPECT_NEAR(mean, 0.2, 0.005);
    }
    const PointSet below = near_mesh(sheet(), {.count = 100, .low = -0.2f, .high = -0.2f});
    EXPECT_EQ(below.size(), 100u);
    for (const Vec3 p : below.positions) EXPECT_FLOAT_EQ(p.z, -0.2f);
}

TEST(NearMesh, FacesAreSelectedByAreaOrUniformly) {
    // A quarter of the area is right of x = 3, and 20 of 22 triangles with an area. Three standard
    // deviations.
    EXPECT_NEAR(share_right(near_mesh(sheet(), {.count = 20000})), 0.25, 0.0092);
    const PointSet naive = near_mesh(sheet(), {.count = 20000, .choice = FaceChoice::by_face});
    EXPECT_NEAR(share_right(naive), 20.0 / 22, 0.0061);
}

TEST(NearMesh, NormalsAreInterpolated) {
    // An octahedron: at its corners the normal is that of the corner, at the middle of a face that of the
    // face.
    TriMesh mesh;
    mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    mesh.origin = {1000, 0, 0};
    const PointSet set = near_mesh(mesh, {.count = 5000, .low = 1, .high = 1});
    EXPECT_EQ(set.origin, mesh.origin);
    double farthest = 0, nearest = 9;
    for (const Vec3 p : set.positions) {
        farthest = std::max(farthest, length(Vec3d(p)));
        nearest = std::min(nearest, length(Vec3d(p)));
    }
    // At a corner, at a distance of 2 along its radial normal; at the middle of a face 1 / sqrt(3) + 1.
    EXPECT_NEAR(farthest, 2, 0.02);
    EXPECT_NEAR(nearest, 1 + 1 / std::sqrt(3.0), 0.01);
}

TEST(NearMesh, EvenPointsRespectADistance) {
    const PointSet even = near_mesh(sheet(), {.count = 1000, .low = 0, .high = 0, .even = true});
    const PointSet plain = near_mesh(sheet(), {.count = 1000, .low = 0, .high = 0});
    // The triangular lattice of 1000 points on 4 square metres has a distance of 0.068.
    EXPECT_GT(min_distance(even), 0.6 * 0.068);
    EXPECT_LT(min_distance(plain), 0.01);
}

TEST(NearMesh, IsBitIdenticalForAnyNumberOfThreads) {
    const NearMeshOptions options{.count = 10000, .even = true, .seed = 2};
    const PointSet one = near_mesh(sheet(), options, {.threads = 1});
    EXPECT_EQ(near_mesh(sheet(), options, {.threads = 7}), one);
    EXPECT_NE(near_mesh(sheet(), {.count = 10000, .even = true, .seed = 3}), one);
}

TEST(NearMesh, RejectsInvalidInput) {
    const auto catch_message = [](const TriMesh& mesh, const NearMeshOptions& o) {
        return error_of([&] { near_mesh(mesh, o); });
    };
    EXPECT_NE(catch_message({}, {}).find("no triangle with an area"), std::string::npos);
    EXPECT_NE(catch_message(sheet(), {.count = 0}).find("count"), std::string::npos);
    EXPECT_NE(catch_message(sheet(), {.low = 1, .high = 0}).find("below low"), std::string::npos);
    EXPECT_NE(catch_message(sheet(), {.low = std::nanf("")}).find("low"), std::string::npos);
    EXPECT_NE(catch_message(sheet(), {.choice = FaceChoice::by_face, .even = true}).find("by_area"),
              std::string::npos);
    EXPECT_NE(catch_message(sheet(), {.count = 100000000, .max_memory = 100}).find("max_memory"),
              std::string::npos);
    TriMesh bad = sheet();
    bad.positions[1].x = std::numeric_limits<float>::infinity();
    EXPECT_NE(catch_message(bad, {}).find("not finite"), std::string::npos);
    TriMesh tiny = sheet();  // floats cannot distinguish its points
    for (Vec3& p : tiny.positions) p = 1e-4f * p + Vec3{1e3f, 1e3f, 1e3f};
    EXPECT_NE(catch_message(tiny, {.count = 20000, .high = 1e-6f, .even = true}), "no error");
}

}  // namespace
}  // namespace coppice
