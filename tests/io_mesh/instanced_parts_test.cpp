#include "coppice/io_mesh/instanced_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "coppice/base/error.h"
#include "coppice/io_mesh/reader.h"
#include "coppice/io_mesh/writer.h"
#include "coppice/system/file.h"
#include "small_image.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

constexpr float kHalf = 0.70710678f;

/// A triangle far from the copies.
TriMesh make_surface() {
    TriMesh mesh;
    mesh.positions = {{-9, 0, 0}, {-8, 0, 0}, {-9, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    mesh.origin = {50, 60, 70};
    return mesh;
}

class InstancedPartsFile : public test::FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        prototypes_.resize(3);
        prototypes_[0] = {"square", {}, {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}, 0};
        prototypes_[0].mesh.positions = {{-0.5f, 0, 0}, {0.5f, 0, 0}, {0.5f, 1, 0}, {-0.5f, 1, 0}};
        prototypes_[0].mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
        prototypes_[1] = {"unused", prototypes_[0].mesh, prototypes_[0].texture, 0};
        prototypes_[2] = {"triangle", {}, {}, 1};
        prototypes_[2].mesh.positions = {{-1, 0, 0}, {1, 0, 0}, {0, 2, 0}};
        prototypes_[2].mesh.triangles = {{0, 1, 2}};
        const auto image = folder_ / "leaf.png";
        write_file(image, small_image());
        materials_.push_back({.name = "leaf", .color = image, .cut_out = true, .double_sided = true});
        materials_.push_back({.name = "bud", .base_color = {0.25f, 0.5f, 0.125f}});
        copies_.prototypes = {2, 0, 0};
        copies_.positions = {{1, 0, 0}, {0, 0, 5}, {0, 3, 0}};
        copies_.rotations = {Quaternion{}, Quaternion{kHalf, 0, 0, kHalf}, Quaternion{0, 0, kHalf, kHalf}};
        copies_.scales = {1, 2, 0.5f};
        copies_.colors = {{255, 255, 255}, {255, 0, 0}, {0, 188, 255}};
        copies_.origin = {50, 60, 71};
        parts_ = {prototypes_, materials_, &copies_};
    }

    std::filesystem::path write(const std::string& name, InstanceStorage storage = InstanceStorage::instanced,
                                const Context& ctx = {}) {
        parts_.storage = storage;
        write_mesh(folder_ / name, make_surface(), {.parts = parts_}, ctx);
        return folder_ / name;
    }

    std::vector<Prototype> prototypes_;
    std::vector<MaterialFiles> materials_;
    Instances copies_;
    InstancedParts parts_;
};

/// Returns the corners of all triangles in world coordinates, in order.
std::vector<Vec3d> list_corners(const PolygonMesh& mesh) {
    std::vector<Vec3d> out;
    for (const std::uint32_t v : mesh.corners) out.push_back(Vec3d(mesh.positions[v]) + mesh.origin);
    return out;
}

TEST_F(InstancedPartsFile, CopiesAreReadBackFromAllFormats) {
    const TriMesh surface = make_surface();
    const MergedInstances merged = merge_instances(prototypes_, copies_);
    std::vector<Vec3d> expected = list_corners(to_polygons(surface));
    for (const Vec3d& p : list_corners(to_polygons(merged.mesh))) expected.push_back(p);
    ASSERT_EQ(expected.size(), 3u * (1 + 2 * 2 + 1));
    for (const InstanceStorage storage : {InstanceStorage::instanced, InstanceStorage::merged}) {
        for (const char* name : {"a.glb", "a.obj", "a.ply", "a.stl"}) {
            const auto found = list_corners(read_mesh(write(name, storage)));
            ASSERT_EQ(found.size(), expected.size()) << name;
            // Rotations are rounded to 16 bits, STL to its coordinates near 70 m.
            for (std::size_t i = 0; i < found.size(); ++i)
                EXPECT_LT(distance(found[i], expected[i]), 2e-4) << name << " " << i;
        }
    }
}

TEST_F(InstancedPartsFile, GlbStoresEachPrototypeOnce) {
    const std::string text = read_file(write("a.glb"));
    for (const char* part :
         {"\"extensionsUsed\":[\"EXT_mesh_gpu_instancing\"]", "\"name\":\"square\"", "\"alphaMode\":\"MASK\"",
          "\"doubleSided\":true", "\"baseColorFactor\":[0.25,0.5,0.125,1.0]", "\"_COLOR_0\":"}) {
        EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
    }
    EXPECT_EQ(text.find("extensionsRequired"), std::string::npos);
    EXPECT_EQ(text.find("unused"), std::string::npos);
    const std::string merged = read_file(write("b.glb", InstanceStorage::merged));
    EXPECT_EQ(merged.find("EXT_mesh_gpu_instancing"), std::string::npos);
    EXPECT_NE(merged.find("\"COLOR_0\":"), std::string::npos);
}

