#include "coppice/io_mesh/writer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <sstream>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/io_mesh/reader.h"
#include "coppice/mesh/topology.h"
#include "coppice/system/file.h"
#include "errors.h"
#include "small_image.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

namespace fs = std::filesystem;

/// A closed cuboid of 1 x 2 x 3 m with one corner at the origin.
QuadMesh cuboid() {
    QuadMesh mesh;
    for (const float z : {0.f, 3.f}) {
        for (const Vec3 p : {Vec3{0, 0, z}, Vec3{1, 0, z}, Vec3{1, 2, z}, Vec3{0, 2, z}})
            mesh.positions.push_back(p);
    }
    mesh.quads = {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    return mesh;
}

/// A wavy sheet with more rows than one run of the writers, and coordinates with many digits.
QuadMesh sheet(std::uint32_t n) {
    QuadMesh mesh;
    for (std::uint32_t i = 0; i <= n; ++i) {
        for (std::uint32_t k = 0; k <= n; ++k) {
            const auto x = static_cast<float>(i) / 7;
            const auto y = static_cast<float>(k) / 3;
            mesh.positions.push_back({x, y, std::sin(x) * std::cos(y) * 1e-3f});
        }
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        for (std::uint32_t k = 0; k < n; ++k) {
            const std::uint32_t a = i * (n + 1) + k;
            mesh.quads.push_back({a, a + n + 1, a + n + 2, a + 1});
        }
    }
    return mesh;
}

double volume(const PolygonMesh& mesh) {
    double six = 0;
    for (const Triangle& t : triangulate(mesh).triangles) {
        six +=
            dot(Vec3d(mesh.positions[t[0]]), cross(Vec3d(mesh.positions[t[1]]), Vec3d(mesh.positions[t[2]])));
    }
    return six / 6;
}

class MeshWriter : public test::FolderTest {
  protected:
    template <class Mesh>
    std::string written(const std::string& name, const Mesh& mesh, const MeshWriteOptions& options = {},
                        const Context& ctx = {}) {
        write_mesh(folder_ / name, mesh, options, ctx);
        return read_file(folder_ / name);
    }
    template <class Mesh>
    PolygonMesh round_trip(const std::string& name, const Mesh& mesh) {
        write_mesh(folder_ / name, mesh);
        return read_mesh(folder_ / name);
    }
    template <class Mesh>
    std::string error_of(const std::string& name, const Mesh& mesh, const MeshWriteOptions& options = {}) {
        const std::string error = test::error_of<Error>([&] { write_mesh(folder_ / name, mesh, options); });
        EXPECT_TRUE(fs::is_empty(folder_)) << "something was left behind";
        return error;
    }
};

// Two adjacent quads: they share the middle edge, with a texture seam at one of its ends.
TEST_F(MeshWriter, WritesTextureCoordinates) {
    PolygonMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}};
    for (const Quad q : {Quad{0, 1, 2, 3}, Quad{1, 4, 5, 2}}) mesh.add_face(q);
    const std::vector<TexturePoint> texture{{0, 0},    {0.5f, 0}, {1, 1}, {0, 1},
                                            {0.5f, 0}, {1, 0},    {1, 1}, {0, 1}};
    write_mesh(folder_ / "a.obj", mesh, {.texture = texture});
    EXPECT_EQ(read_file(folder_ / "a.obj"),
              "# Coppice, metres, Z up\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n"
              "vt 0 0\nvt 0.5 0\nvt 1 1\nvt 0 1\nvt 1 0\nvt 1 1\nvt 0 1\n"
              "f 1/1 2/2 3/3 4/4\nf 2/2 5/5 6/6 3/7\n");
    EXPECT_EQ(read_mesh(folder_ / "a.obj").corners, mesh.corners);
    write_mesh(folder_ / "a.usda", mesh, {.texture = texture});
    EXPECT_NE(
        read_file(folder_ / "a.usda")
            .find("texCoord2f[] primvars:st = [(0, 0), (0.5, 0), (1, 1), (0, 1), (0.5, 0), (1, 0), (1, 1), "
                  "(0, 1)] (\n            interpolation = \"faceVarying\"\n        )"),
        std::string::npos);
}

