#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "coppice/io_mesh/reader.h"

namespace coppice {
namespace {

TEST(MeshAttributes, OfPlyAreRead) {
    const std::string text =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "property float order\nproperty double radius\nproperty list uchar int list\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 2 0.5 0\n1 0 0 1 nan 0\n0 1 0 0 1e31 0\n0 1 0 3 0.25 0\n3 0 1 3\n";
    const std::vector<std::string> names{"age", "order", "radius", "list"};
    const MeshFile file = parse_mesh_file(text, MeshFormat::ply, "f", names);
    ASSERT_EQ(file.attributes.size(), 2u);
    EXPECT_EQ(file.attributes[0].name, "order");
    EXPECT_EQ(file.attributes[0].values, (Buffer<float>{2, 1, 0, 3}));
    EXPECT_EQ(file.attributes[1].name, "radius");
    EXPECT_EQ(file.attributes[1].values[0], 0.5f);
    EXPECT_TRUE(std::isnan(file.attributes[1].values[1]));
    EXPECT_TRUE(std::isnan(file.attributes[1].values[2]));
    EXPECT_EQ(file.attributes[1].values[3], 0.25f);
    EXPECT_TRUE(parse_mesh_file(text, MeshFormat::ply, "f", {}).attributes.empty());
}

}  // namespace
}  // namespace coppice