TEST_F(InstancedPartsFile, GlbTakes36BytesPerCopy) {
    const auto size = [&] { return static_cast<double>(std::filesystem::file_size(write("a.glb"))); };
    const double few = size();
    for (std::uint32_t i = 0; i < 1000; ++i) {
        copies_.prototypes.push_back(0);
        copies_.positions.push_back({0, 0, static_cast<float>(i)});
        copies_.rotations.push_back({});
        copies_.scales.push_back(2);
        copies_.colors.push_back({1, 2, 3});
    }
    // 12 for the position, 8 for the rotation, 12 for the scale, 4 for the colour; and longer numbers in the
    // description.
    EXPECT_NEAR(size() - few, 36'000, 100);
}

TEST_F(InstancedPartsFile, ObjHasGroupsAndMaterials) {
    const std::string text = read_file(write("a.obj"));
    EXPECT_NE(text.find("mtllib a.mtl\n"), std::string::npos);
    EXPECT_NE(text.find("g tree\nusemtl bark\nf "), std::string::npos);
    EXPECT_NE(text.find("g square\nusemtl leaf\nf "), std::string::npos);
    EXPECT_NE(text.find("g triangle\nusemtl bud\nf "), std::string::npos);
    EXPECT_EQ(text.find("unused"), std::string::npos);
    EXPECT_EQ(read_file(folder_ / "a.mtl"),
              "# Coppice\nnewmtl bark\nKd 0.32 0.22 0.15\nKs 0 0 0\nnewmtl leaf\nKd 1 1 1\nKs 0 0 0\nmap_Kd "
              "leaf.png\nmap_d leaf.png\n"
              "newmtl bud\nKd 0.25 0.5 0.125\nKs 0 0 0\n");
}

TEST_F(InstancedPartsFile, UsdaHasAPointInstancer) {
    const std::string text = read_file(write("a.usda"));
    for (const char* part :
         {"def PointInstancer \"leaves\"",
          "rel prototypes = [</tree/leaves/prototypes/square>, </tree/leaves/prototypes/triangle>]",
          "int[] protoIndices = [1, 0, 0]", "point3f[] positions = [(1, 0, 0), (0, 0, 5), (0, 3, 0)]",
          "quath[] orientations = [(1, 0, 0, 0), (0.7071, 0.7071, 0, 0), (0.7071, 0, 0, 0.7071)]",
          "float3[] scales = [(1, 1, 1), (2, 2, 2), (0.5, 0.5, 0.5)]",
          "color3f[] primvars:displayColor = [(1, 1, 1), (1, 0, 0), (0, 0.5029, 1)]",
          "double3 xformOp:translate = (0, 0, 1)", "float3[] extent = [(-1, 0, 0), (2, 3.25, 7)]",
          "float inputs:opacityThreshold = 0.5",
          "inputs:opacity.connect = </tree/leaves/leaf/diffuseColor.outputs:a>",
          "uniform bool doubleSided = 1", "rel material:binding = </tree/leaves/leaf>",
          "color3f inputs:diffuseColor = (0.25, 0.5, 0.125)"}) {
        EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
    }
    for (const InstanceStorage storage : {InstanceStorage::instanced, InstanceStorage::merged}) {
        const std::string whole = read_file(write("b.usda", storage));
        EXPECT_EQ(std::ranges::count(whole, '{'), std::ranges::count(whole, '}'));
        EXPECT_EQ(std::ranges::count(whole, '('), std::ranges::count(whole, ')'));
    }
    const std::string merged = read_file(folder_ / "b.usda");
    EXPECT_EQ(merged.find("PointInstancer"), std::string::npos);
    EXPECT_NE(merged.find("faceVertexIndices = [0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7]"), std::string::npos);
}

TEST_F(InstancedPartsFile, FilesAreIdenticalForAnyNumberOfThreads) {
    for (int k = 0; k < 12; ++k) {  // 12,288 copies
        const std::size_t n = copies_.size();
        for (std::size_t i = 0; i < n; ++i) {
            copies_.prototypes.push_back(copies_.prototypes[i]);
            copies_.positions.push_back(copies_.positions[i] + Vec3{0.1f, 0, static_cast<float>(k)});
            copies_.rotations.push_back(copies_.rotations[i]);
            copies_.scales.push_back(copies_.scales[i]);
            copies_.colors.push_back(copies_.colors[i]);
        }
    }
    for (const InstanceStorage storage : {InstanceStorage::instanced, InstanceStorage::merged}) {
        for (const char* name : {"a.glb", "a.obj", "a.ply", "a.usda"}) {
            const std::string one = read_file(write(name, storage, {.threads = 1}));
            EXPECT_EQ(one, read_file(write(name, storage, {.threads = 7}))) << name;
        }
    }
}

TEST_F(InstancedPartsFile, RefusesBadInput) {
    const auto refuses = [&](const char* text) {
        try {
            write("a.glb");
            ADD_FAILURE() << text;
        } catch (const InvalidInput& e) {
            EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
        }
    };
    prototypes_[2].material = 2;
    refuses("prototype 'triangle' refers to material 2 of 2");
    prototypes_[2].material = 1;
    prototypes_[2].name = "square";
    refuses("two prototypes have the name 'square'");
    prototypes_[2].name = "a leaf";
    refuses("letters, digits and underscores");
    prototypes_[2].name = "triangle";
    materials_[1].name = "bark";  // the name of the material of the surface
    refuses("two materials have the name 'bark'");
    materials_[1].name = "bud";
    copies_.prototypes[0] = 3;
    refuses("copy 0 refers to prototype 3 of 3");
    copies_.prototypes.clear();
    refuses("different lengths");
    copies_ = {};
    EXPECT_NO_THROW(write("a.glb"));  // no copies
}

}  // namespace
}  // namespace coppice