TEST_F(MeshWriter, QuotesPathsWithAnAtSignInUsda) {
    const PolygonMesh mesh = to_polygons(cuboid());
    const std::vector<TexturePoint> texture(mesh.corners.size());
    const auto line = [&](const char* image) {
        write_mesh(folder_ / "a.usda", mesh, {.texture = texture, .materials = {{.color = folder_ / image}}});
        const std::string text = read_file(folder_ / "a.usda");
        const std::size_t at = text.find("inputs:file = ");
        return text.substr(at, text.find('\n', at) - at);
    };
    EXPECT_EQ(line("a.png"), "inputs:file = @a.png@");
    EXPECT_EQ(line("a@b.png"), "inputs:file = @@@a@b.png@@@");
    EXPECT_EQ(line("a@@@b.png"), "inputs:file = @@@a\\@@@b.png@@@");
}

// Two adjacent squares, the second with a mirrored texture: of the six vertices, the two of the common edge
// are divided, because their bitangents have opposite signs.
TEST_F(MeshWriter, GlbHasTangentsForNormalMapsOnly) {
    PolygonMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}};
    for (const Quad q : {Quad{0, 1, 2, 3}, Quad{1, 4, 5, 2}}) mesh.add_face(q);
    mesh.texture = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {1, 0}, {0, 0}, {0, 1}, {1, 1}};
    const fs::path image = folder_ / "image.png";
    write_file(image, small_image());
    const auto with = [&](const MaterialFiles& material) {
        return written("a.glb", mesh, {.texture = mesh.texture, .materials = {material}});
    };
    EXPECT_EQ(with({}).find("TANGENT"), std::string::npos);
    EXPECT_EQ(with({.color = image}).find("TANGENT"), std::string::npos);
    const std::string bytes = with({.color = image, .normal = image});
    EXPECT_NE(bytes.find("\"TANGENT\""), std::string::npos);
    EXPECT_NE(bytes.find("\"componentType\":5126,\"count\":8,\"type\":\"VEC4\""), std::string::npos);
    std::vector<std::array<float, 4>> tangents(8);  // after positions, normals and texture coordinates
    const std::size_t skipped = 4 + 8 * (3 + 3 + 2) * sizeof(float);
    std::memcpy(tangents.data(), bytes.data() + bytes.find("BIN") + skipped, 8 * 4 * sizeof(float));
    const auto count = [&](float x, float w) {
        return std::ranges::count(tangents, std::array<float, 4>{x, 0, 0, w});
    };
    EXPECT_EQ(count(1, 1), 4);
    EXPECT_EQ(count(-1, -1), 4);
}

