#include "coppice/scene/object.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

Surface one_quad() {
    QuadMesh mesh;
    for (const Vec3 p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0}})
        mesh.positions.push_back(p);
    mesh.quads.push_back({0, 1, 2, 3});
    mesh.origin = {10, 0, 0};
    return {std::move(mesh)};
}

TEST(SceneObject, SurfacesConvertIntoEachOther) {
    const Surface quad = one_quad();
    EXPECT_EQ(face_count(quad), 1u);
    EXPECT_EQ(make_polygons(quad).face(0).size(), 4u);
    const Surface triangles{to_triangles(quad)};
    EXPECT_EQ(face_count(triangles), 2u);
    EXPECT_EQ(make_polygons(triangles).face(1).size(), 3u);
    EXPECT_EQ(make_polygons(triangles).origin, (Vec3d{10, 0, 0}));
    EXPECT_EQ(face_count(Surface{make_polygons(triangles)}), 2u);
    EXPECT_EQ(to_triangles(Surface{make_polygons(quad)}).triangles.size(), 2u);
}

TEST(SceneObject, KindFollowsTheValue) {
    EXPECT_EQ(SceneObject{sphere({})}.kind(), ObjectKind::solid);
    EXPECT_EQ(SceneObject{PointSet{}}.kind(), ObjectKind::points);
    EXPECT_EQ(SceneObject{one_quad()}.kind(), ObjectKind::mesh);
    EXPECT_EQ(with_article(ObjectKind::points), "points");
    EXPECT_EQ(with_article(ObjectKind::path), "a path");
}

TEST(SceneObject, DescriptionsAreInWorldSpace) {
    const std::string mesh = describe_object({one_quad()});
    EXPECT_NE(mesh.find("mesh       1 faces\nvertices   4\n"), std::string::npos) << mesh;
    EXPECT_NE(mesh.find("10,0,0 to 11,1,0"), std::string::npos) << mesh;
    const std::string tree = describe_object(
        {Skeleton({NodeId{}, NodeId(0)}, {{0, 0, 0}, {0, 0, 2}}, {0.5f, 0.25f}, Vec3d{1, 1, 1})});
    EXPECT_NE(tree.find("length_m   2\n"), std::string::npos) << tree;
    EXPECT_NE(tree.find("0.5,0.5,0.5 to 1.5,1.5,3.25"), std::string::npos) << tree;
}

}  // namespace
}  // namespace coppice
