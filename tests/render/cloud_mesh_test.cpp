#include "coppice/render/cloud_mesh.h"

#include <gtest/gtest.h>

#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"

namespace coppice {
namespace {

TEST(CloudMesh, DrawsAnOctahedronForEveryPoint) {
    PointSet points;
    points.positions = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}};
    points.origin = {5, 6, 7};
    const PolygonMesh mesh = mesh_of_cloud(points, 0.5);
    EXPECT_EQ(mesh.origin, points.origin);
    const TopologyReport t = topology(mesh);
    EXPECT_TRUE(t.sound());
    EXPECT_EQ(t.components, 3u);
    EXPECT_EQ(t.faces, 24u);
    EXPECT_NEAR(shape(mesh).signed_volume, 3 * 4.0 / 3 * 0.125, 1e-6);  // 4/3 r^3 each
}

TEST(CloudMesh, TakesHalfAMillionOfMorePoints) {
    PointSet points;
    points.positions.resize(1'200'000);
    EXPECT_EQ(mesh_of_cloud(points, 1).face_count(), 8u * 500'000);
}

}  // namespace
}  // namespace coppice