// A strip of three squares with materials, of which the second has no faces.
class MaterialWriter : public MeshWriter {
  protected:
    void SetUp() override {
        MeshWriter::SetUp();
        for (std::uint32_t i = 0; i < 4; ++i) {
            mesh_.positions.push_back({static_cast<float>(i), 0, 0});
            mesh_.positions.push_back({static_cast<float>(i), 1, 0});
        }
        for (std::uint32_t i = 0; i < 6; i += 2) mesh_.add_face(Quad{i, i + 2, i + 3, i + 1});
        for (int face = 0; face < 3; ++face)
            mesh_.texture.insert(mesh_.texture.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
        write_file(folder_ / "image.png", small_image());
        for (const char* name : {"bark", "unused", "twig"})
            materials_.push_back({.name = name, .color = folder_ / "image.png"});
    }
    MeshWriteOptions options() const {
        return {.texture = mesh_.texture, .materials = materials_, .face_materials = of_faces_};
    }
    // Returns the names of the groups of the faces, as they are read.
    std::vector<std::string> read_groups(const std::string& name) const {
        const PolygonMesh read = read_mesh(folder_ / name);
        std::vector<std::string> out;
        for (const std::uint32_t group : read.group) out.push_back(read.group_names[group]);
        return out;
    }

    PolygonMesh mesh_;
    std::vector<MaterialFiles> materials_;
    std::vector<std::uint32_t> of_faces_{0, 2, 0};
};

TEST_F(MaterialWriter, GlbRefusesImagesThatEndEarlyOrAreTooLarge) {
    std::string half = small_image(), large = small_image(), empty = small_image();
    half.resize(half.size() - 4);
    large[17] = 1;  // the width plus 65,536
    empty[19] = 0;
    const std::string jpeg("\xff\xd8\xff\xe0\0\4..\xff\xc0\0\x11\x08\0\x10\0\x10", 17);
    const std::string end = "\xff\xd9";
    for (const std::string& bytes : {half, large, empty, jpeg, "\xff\xd8 half" + end, std::string("text")}) {
        write_file(folder_ / "image.png", bytes);
        EXPECT_THROW(write_mesh(folder_ / "a.glb", mesh_, options()), InvalidInput);
        EXPECT_FALSE(std::filesystem::exists(folder_ / "a.glb"));
        write_file(folder_ / "b_color.png", bytes);
        EXPECT_THROW(find_material(folder_ / "b"), InvalidInput);
    }
    write_file(folder_ / "image.png", jpeg + end);
    EXPECT_NO_THROW(write_mesh(folder_ / "a.glb", mesh_, options()));
    for (const std::string& bytes : {small_image(), jpeg + end}) {
        write_file(folder_ / "b_color.png", bytes);
        EXPECT_NO_THROW(find_material(folder_ / "b"));
    }
}

TEST_F(MaterialWriter, GlbHasAPrimitiveForEachMaterialWithFaces) {
    for (const bool has_normals : {false, true}) {
        if (has_normals) materials_[2].normal = folder_ / "image.png";
        const std::string bytes = written("a.glb", mesh_, options());
        EXPECT_EQ(bytes.find("unused"), std::string::npos);
        EXPECT_EQ(bytes.find("\"TANGENT\"") != std::string::npos, has_normals);
        EXPECT_EQ(read_groups("a.glb"),
                  (std::vector<std::string>{"surface/bark", "surface/bark", "surface/bark", "surface/bark",
                                            "surface/twig", "surface/twig"}));
        const PolygonMesh read = read_mesh(folder_ / "a.glb");
        EXPECT_EQ(read.positions.size(), 8u);
        EXPECT_EQ(read.positions[read.corners[read.first[4]]].x, 1);  // the first triangle of the twig
    }
}

TEST_F(MaterialWriter, ObjNamesTheMaterialOfEachRunOfFaces) {
    const std::string text = written("a.obj", mesh_, options());
    EXPECT_NE(text.find("usemtl bark\nf 1/1"), std::string::npos);
    EXPECT_NE(text.find("usemtl twig\nf 3/"), std::string::npos);
    EXPECT_EQ(read_groups("a.obj"), (std::vector<std::string>{"bark", "twig", "bark"}));
    EXPECT_EQ(read_file(folder_ / "a.mtl"),
              "# Coppice\nnewmtl bark\nKd 1 1 1\nKs 0 0 0\nmap_Kd image.png\n"
              "newmtl twig\nKd 1 1 1\nKs 0 0 0\nmap_Kd image.png\n");
}

TEST_F(MaterialWriter, UsdaHasASubsetForEachMaterialWithFaces) {
    const std::string text = written("a.usda", mesh_, options());
    EXPECT_EQ(text.find("unused"), std::string::npos);
    EXPECT_NE(text.find("familyType = \"partition\""), std::string::npos);
    EXPECT_NE(text.find("int[] indices = [0, 2]\n            rel material:binding = </tree/bark>"),
              std::string::npos);
    EXPECT_NE(text.find("int[] indices = [1]\n            rel material:binding = </tree/twig>"),
              std::string::npos);
    EXPECT_NE(text.find("def Material \"twig\""), std::string::npos);
}

// Two adjacent squares with a seam at one end of their common edge: vertex 2 is written twice.
TEST_F(MeshWriter, WritesAttributesOfVertices) {
    PolygonMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}};
    for (const Quad q : {Quad{0, 1, 2, 3}, Quad{1, 4, 5, 2}}) mesh.add_face(q);
    mesh.texture = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {1, 0}, {2, 0}, {2, 1}, {0, 1}};
    const std::vector<VertexAttribute> attributes{{"order", {0, 1, 2, 3, 4, 5}},
                                                  {"radius", Buffer<float>(6, 7)}};
    const auto contains = [](const std::string& bytes, std::span<const float> numbers) {
        return bytes.find(std::string_view(reinterpret_cast<const char*>(numbers.data()),
                                           numbers.size_bytes())) != std::string::npos;
    };
    const std::array<float, 6> plain{0, 1, 2, 3, 4, 5};
    const std::array<float, 7> split{0, 1, 2, 3, 4, 5, 2};
    const std::string without = written("a.glb", mesh, {.attributes = attributes});
    EXPECT_NE(without.find("\"_ORDER\""), std::string::npos);
    EXPECT_NE(without.find("\"_RADIUS\""), std::string::npos);
    EXPECT_TRUE(contains(without, plain));
    const std::string with = written("a.glb", mesh, {.texture = mesh.texture, .attributes = attributes});
    EXPECT_TRUE(contains(with, split));
    const std::string ply = written("a.ply", mesh, {.texture = mesh.texture, .attributes = attributes});
    EXPECT_NE(ply.find("property float t\nproperty float order\nproperty float radius\n"), std::string::npos);
    EXPECT_TRUE(contains(ply, std::array<float, 7>{1, 1, 0, 0, 1, 2, 7}));  // the seventh vertex
    for (const char* name : {"a.ply", "a.glb"}) {
        const std::vector<std::string> names{"order", "radius"};
        const MeshFile file = read_mesh_file(folder_ / name, names);  // welded again
        ASSERT_EQ(file.mesh.positions.size(), 6u) << name;
        ASSERT_EQ(file.attributes.size(), 2u) << name;
        for (std::size_t v = 0; v < 6; ++v) {
            const Vec3 p = file.mesh.positions[v];
            const auto at = std::ranges::find(mesh.positions, p) - mesh.positions.begin();
            EXPECT_EQ(file.attributes[0].values[v], static_cast<float>(at)) << name;
            EXPECT_EQ(file.attributes[1].values[v], 7) << name;
        }
    }
    EXPECT_NE(
        written("a.usda", mesh, {.attributes = attributes})
            .find("float[] primvars:order = [0, 1, 2, 3, 4, 5] (\n            interpolation = \"vertex\""),
        std::string::npos);
    EXPECT_EQ(written("a.obj", mesh, {.attributes = attributes}), written("b.obj", mesh));
}

