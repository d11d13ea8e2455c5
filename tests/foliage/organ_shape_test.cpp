#include "coppice/foliage/organ_shape.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "coppice/base/error.h"
#include "foliage/mesh_volume.h"

namespace coppice {
namespace {

/// Returns the number of edges with a face on one side only.
std::size_t count_open_edges(const TriMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    }
    std::size_t open = 0;
    for (const auto& [edge, count] : edges) open += edges.contains({edge.second, edge.first}) ? 0 : 1;
    return open;
}

TEST(OrganShape, berries_are_closed_ellipsoids) {
    const OrganShape shape{.length = 0.05f, .width = 0.04f, .stalk_length = 0};
    const auto parts = make_organ(shape, kFruitMaterial);
    ASSERT_EQ(parts.size(), 1u);
    const TriMesh& mesh = parts[0].prototype.mesh;
    EXPECT_EQ(parts[0].prototype.material, kFruitMaterial);
    EXPECT_EQ(parts[0].prototype.texture.size(), 3 * mesh.triangles.size());
    EXPECT_EQ(count_open_edges(mesh), 0u);
    // An ellipsoid of these axes has 4/3 pi 0.025 0.02^2 = 4.2e-5 m3; sizes vary by 12 %, and 16 sides have
    // 97 %.
    EXPECT_GT(compute_volume(mesh), 0.65 * 4.2e-5);
    EXPECT_LT(compute_volume(mesh), 1.3 * 4.2e-5);
}

TEST(OrganShape, clusters_have_all_members_and_their_stalks) {
    for (const OrganCluster cluster : {OrganCluster::umbel, OrganCluster::corymb, OrganCluster::raceme}) {
        OrganShape shape{.cluster = cluster, .count = 1, .axis_length = 0.05f};
        const auto one = make_organ(shape, kFruitMaterial);
        shape.count = 7;
        const auto seven = make_organ(shape, kFruitMaterial);
        ASSERT_EQ(seven.size(), 2u);
        EXPECT_EQ(seven[0].prototype.mesh.triangles.size(), 7 * one[0].prototype.mesh.triangles.size());
        EXPECT_EQ(seven[1].prototype.material, kLeafMaterial);
        EXPECT_EQ(count_open_edges(seven[1].prototype.mesh), 0u);
    }
}

TEST(OrganShape, every_form_points_along_its_axis) {
    for (const OrganForm form : {OrganForm::flower, OrganForm::berry, OrganForm::nut, OrganForm::burr,
                                 OrganForm::samara, OrganForm::cone}) {
        const auto parts =
            make_organ({.form = form, .length = 0.02f, .stalk_length = 0.03f}, kFlowerMaterial);
        ASSERT_GE(parts.size(), 2u);
        double height = 0;
        for (const Vec3 p : parts[0].prototype.mesh.positions) height += double{p.y};
        height /= static_cast<double>(parts[0].prototype.mesh.positions.size());
        EXPECT_GT(height, 0.024) << static_cast<int>(form);
        EXPECT_LT(height, 0.06) << static_cast<int>(form);
    }
}

TEST(OrganShape, petals_face_the_axis) {
    const auto parts = make_organ({.form = OrganForm::flower, .length = 0.02f, .opening = 1.4f, .stamens = 0},
                                  kFlowerMaterial);
    const TriMesh& mesh = parts[0].prototype.mesh;
    double up = 0;
    for (const Triangle& t : mesh.triangles)
        up += double{
            cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]])
                .y};
    EXPECT_GT(up, 0);
}

TEST(OrganShape, refuses_numbers_out_of_range) {
    EXPECT_THROW(make_organ({.count = 0}, kFruitMaterial), InvalidInput);
    EXPECT_THROW(make_organ({.length = -1}, kFruitMaterial), InvalidInput);
    EXPECT_THROW(make_organ({.spread = 2}, kFruitMaterial), InvalidInput);
    EXPECT_THROW(make_organ({.scales = 2000}, kFruitMaterial), InvalidInput);
}

}  // namespace
}  // namespace coppice
