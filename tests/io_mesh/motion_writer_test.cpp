#include "coppice/io_mesh/motion_writer.h"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "coppice/base/error.h"
#include "coppice/system/file.h"
#include "small_image.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

using nlohmann::json;

QuadMesh cube() {
    QuadMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.positions.push_back(Vec3(Vec3d{double(i & 1), double(i >> 1 & 1), double(i >> 2)}));
    const Quad all[] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const Quad& q : all) mesh.quads.push_back(q);
    return mesh;
}

Buffer<Vec3> shifted(const QuadMesh& mesh, float by) {
    Buffer<Vec3> out = mesh.positions;
    for (Vec3& p : out) p.x += by * p.z;
    return out;
}

using MotionWriterTest = test::FolderTest;

struct Glb {
    json head;
    std::string bytes;

    explicit Glb(const std::string& file) {
        std::uint32_t length = 0;
        std::memcpy(&length, file.data() + 12, 4);
        head = json::parse(file.substr(20, length));
        bytes = file.substr(28 + length);
        std::uint32_t whole = 0, buffer = 0;
        std::memcpy(&whole, file.data() + 8, 4);
        std::memcpy(&buffer, file.data() + 20 + length, 4);
        EXPECT_EQ(whole, file.size());
        EXPECT_EQ(buffer, bytes.size());
    }
    float number(std::size_t accessor, std::size_t i) const {
        const json& view = head["bufferViews"][head["accessors"][accessor]["bufferView"].get<std::size_t>()];
        float x = 0;
        std::memcpy(&x, bytes.data() + view["byteOffset"].get<std::size_t>() + 4 * i, 4);
        return x;
    }
};

TEST_F(MotionWriterTest, WritesSuccessiveMorphTargets) {
    const QuadMesh mesh = cube();
    const auto path = folder_ / "m.glb";
    MotionWriter writer(path, mesh, 3, 10);
    for (const float by : {0.0f, 0.5f, 1.0f}) writer.add(shifted(mesh, by));
    writer.finish();
    const Glb glb(read_file(path));
    const json& primitive = glb.head["meshes"][0]["primitives"][0];
    ASSERT_EQ(primitive["targets"].size(), 3u);
    EXPECT_EQ(glb.head["buffers"][0]["byteLength"], glb.bytes.size());
    const auto last = primitive["targets"][2]["POSITION"].get<std::size_t>();
    EXPECT_EQ(glb.number(last, 3 * 7), 1);  // vertex 7 moved by one metre along x
    EXPECT_EQ(glb.number(last, 3 * 3), 0);
    EXPECT_EQ(glb.head["accessors"][last]["max"][0], 1.0);
    const json& sampler = glb.head["animations"][0]["samplers"][0];
    EXPECT_FLOAT_EQ(glb.number(sampler["input"], 2), 0.2f);
    for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(glb.number(sampler["output"], i), i % 4 == 0 ? 1 : 0);
}

TEST_F(MotionWriterTest, TurnsTangentsWithTheSurface) {
    const QuadMesh mesh = cube();
    std::vector<TexturePoint> texture;
    for (std::size_t f = 0; f < mesh.quads.size(); ++f)
        texture.insert(texture.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
    const MaterialFiles material{
        .color = "c.png", .normal = "n.png", .bytes = {{"c.png", small_image()}, {"n.png", small_image()}}};
    const auto path = folder_ / "m.glb";
    MotionWriter writer(path, mesh, 2, 10, {{texture, {}}, {material}, {}});
    Buffer<Vec3> turned = mesh.positions;  // by 90 degrees about z
    for (Vec3& p : turned) p = {-p.y, p.x, p.z};
    writer.add(mesh.positions);
    writer.add(turned);
    writer.finish();
    const Glb glb(read_file(path));
    const json& primitive = glb.head["meshes"][0]["primitives"][0];
    const json &at_rest = primitive["attributes"], &target = primitive["targets"][1];
    EXPECT_TRUE(at_rest.contains("TEXCOORD_0"));
    const std::size_t count = glb.head["accessors"][at_rest["TANGENT"].get<std::size_t>()]["count"];
    EXPECT_EQ(count, glb.head["accessors"][target["TANGENT"].get<std::size_t>()]["count"]);
    for (std::size_t v = 0; v < count; ++v) {
        // In the file y is up: (x, y, z) of the surface is (x, z, -y), and turns into (-y, z, -x).
        const auto tangent = [&](std::size_t k) { return glb.number(at_rest["TANGENT"], 4 * v + k); };
        const auto moved = [&](std::size_t k) {
            return tangent(k) + glb.number(target["TANGENT"], 3 * v + k);
        };
        EXPECT_NEAR(moved(0), tangent(2), 1e-6);
        EXPECT_NEAR(moved(1), tangent(1), 1e-6);
        EXPECT_NEAR(moved(2), -tangent(0), 1e-6);
    }
}

TEST_F(MotionWriterTest, WritesTimeSamples) {
    QuadMesh mesh = cube();
    mesh.origin = {10, 0, 0};
    const auto path = folder_ / "m.usda";
    MotionWriter writer(path, mesh, 2, 24);
    for (const float by : {0.0f, 0.5f}) writer.add(shifted(mesh, by));
    writer.finish();
    const std::string text = read_file(path);
    for (const char* part : {"endTimeCode = 1", "timeCodesPerSecond = 24", "xformOp:translate = (10, 0, 0)",
                             "point3f[] points.timeSamples = {\n            0: [(0, 0, 0), (1, 0, 0)",
                             "            1: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (0.5, 0, 1)",
                             "1: [(0, 0, 0), (1.5, 1, 1)],", "int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]"})
        EXPECT_NE(text.find(part), std::string::npos) << part;
}

TEST_F(MotionWriterTest, WritesFramesWithDifferentFaces) {
    std::vector<QuadMesh> frames{cube(), cube()};
    frames[0].quads.resize(2);
    write_changing_mesh(folder_ / "c.usda", frames, 12);
    const std::string text = read_file(folder_ / "c.usda");
    EXPECT_NE(
        text.find(
            "int[] faceVertexCounts.timeSamples = {\n            0: [4, 4],\n            1: [4, 4, 4, 4, "
            "4, 4],\n"),
        std::string::npos);
}

TEST_F(MotionWriterTest, CreatesNoFileIfUnfinished) {
    const QuadMesh mesh = cube();
    {
        MotionWriter writer(folder_ / "m.usda", mesh, 2, 24);
        writer.add(mesh.positions);
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / "m.usda"));
}

TEST_F(MotionWriterTest, RejectsOtherFormatsAndEmptyMeshes) {
    const QuadMesh mesh = cube();
    EXPECT_THROW(MotionWriter(folder_ / "m.ply", mesh, 2, 24), Unsupported);
    EXPECT_THROW(MotionWriter(folder_ / "m.glb", QuadMesh{}, 2, 24), InvalidInput);
}

}  // namespace
}  // namespace coppice