/// Returns the cuboid with the square of the texture on each face: every vertex is on seams.
PolygonMesh textured_cuboid() {
    PolygonMesh mesh = to_polygons(cuboid());
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const auto shift = 0.25f * static_cast<float>(f);
        for (const TexturePoint p :
             {TexturePoint{shift, 0}, {shift + 1, 0}, {shift + 1, 1.5f}, {shift, 1.5f}})
            mesh.texture.push_back(p);
    }
    return mesh;
}

// The second set has seams of its own, and weights from 0 to 1.
TEST_F(MeshWriter, SecondTextureCoordinatesAreReadBackByCorner) {
    PolygonMesh mesh = textured_cuboid();
    for (std::size_t i = 0; i < mesh.texture.size(); ++i)
        mesh.texture_blends.push_back({{static_cast<float>(i), -0.5f}, 0.125f * static_cast<float>(i % 9)});
    const MeshWriteOptions options{.texture = mesh.texture, .texture_blends = mesh.texture_blends};
    for (const char* name : {"a.ply", "a.glb"}) {
        SCOPED_TRACE(name);
        write_mesh(folder_ / name, mesh, options);
        const PolygonMesh back = read_mesh(folder_ / name);
        EXPECT_EQ(back.positions.size(), 8u);
        ASSERT_EQ(back.texture_blends.size(), back.corners.size());
        for (std::size_t k = 0; k < back.corners.size(); ++k) {
            const auto at = std::ranges::find(mesh.texture_blends, back.texture_blends[k]);
            ASSERT_NE(at, mesh.texture_blends.end());
            const auto corner = static_cast<std::size_t>(at - mesh.texture_blends.begin());
            EXPECT_EQ(back.texture[k], mesh.texture[corner]);
            EXPECT_EQ(back.positions[back.corners[k]], mesh.positions[mesh.corners[corner]]);
        }
    }
    EXPECT_NE(written("a.usda", mesh, options).find("float[] primvars:blend = [0, 0.125, 0.25,"),
              std::string::npos);
    EXPECT_NE(written("a.usda", mesh, options).find("texCoord2f[] primvars:st1 = [(0, -0.5), (1, -0.5),"),
              std::string::npos);
    EXPECT_EQ(written("a.obj", mesh, options), written("b.obj", mesh, {.texture = mesh.texture}));
}

