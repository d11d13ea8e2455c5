#include "coppice/io_mesh/format.h"

#include <gtest/gtest.h>

#include <string>

namespace coppice {
namespace {

TEST(MeshFormat, FollowsTheLastExtension) {
    EXPECT_EQ(mesh_format_of_name("a/tree.obj"), MeshFormat::obj);
    EXPECT_EQ(mesh_format_of_name("tree.obj.PLY"), MeshFormat::ply);
    EXPECT_EQ(mesh_format_of_name("t.Off"), MeshFormat::off);
    EXPECT_EQ(mesh_format_of_name("t.stl"), MeshFormat::stl);
    EXPECT_EQ(mesh_format_of_name("t.glb"), MeshFormat::glb);
    EXPECT_EQ(mesh_format_of_name("t.usda"), MeshFormat::usda);
    for (const char* name : {"", "obj", ".obj", "a.obj/t", "t.swc", "t.gltf", "t."}) {
        EXPECT_EQ(mesh_format_of_name(name), std::nullopt) << name;
    }
}

TEST(MeshFormat, FollowsTheFirstBytes) {
    EXPECT_EQ(mesh_format_of_content("ply\nformat ascii 1.0\n"), MeshFormat::ply);
    EXPECT_EQ(mesh_format_of_content("ply\r\n"), MeshFormat::ply);
    EXPECT_EQ(mesh_format_of_content("glTF\2"), MeshFormat::glb);
    EXPECT_EQ(mesh_format_of_content("solid tree\n"), MeshFormat::stl);
    EXPECT_EQ(mesh_format_of_content("\n OFF\n"), MeshFormat::off);
    EXPECT_EQ(mesh_format_of_content("STCNOFF 1 2 3"), MeshFormat::off);
    EXPECT_EQ(mesh_format_of_content("#usda 1.0"), MeshFormat::usda);
    for (const char* text : {"", "   ", "v 0 0 0\n", "# OFF\n", "OFFSET\n", "plyer\n"}) {
        EXPECT_EQ(mesh_format_of_content(text), std::nullopt) << text;
    }
}

TEST(MeshFormat, RecognizesBinaryStlByItsLength) {
    std::string file(84 + 50, '\0');
    file[80] = 1;
    EXPECT_EQ(mesh_format_of_content(file), MeshFormat::stl);
    EXPECT_EQ(mesh_format_of_content(file + "x"), std::nullopt);
}

}  // namespace
}  // namespace coppice