TEST_F(MeshWriter, TextureCoordinatesAreReadBackByCorner) {
    const PolygonMesh mesh = textured_cuboid();
    for (const char* name : {"a.obj", "a.ply", "a.glb"}) {
        SCOPED_TRACE(name);
        write_mesh(folder_ / name, mesh, {.texture = mesh.texture});
        const PolygonMesh back = read_mesh(folder_ / name);
        EXPECT_EQ(back.positions.size(), 8u);
        const TopologyReport t = topology(back);
        EXPECT_EQ(t.open_edges + t.non_manifold_edges + t.non_manifold_vertices, 0u);
        ASSERT_EQ(back.texture.size(), back.corners.size());
        // Triangles of GLB: 0 1 2, 0 2 3 or 1 2 3, 1 3 0; all numbers here are exact in float.
        const std::uint32_t parts = back.face_count() / mesh.face_count();
        for (std::uint32_t f = 0; f < back.face_count(); ++f) {
            for (std::size_t k = back.first[f]; k < back.first[f + 1]; ++k) {
                const auto of = mesh.face(f / parts);
                const Vec3 p = back.positions[back.corners[k]];
                const auto at =
                    std::ranges::find_if(of, [&](std::uint32_t v) { return mesh.positions[v] == p; });
                ASSERT_NE(at, of.end());
                EXPECT_EQ(back.texture[k],
                          mesh.texture[4 * (f / parts) + static_cast<std::size_t>(at - of.begin())]);
            }
        }
    }
}

TEST_F(MeshWriter, QuadsAreReadBackBitIdenticallyFromObjAndPly) {
    const QuadMesh mesh = sheet(150);  // 22,500 quads: three runs
    const PolygonMesh expected = to_polygons(mesh);
    for (const char* name : {"a.obj", "a.ply"}) {
        const PolygonMesh back = round_trip(name, mesh);
        EXPECT_EQ(back.positions, expected.positions) << name;
        EXPECT_EQ(back.corners, expected.corners) << name;
        EXPECT_EQ(back.first, expected.first) << name;
    }
}

TEST_F(MeshWriter, ObjHasTheExpectedText) {
    QuadMesh mesh;
    mesh.positions = {{0, 0, 0}, {0.1f, 0, 0}, {1, 1, 1e-7f}, {-2.5f, 1, 0}};
    mesh.quads = {{0, 1, 2, 3}};
    EXPECT_EQ(written("a.obj", mesh),
              "# Coppice, metres, Z up\nv 0 0 0\nv 0.1 0 0\nv 1 1 1e-07\nv -2.5 1 0\nf 1 2 3 4\n");
    mesh.origin = {500000, 0.5, 0};
    EXPECT_NE(written("a.obj", mesh).find("\nv 499997.5 1.5 0\n"), std::string::npos);
}

TEST_F(MeshWriter, TrianglesPreserveTheVolumeAndTheOutside) {
    const QuadMesh mesh = cuboid();
    for (const char* name : {"a.obj", "a.ply", "a.stl", "a.glb"}) {
        const PolygonMesh back = round_trip(name, mesh);
        EXPECT_EQ(back.positions.size(), 8u) << name;
        EXPECT_NEAR(volume(back), 6, 1e-6) << name;
        const bool quads = name[2] == 'o' || name[2] == 'p';
        EXPECT_EQ(back.face_count(), quads ? 6u : 12u) << name;
    }
}

// 100 m from zero floats are 7.6e-6 m apart, so that rounding alone would map the eight corners of the small
// cuboid to one or two positions.
TEST_F(MeshWriter, StlSeparatesVerticesThatRoundToOnePosition) {
    QuadMesh mesh = cuboid();
    for (const Vec3 p : cuboid().positions) mesh.positions.push_back(Vec3{2, 1, 1} + p * 1e-6f);
    for (Quad q : cuboid().quads) {
        for (std::uint32_t& v : q) v += 8;
        mesh.quads.push_back(q);
    }
    mesh.origin = {100, -50, 0};
    const PolygonMesh back = round_trip("a.stl", mesh);
    EXPECT_EQ(back.positions.size(), 16u);
    const TopologyReport t = topology(back);
    EXPECT_EQ(t.components, 2u);
    EXPECT_EQ(t.open_edges + t.non_manifold_edges + t.non_manifold_vertices, 0u);
    EXPECT_NEAR(volume(back), 6, 1e-2);
}

// A texture seam disappears if vertices are welded.
TEST_F(MeshWriter, StlMergesCoincidentVertices) {
    QuadMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}};
    mesh.quads = {{0, 1, 2, 3}, {4, 5, 6, 7}};
    mesh.origin = {20, 0, 0};
    EXPECT_EQ(round_trip("a.stl", mesh).positions.size(), 6u);
}

TEST_F(MeshWriter, RejectsAMeshWithoutFaces) {
    QuadMesh mesh = cuboid();
    mesh.quads.clear();
    for (const char* name : {"a.obj", "a.ply", "a.stl", "a.glb", "a.usda"}) {
        EXPECT_EQ(test::error_of<InvalidInput>([&] { write_mesh(folder_ / name, mesh); }),
                  fmt::format("cannot write {}: the mesh has no faces", (folder_ / name).string()));
        EXPECT_FALSE(fs::exists(folder_ / name));
    }
    EXPECT_THROW(write_cage(folder_ / "c.usda", mesh), InvalidInput);
}

TEST_F(MeshWriter, SplitsQuadsAlongTheShorterDiagonal) {
    QuadMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {3, 3, 0}, {0, 1, 0}};  // 0-2 is longer than 1-3
    mesh.quads = {{0, 1, 2, 3}};
    const PolygonMesh back = round_trip("a.glb", mesh);
    ASSERT_EQ(back.corners, (std::vector<std::uint32_t>{1, 2, 3, 1, 3, 0}));
}

TEST_F(MeshWriter, WritesAllMeshTypesAndLargeFaces) {
    PolygonMesh mesh;
    std::vector<std::uint32_t> ring;
    for (std::uint32_t i = 0; i < 300; ++i) {  // more corners than a byte can represent
        const float angle = 6.2831853f * static_cast<float>(i) / 300;
        mesh.positions.push_back({std::cos(angle), std::sin(angle), 0});
        ring.push_back(i);
    }
    mesh.add_face(ring);
    mesh.add_face(std::array{0u, 1u, 2u});
    for (const char* name : {"a.obj", "a.ply"}) {
        EXPECT_EQ(round_trip(name, mesh).corners, mesh.corners) << name;
        EXPECT_EQ(round_trip(name, mesh).first, mesh.first) << name;
    }
    for (const char* name : {"a.stl", "a.glb"}) EXPECT_EQ(round_trip(name, mesh).face_count(), 299u) << name;
    const TriMesh triangles = triangulate(cuboid());
    for (const char* name : {"a.obj", "a.ply", "a.stl", "a.glb"}) {
        EXPECT_EQ(round_trip(name, triangles).face_count(), 12u) << name;
    }
}

TEST_F(MeshWriter, OriginPreservesItsDigits) {
    QuadMesh mesh = cuboid();
    mesh.positions[6] = {1.0625f, 2, 3.03125f};
    mesh.origin = {512345.25, -5212345.5, 310.125};
    for (const char* name : {"a.obj", "a.ply", "a.glb"}) {
        const PolygonMesh back = round_trip(name, mesh);
        for (std::size_t v = 0; v < 8; ++v) {
            EXPECT_EQ(back.origin + Vec3d(back.positions[v]), mesh.origin + Vec3d(mesh.positions[v])) << name;
        }
    }
}

TEST_F(MeshWriter, StlAcceptsOnlyOriginsNearZero) {
    QuadMesh mesh = cuboid();
    mesh.origin = {1, 2, 3};
    const PolygonMesh back = round_trip("a.stl", mesh);
    EXPECT_NEAR(volume(back), 6, 1e-5);
    fs::remove(folder_ / "a.stl");
    mesh.origin = {500000, 0, 0};
    EXPECT_EQ(error_of("a.stl", mesh),
              "cannot write " + (folder_ / "a.stl").string() +
                  ": STL has too few digits for coordinates that far from zero; write PLY or OBJ "
                  "instead");
}

TEST_F(MeshWriter, StlNormalsMatchTheCorners) {
    const std::string bytes = written("a.stl", cuboid());
    ASSERT_EQ(bytes.size(), 84u + 12 * 50);
    for (std::size_t t = 0; t < 12; ++t) {
        std::array<Vec3, 4> f;
        std::memcpy(&f, bytes.data() + 84 + 50 * t, sizeof f);
        EXPECT_NEAR(dot(f[0], normalized(cross(f[2] - f[1], f[3] - f[1]))), 1, 1e-6);
    }
}

TEST_F(MeshWriter, WritesUsda) {
    QuadMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.quads = {{0, 1, 2, 3}};
    const std::string text = written("a.usda", mesh);
    for (const char* part :
         {"#usda 1.0\n", "defaultPrim = \"tree\"", "metersPerUnit = 1\n", "upAxis = \"Z\"",
          "extent = [(0, 0, 0), (1, 1, 0)]", "faceVertexCounts = [4]", "faceVertexIndices = [0, 1, 2, 3]",
          "point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]",
          "normal3f[] normals = [(0, 0, 1), (0, 0, 1), (0, 0, 1), (0, 0, 1)]",
          "subdivisionScheme = \"none\""}) {
        EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
    }
    EXPECT_EQ(text.find("xformOp"), std::string::npos);
    mesh.origin = {500000.5, 0, 2};
    EXPECT_NE(written("a.usda", mesh).find("double3 xformOp:translate = (500000.5, 0, 2)"),
              std::string::npos);
}

TEST_F(MeshWriter, CagesHaveASubdivisionScheme) {
    write_cage(folder_ / "cage.usda", cuboid());
    const std::string text = read_file(folder_ / "cage.usda");
    EXPECT_NE(text.find("subdivisionScheme = \"catmullClark\""), std::string::npos);
    EXPECT_EQ(text.find("normals"), std::string::npos);
}

TEST_F(MeshWriter, OptionTakesPrecedenceOverTheName) {
    EXPECT_TRUE(written("a.txt", cuboid(), {.format = MeshFormat::ply}).starts_with("ply\n"));
}

TEST_F(MeshWriter, FilesAreIdenticalForAnyNumberOfThreads) {
    const QuadMesh mesh = sheet(200);
    for (const char* name : {"a.obj", "a.ply", "a.stl", "a.glb", "a.usda"}) {
        Context one;
        one.threads = 1;
        Context seven;
        seven.threads = 7;
        EXPECT_EQ(written(name, mesh, {}, one), written(name, mesh, {}, seven)) << name;
    }
}

TEST_F(MeshWriter, ProgressNeverDecreases) {
    Context ctx;
    std::vector<float> seen;
    ctx.progress = [&](float f) { seen.push_back(f); };
    for (const char* name : {"a.obj", "a.ply", "a.stl", "a.glb", "a.usda"}) {
        seen.clear();
        written(name, sheet(150), {}, ctx);
        EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end())) << name;
        EXPECT_EQ(seen.back(), 1.f) << name;
    }
}

TEST_F(MeshWriter, CreatesNoFileIfCancelled) {
    std::stop_source stop;
    stop.request_stop();
    Context ctx;
    ctx.stop = stop.get_token();
    EXPECT_THROW(write_mesh(folder_ / "a.obj", cuboid(), {}, ctx), Cancelled);
    EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(MeshWriter, LeavesNoMaterialLibraryWithoutItsObj) {
    std::stop_source stop;
    stop.request_stop();
    Context ctx;
    ctx.stop = stop.get_token();
    const std::vector<TexturePoint> texture(4 * cuboid().quads.size(), TexturePoint{0, 0});
    const MeshWriteOptions options{.texture = texture, .materials = {{.color = folder_ / "color.png"}}};
    EXPECT_THROW(write_mesh(folder_ / "a.obj", cuboid(), options, ctx), Cancelled);
    EXPECT_FALSE(fs::exists(folder_ / "a.mtl"));
    write_mesh(folder_ / "a.obj", cuboid(), options);
    EXPECT_TRUE(fs::exists(folder_ / "a.mtl"));
}

// Every third column of the sheet is mirrored, so that many vertices are divided.
TEST_F(MeshWriter, TangentsDoNotDependOnThreads) {
    const QuadMesh mesh = sheet(60);
    std::vector<TexturePoint> texture;
    for (const Quad& q : mesh.quads) {
        const float sign = (q[0] / 61 * 7) % 3 == 0 ? -1.0f : 1.0f;
        for (const std::uint32_t v : q) texture.push_back({sign * mesh.positions[v].x, mesh.positions[v].y});
    }
    const fs::path image = folder_ / "image.png";
    write_file(image, small_image());
    const auto with = [&](unsigned threads) {
        write_mesh(folder_ / "a.glb", mesh,
                   {.texture = texture, .materials = {{.color = image, .normal = image}}},
                   {.threads = threads});
        return read_file(folder_ / "a.glb", 1 << 24);
    };
    const std::string one = with(1);
    EXPECT_TRUE(one == with(2));
    EXPECT_TRUE(one == with(7));
}

TEST_F(MeshWriter, ReportsErrors) {
    const std::string start = "cannot write " + folder_.string() + "/";
    EXPECT_EQ(error_of("a.xyz", cuboid()),
              start + "a.xyz: a mesh file must have the extension .obj, .ply, .stl, .glb or .usda");
    EXPECT_EQ(error_of("a.off", cuboid()),
              start + "a.off: a mesh file must have the extension .obj, .ply, .stl, .glb or .usda");
    QuadMesh bad = cuboid();
    bad.positions[5].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(error_of("a.obj", bad), start + "a.obj: vertex 5 is not finite");
    bad = cuboid();
    bad.origin.z = std::numeric_limits<double>::infinity();
    EXPECT_EQ(error_of("a.obj", bad), start + "a.obj: the origin is not finite");
    EXPECT_THROW(write_mesh(folder_ / "no" / "a.obj", cuboid()), IoError);
}

}  // namespace
}  // namespace coppice
