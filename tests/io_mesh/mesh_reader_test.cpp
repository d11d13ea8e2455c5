#include "coppice/io_mesh/reader.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/system/file.h"
#include "errors.h"
#include "paths.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

namespace fs = std::filesystem;
using Faces = std::vector<std::vector<std::uint32_t>>;

Faces get_faces(const PolygonMesh& mesh) {
    Faces out;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
        out.emplace_back(mesh.face(f).begin(), mesh.face(f).end());
    return out;
}

template <class T>
void append(std::string& bytes, T value, bool big_endian = false) {
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (big_endian) std::reverse(raw.begin(), raw.end());
    bytes.append(raw.data(), raw.size());
}

std::string error_of(std::string_view bytes, MeshFormat format) {
    return test::error_of<Error>([&] { parse_mesh(bytes, format, "f"); });
}

/// Builds a GLB file from its JSON and its buffer.
std::string glb(std::string json, std::string buffer) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
    std::string out = "glTF";
    append(out, std::uint32_t{2});
    append(out, static_cast<std::uint32_t>(28 + json.size() + buffer.size()));
    append(out, static_cast<std::uint32_t>(json.size()));
    out += "JSON" + json;
    append(out, static_cast<std::uint32_t>(buffer.size()));
    return out + std::string("BIN\0", 4) + buffer;
}

/// One triangle (0 0 0), (1 0 0), (0 2 0) in glTF's own axes, under `nodes`.
std::string triangle_glb(const std::string& nodes, const std::string& more = "") {
    std::string buffer;
    for (const float c : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 2.f, 0.f}) append(buffer, c);
    for (const std::uint16_t v : {0, 1, 2}) append(buffer, v);
    return glb(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
                   R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
                   "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                                {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
                   "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
                   "buffers":[{"byteLength":42}])" +
                   more + "}",
               buffer);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
    return text;
}

std::string binary_stl(std::initializer_list<std::array<Vec3, 3>> triangles) {
    std::string out(80, 's');
    append(out, static_cast<std::uint32_t>(triangles.size()));
    for (const auto& t : triangles) {
        append(out, Vec3{});
        for (const Vec3 p : t) append(out, p);
        append(out, std::uint16_t{0});
    }
    return out;
}

std::string binary_ply(bool big) {
    std::string out =
        std::string("ply\nformat binary_") + (big ? "big" : "little") +
        "_endian 1.0\nelement vertex 3\nproperty uchar red\nproperty double x\nproperty double y\n"
        "property float z\nelement face 1\nproperty list uchar short vertex_index\nend_header\n";
    for (int i = 0; i < 3; ++i) {
        out += 'r';
        append(out, 1.0 * i, big);
        append(out, 0.5, big);
        append(out, 2.0f, big);
    }
    out += '\3';
    for (const std::int16_t v : {2, 0, 1}) append(out, v, big);
    return out;
}

const std::string kObj =
    "# a comment\r\nmtllib a.mtl\r\no tree\r\nv 0 0 0\r\nv 1 0 0 0.5 0.5 0.5\r\nv 1.5e0 +1 0\r\nvt 0 0\r\nvn "
    "0 0 1\r\n"
    "v 0 1 -0.25\r\nf 1/1/1 2//1 3/1 4\r\nl 1 2\r\nf -4 \\\r\n -3 -1\r\n";
const std::string kAsciiPly =
    "ply\nformat ascii 1.0\ncomment x\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 "
    "3\n";
const std::string kOff =
    "COFF\n# colours\n4 2 0\n0 0 0 9 9 9 255\n1 0 0 9 9 9 255\n1 1 0 9 9 9 255\n\n0 1 7 9 9 9 255\n"
    "3 0 1 2 0.5 0.5 0.5\n3 0 2 3\n";
const std::string kAsciiStl =
    "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n"
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\nvertex -0 1 0\nendloop\nendfacet\nendsolid "
    "s\n";

TEST(MeshReader, ReadsObj) {
    const PolygonMesh mesh = parse_mesh(kObj, MeshFormat::obj, "f");
    ASSERT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.positions[2], Vec3(1.5f, 1, 0));
    EXPECT_EQ(mesh.positions[3], Vec3(0, 1, -0.25f));
    EXPECT_EQ(get_faces(mesh), (Faces{{0, 1, 2, 3}, {0, 1, 3}}));
    EXPECT_EQ(mesh.origin, Vec3d());
}

TEST(MeshReader, ObjVerticesMayFollowTheFaces) {
    const auto mesh = parse_mesh("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", MeshFormat::obj, "f");
    EXPECT_EQ(get_faces(mesh), (Faces{{0, 1, 2}}));
}

TEST(MeshReader, ObjGroupsAreNamedByObjectGroupAndMaterial) {
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const auto plain = parse_mesh(vertices + "f 1 2 3\n", MeshFormat::obj, "f");
    EXPECT_TRUE(plain.group_names.empty());
    EXPECT_TRUE(plain.group.empty());
    const auto named = parse_mesh(
        vertices +
            "f 1 2 3\no tree\nusemtl dark bark\nf 1 2 3\nusemtl leaf\nf 1 2 3\nusemtl dark bark\nf 1 2 3\n",
        MeshFormat::obj, "f");
    EXPECT_EQ(named.group_names, (std::vector<std::string>{"", "tree", "tree/dark bark", "tree/leaf"}));
    EXPECT_EQ(named.group, (std::vector<std::uint32_t>{0, 2, 3, 2}));
}

TEST(MeshReader, ReadsTextureCoordinatesOfObj) {
    const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const auto texture_of = [&](const std::string& text) {
        return parse_mesh(three + text, MeshFormat::obj, "f").texture;
    };
    const TexturePoint a{0.25f, 2}, b{-1, 0.5f}, zero{};
    const std::string places = "vt 0.25 2\nvt -1 0.5 0\n";
    EXPECT_EQ(texture_of(places + "f 1/1 2/2 3/1\n"), (Buffer<TexturePoint>{a, b, a}));
    EXPECT_EQ(texture_of("f 1/1/1 2/2/1 3/1/1\n" + places), (Buffer<TexturePoint>{a, b, a}));
    EXPECT_EQ(texture_of(places + "f 1/-1 2/-2 3/-1\n"), (Buffer<TexturePoint>{b, a, b}));
    // Corners without coordinates have (0, 0) if others have some.
    EXPECT_EQ(texture_of(places + "f 1 2 3\nf 1//1 2/2 3\nf 1 2 3\n"),
              (Buffer<TexturePoint>{zero, zero, zero, zero, b, zero, zero, zero, zero}));
    EXPECT_EQ(texture_of("vt 7\nf 1/1 2 3\n"), (Buffer<TexturePoint>{{7, 0}, zero, zero}));
    EXPECT_TRUE(texture_of("f 1/1 2/9 3/1\n").empty());  // a file without vt
    EXPECT_TRUE(texture_of(places + "f 1 2 3\n").empty());
}

TEST(MeshReader, ReadsTextureCoordinatesOfPly) {
    for (const auto& [u, v] : {std::pair{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}}) {
        SCOPED_TRACE(u);
        const std::string text =
            std::string(
                "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
                "property float z\nproperty float ") +
            u + "\nproperty float " + v +
            "\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
            "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n1 0 0 2 0\n1 1 0 2 1\n3 0 1 2\n3 3 4 2\n";
        const PolygonMesh mesh = parse_mesh(text, MeshFormat::ply, "f");
        EXPECT_EQ(mesh.positions.size(), 4u);  // the second and the fourth are one vertex on a seam
        EXPECT_EQ(get_faces(mesh), (Faces{{0, 1, 2}, {1, 3, 2}}));
        EXPECT_EQ(mesh.texture, (Buffer<TexturePoint>{{0, 0}, {1, 0}, {0, 1}, {2, 0}, {2, 1}, {0, 1}}));
        EXPECT_EQ(error_of(replaced(text, "1 1 0 2 1", "1 1 0 nan 1"), MeshFormat::ply),
                  "f: the texture coordinates of vertex 4 are not finite or beyond 1e30");
        EXPECT_EQ(parse_mesh(replaced(text, "property float " + std::string(u), "property float w"),
                             MeshFormat::ply, "f")
                      .positions.size(),
                  5u);  // without texture coordinates vertices are not merged
    }
}

TEST(MeshReader, ReadsSecondTextureCoordinatesOfPly) {
    const std::string text =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float s\nproperty float t\nproperty float s1\nproperty float t1\nproperty float blend\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 0 0 5 6 0.5\n1 0 0 1 0 7 8 1.5\n0 1 0 0 1 9 9 0\n3 0 1 2\n";
    EXPECT_EQ(parse_mesh(text, MeshFormat::ply, "f").texture_blends,
              (Buffer<TextureBlend>{{{5, 6}, 0.5f}, {{7, 8}, 1}, {{9, 9}, 0}}));  // at most 1
    EXPECT_TRUE(
        parse_mesh(replaced(text, "property float blend", "property float other"), MeshFormat::ply, "f")
            .texture_blends.empty());
    EXPECT_EQ(error_of(replaced(text, "7 8 1.5", "7 8 nan"), MeshFormat::ply),
              "f: the weight of the second texture coordinates of vertex 1 is not finite");
}

TEST(MeshReader, TextureCoordinatesOfLaterElementsBelongToTheirVertices) {
    const std::string text =
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
        "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float s\n"
        "property float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0 3 4\n3 0 1 2\n";
    EXPECT_EQ(parse_mesh(text, MeshFormat::ply, "f").texture, (Buffer<TexturePoint>{{0, 0}, {0, 0}, {3, 4}}));
}

TEST(MeshReader, ObjErrorsReportTheLine) {
    const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const auto error = [](const std::string& text) { return error_of(text, MeshFormat::obj); };
    EXPECT_EQ(error(three + "f 1 2 9\n"), "f:4: a face refers to vertex 9, but the vertices are 1 to 3");
    EXPECT_EQ(error(three + "f 1 2 0\n"), "f:4: a face refers to vertex 0, but the vertices are 1 to 3");
    EXPECT_EQ(error(three + "f 1 2 -4\n"), "f:4: a face refers to vertex -4, but the vertices are 1 to 3");
    EXPECT_EQ(error(three + "f 1 2 99999999999\n"),
              "f:4: a face refers to vertex 99999999999, but the vertices are 1 to 3");
    EXPECT_EQ(error(three + "f 1 2 x\n"), "f:4: 'x' is not a corner of a face");
    EXPECT_EQ(error(three + "f 1 2\n"), "f:4: a face has 2 corners; it needs 3");
    EXPECT_EQ(error(three + "vt 0 0\nf 1/1 2/1 3/2\n"),
              "f:5: a face refers to texture coordinates 2, but those are 1 to 1");
    EXPECT_EQ(error(three + "vt 0 0\nf 1/1 2/1 3/-2\n"),
              "f:5: a face refers to texture coordinates -2, but those are 1 to 1");
    EXPECT_EQ(error(three + "vt 0 0\nf 1/1 2/1 3/0\n"),
              "f:5: a face refers to texture coordinates 0, but those are 1 to 1");
    EXPECT_EQ(error(three + "f 1/x 2 3\n"), "f:4: '1/x' is not a corner of a face");
    EXPECT_EQ(error(three + "vt\n"), "f:4: texture coordinates need at least one number");
    EXPECT_EQ(error(three + "vt 0 inf\n"), "f:4: a texture coordinate is not finite or beyond 1e30");
    EXPECT_EQ(error(three), "f: it contains no faces, so it is not a surface");
    EXPECT_EQ(error("v 0 0\n"), "f:1: a vertex needs three coordinates");
    EXPECT_EQ(error("v 0 1,5 0\n"), "f:1: '1,5' is not a number");
    EXPECT_EQ(error("v 0 nan 0\n"), "f:1: a coordinate is not finite or beyond 1e30");
    EXPECT_EQ(error("v 0 1e31 0\n"), "f:1: a coordinate is not finite or beyond 1e30");
    EXPECT_EQ(error("hello\n"), "f: no mesh was found; OBJ, PLY, OFF, STL and GLB are read");
}

TEST(MeshReader, ReadsPlyInAllEncodings) {
    EXPECT_EQ(get_faces(parse_mesh(kAsciiPly, MeshFormat::ply, "f")), (Faces{{0, 1, 2, 3}}));
    for (const bool big : {false, true}) {
        const PolygonMesh mesh = parse_mesh(binary_ply(big), MeshFormat::ply, "f");
        EXPECT_EQ(mesh.positions[2], Vec3(2, 0.5f, 2));
        EXPECT_EQ(get_faces(mesh), (Faces{{2, 0, 1}}));
    }
}

TEST(MeshReader, PlyErrorsReportTheFace) {
    const auto error = [](const char* from, const char* to) {
        return error_of(replaced(kAsciiPly, from, to), MeshFormat::ply);
    };
    EXPECT_EQ(error("4 0 1 2 3", "4 0 1 2 4"), "f: face 0 refers to vertex 4, but the vertices are 0 to 3");
    EXPECT_EQ(error("4 0 1 2 3", "4 0 1 2 -1"), "f: face 0 refers to vertex -1, but the vertices are 0 to 3");
    EXPECT_EQ(error("4 0 1 2 3", "4 0 1 2 nan"),
              "f: face 0 refers to vertex nan, but the vertices are 0 to 3");
    EXPECT_EQ(error("4 0 1 2 3", "2 0 1"), "f: face 0 has 2 corners; a face needs 3");
    EXPECT_EQ(error("1 1 0", "1 inf 0"), "f: vertex 2 is not finite or beyond 1e30");
    EXPECT_EQ(error("float z", "float w"), "f: the vertices lack a property x, y or z");
    EXPECT_EQ(error("vertex_indices", "corners"), "f: the faces lack a list vertex_indices");
    EXPECT_EQ(error("element face 1", "element face 0"), "f: it contains no faces, so it is not a surface");
    EXPECT_NE(error("face 1", "face 4000000000").find("the file is too short for them"), std::string::npos);
    EXPECT_EQ(error_of("hello", MeshFormat::ply), "f: not a PLY file: it does not start with 'ply'");
}

TEST(MeshReader, RejectsPlyCoordinatesAsLists) {
    EXPECT_EQ(
        error_of(replaced(kAsciiPly, "property float y", "property list uchar float y"), MeshFormat::ply),
        "f: the coordinates of the vertices are lists");
}

TEST(MeshReader, ReadsOffWithColoursAndComments) {
    const PolygonMesh mesh = parse_mesh(kOff, MeshFormat::off, "f");
    EXPECT_EQ(mesh.positions[3], Vec3(0, 1, 7));
    EXPECT_EQ(get_faces(mesh), (Faces{{0, 1, 2}, {0, 2, 3}}));
    for (const char* head : {"OFF 3 1 0\n", "NOFF\n3 1 0\n", "3 1 0\n"}) {
        EXPECT_EQ(get_faces(parse_mesh(head + std::string("0 0 0 1 0 0\n1 0 0 1 0 0\n0 1 0 1 0 0\n3 2 1 0\n"),
                                       MeshFormat::off, "f")),
                  (Faces{{2, 1, 0}}));
    }
}

TEST(MeshReader, OffErrorsReportTheLine) {
    const auto error = [](const char* from, const char* to) {
        return error_of(replaced(kOff, from, to), MeshFormat::off);
    };
    EXPECT_EQ(error("3 0 2 3", "3 0 2 4"), "f:10: face 1 refers to vertex '4', but the vertices are 0 to 3");
    EXPECT_EQ(error("3 0 2 3", "3 0 2"), "f:10: the face has fewer than 3 corners");
    EXPECT_EQ(error("3 0 2 3", "2 0 2"), "f:10: a face must begin with its number of corners, at least 3");
    EXPECT_EQ(error("4 2 0", "4 3 0"), "f:10: the file ends after 2 of 3 faces; it is truncated");
    EXPECT_EQ(error("4 2 0", "4000000000 2 0"),
              "f:10: the file ends after 6 of 4000000000 vertices; it is truncated");
    EXPECT_EQ(error("4 2 0", "4 -2 0"), "f:3: expected the number of faces");
    EXPECT_EQ(error("0 1 7", "0 1 z"), "f:8: 'z' is not a number");
    EXPECT_NE(error("COFF", "4OFF").find("other than three dimensions"), std::string::npos);
    EXPECT_NE(error("COFF", "OFF BINARY").find("binary OFF is not read"), std::string::npos);
}

TEST(MeshReader, WeldsStl) {
    const auto text = parse_mesh(kAsciiStl, MeshFormat::stl, "f");
    EXPECT_EQ(text.positions.size(), 4u);
    EXPECT_EQ(get_faces(text), (Faces{{0, 1, 2}, {0, 2, 3}}));
    const auto binary = parse_mesh(
        binary_stl({{Vec3{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {Vec3{-0.f, 0, 0}, {1, 1, 0}, {0, 1, 0}}}),
        MeshFormat::stl, "f");
    EXPECT_EQ(get_faces(binary), get_faces(text));
    EXPECT_EQ(binary.positions[2], Vec3(1, 1, 0));
}

TEST(MeshReader, ReportsStlErrors) {
    const auto error = [](const char* from, const char* to) {
        return error_of(replaced(kAsciiStl, from, to), MeshFormat::stl);
    };
    EXPECT_EQ(error("vertex 1 0 0\n", ""), "f:6: a triangle has 2 corners");
    EXPECT_EQ(error("vertex 1 0 0\n", "vertex 1 0\n"), "f:5: a vertex needs three coordinates");
    EXPECT_EQ(error("endsolid s\n", ""), "f:15: the file ends before 'endsolid'; it is truncated");
    std::string cut = binary_stl({{Vec3{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}});
    cut.pop_back();
    EXPECT_EQ(error_of(cut, MeshFormat::stl),
              "f: the header specifies 1 triangles, but the file is too short for them; it is truncated");
}

TEST(MeshReader, GlbIsConvertedToZUp) {
    const auto mesh = parse_mesh(triangle_glb(R"([{"mesh":0}])"), MeshFormat::glb, "f");
    EXPECT_EQ(mesh.positions[1], Vec3(1, 0, 0));
    EXPECT_EQ(mesh.positions[2], Vec3(0, 0, 2));  // Y up became Z up
    EXPECT_EQ(get_faces(mesh), (Faces{{0, 1, 2}}));
}

TEST(MeshReader, GlbGroupsAreNamedByMeshAndMaterial) {
    EXPECT_TRUE(parse_mesh(triangle_glb(R"([{"mesh":0}])"), MeshFormat::glb, "f").group_names.empty());
    // The last of two entries with the same name is used.
    const std::string named = triangle_glb(
        R"([{"mesh":0}])",
        R"(,"meshes":[{"name":"tree","primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
           "materials":[{"name":"bark"}])");
    const auto mesh = parse_mesh(named, MeshFormat::glb, "f");
    EXPECT_EQ(mesh.group_names, (std::vector<std::string>{"tree/bark"}));
    EXPECT_EQ(mesh.group, (std::vector<std::uint32_t>{0}));
}

TEST(MeshReader, GlbTransformsAreApplied) {
    // The child rotates by 90 degrees about glTF's Z (x to y) and scales by three; the parent translates by
    // 10 along glTF's X.
    const auto mesh = parse_mesh(triangle_glb(R"([{"translation":[10,0,0],"children":[1]},
        {"mesh":0,"rotation":[0,0,0.70710678118654752,0.70710678118654752],"scale":[3,3,3]}])"),
                                 MeshFormat::glb, "f");
    const auto expect_near = [&](Vec3 p, Vec3 q) { EXPECT_LT(distance(p, q), 1e-6f); };
    expect_near(mesh.positions[0], {10, 0, 0});
    expect_near(mesh.positions[1], {10, 0, 3});
    expect_near(mesh.positions[2], {4, 0, 0});
    const auto same = parse_mesh(triangle_glb(R"([{"mesh":0,"matrix":[0,3,0,0,-3,0,0,0,0,0,3,0,10,0,0,1]}])"),
                                 MeshFormat::glb, "f");
    for (std::size_t v = 0; v < 3; ++v) expect_near(same.positions[v], mesh.positions[v]);
}

TEST(MeshReader, GlbMirrorsPreserveTheOutside) {
    const auto mesh = parse_mesh(triangle_glb(R"([{"mesh":0,"scale":[-1,1,1]}])"), MeshFormat::glb, "f");
    EXPECT_EQ(get_faces(mesh), (Faces{{0, 2, 1}}));
}

/// The triangle with texture coordinates as normalized bytes: (0, 0), (1, 0), (0, 1), with v down.
std::string textured_glb(const std::string& count = "3") {
    std::string buffer;
    for (const float c : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 2.f, 0.f}) append(buffer, c);
    for (const int c : {0, 0, 255, 0, 0, 255}) append(buffer, static_cast<std::uint8_t>(c));
    return glb(R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                     {"bufferView":1,"componentType":5121,"normalized":true,"type":"VEC2","count":)" +
                   count + R"(}],
        "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
        "buffers":[{"byteLength":42}]})",
               buffer);
}

TEST(MeshReader, ReadsTextureCoordinatesOfGlb) {
    const PolygonMesh mesh = parse_mesh(textured_glb(), MeshFormat::glb, "f");
    EXPECT_EQ(mesh.texture, (Buffer<TexturePoint>{{0, 1}, {1, 1}, {0, 0}}));  // v up
    EXPECT_EQ(error_of(textured_glb("2"), MeshFormat::glb),
              "f: mesh 0 has 2 texture coordinates for 3 vertices");
    EXPECT_EQ(error_of(textured_glb("4"), MeshFormat::glb), "f: accessor 1 extends beyond its buffer");
}

// Two nodes with a mesh each: the vertices of the first, which has no attribute, have no value.
TEST(MeshReader, ReadsAttributesOfGlb) {
    std::string buffer;
    for (const float c : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 2.f, 0.f}) append(buffer, c);
    for (const float c : {4.f, 5.f, 6.f}) append(buffer, c);
    const auto file_with = [&](const std::string& count) {
        return glb(R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0},{"mesh":1}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]},
                      {"primitives":[{"attributes":{"POSITION":0,"_ORDER":1}}]}],
            "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                         {"bufferView":1,"componentType":5126,"type":"SCALAR","count":)" +
                       count + R"(}],
            "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":12}],
            "buffers":[{"byteLength":48}]})",
                   buffer);
    };
    const std::vector<std::string> names{"order", "radius"};
    const MeshFile file = parse_mesh_file(file_with("3"), MeshFormat::glb, "f", names);
    ASSERT_EQ(file.attributes.size(), 1u);
    const Buffer<float>& values = file.attributes[0].values;
    ASSERT_EQ(values.size(), 6u);
    for (std::size_t v = 0; v < 3; ++v) EXPECT_TRUE(std::isnan(values[v]));
    EXPECT_EQ(Buffer<float>(values.begin() + 3, values.end()), (Buffer<float>{4, 5, 6}));
    try {
        parse_mesh_file(file_with("2"), MeshFormat::glb, "f", names);
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_STREQ(error.what(), "f: mesh 1 has 2 values of an attribute for 3 vertices");
    }
}

TEST(MeshReader, ReportsGlbErrors) {
    const std::string good = triangle_glb(R"([{"mesh":0}])");
    const auto with_nodes = [](const char* nodes) { return error_of(triangle_glb(nodes), MeshFormat::glb); };
    EXPECT_EQ(with_nodes(R"([{"children":[0]}])"), "f: node 0 has two parents or is its own ancestor");
    EXPECT_EQ(with_nodes(R"([{"children":[1,1]},{}])"), "f: node 1 has two parents or is its own ancestor");
    EXPECT_EQ(with_nodes(R"([{"children":[7]}])"), "f: 'nodes' has no entry 7");
    EXPECT_EQ(with_nodes(R"([{"mesh":3}])"), "f: 'meshes' has no entry 3");
    EXPECT_EQ(with_nodes(R"([{"mesh":-1}])"), "f: 'mesh' is not an unsigned 32-bit integer");
    EXPECT_EQ(with_nodes(R"([{"mesh":0,"scale":[1,2]}])"), "f: 'scale' does not have 3 numbers");
    EXPECT_EQ(with_nodes(R"([{"mesh":0,"scale":[1e300,1e300,1]}])"),
              "f: vertex 1 is not finite or beyond 1e30");
    EXPECT_EQ(with_nodes("[{}]"), "f: it contains no faces, so it is not a surface");
    EXPECT_EQ(with_nodes("[{]"), "f: its JSON chunk is damaged");
    const auto changed = [&](const std::string& from, const std::string& to) {
        return error_of(replaced(good, from, to), MeshFormat::glb);
    };
    EXPECT_EQ(changed(R"(5126,"count":3)", R"(5126,"count":4)"), "f: accessor 0 extends beyond its buffer");
    EXPECT_EQ(changed(R"("byteLength":6)", R"("byteLength":9)"), "f: buffer view 1 extends beyond the file");
    EXPECT_EQ(changed("5123", "5124"), "f: accessor 1 has an unknown component type");
    EXPECT_EQ(changed(R"("SCALAR")", R"("VECTOR")"), "f: accessor 1 is not SCALAR");
    EXPECT_EQ(changed(R"(5123,"count":3)", R"(5123,"count":2)"),
              "f: mesh 0 has 2 corners, which is not a multiple of 3");
    std::string bad_index = good;
    bad_index[bad_index.size() - 4] = 9;
    EXPECT_EQ(error_of(bad_index, MeshFormat::glb), "f: triangle 0 of mesh 0 refers to vertex 9 of 3");
    const auto unsupported = [&](const std::string& more) {
        return error_of(triangle_glb(R"([{"mesh":0}])", more), MeshFormat::glb);
    };
    EXPECT_NE(
        unsupported(R"(,"extensionsRequired":["KHR_draco_mesh_compression"])").find("without compression"),
        std::string::npos);
    EXPECT_NE(error_of(replaced(good, R"("buffers":[{)", R"("buffers":[{"uri":"a.bin",)"), MeshFormat::glb)
                  .find("damaged"),
              std::string::npos);
}

TEST(MeshReader, RejectsGlbBuffersInOtherFiles) {
    const auto file = glb(R"({"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"uri":"a.bin","byteLength":36}]})",
                          "");
    EXPECT_NE(error_of(file, MeshFormat::glb).find("stores data in other files"), std::string::npos);
}

TEST(MeshReader, GlbEmptyAccessorsMayHaveAnyOffset) {
    const auto file = glb(R"({"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"byteOffset":4,"componentType":5126,"count":0,"type":"VEC3"}],
        "bufferViews":[{"byteLength":0}],"buffers":[{"byteLength":0}]})",
                          "");
    EXPECT_EQ(error_of(file, MeshFormat::glb), "f: it contains no faces, so it is not a surface");
}

TEST(MeshReader, LargeCoordinatesPreserveTheirDigits) {
    const auto mesh =
        parse_mesh("v 500000.125 5200000.0625 300\nv 500001.375 5200000 300\nv 500000 5200001 301\nf 1 2 3\n",
                   MeshFormat::obj, "f");
    EXPECT_EQ(mesh.origin + Vec3d(mesh.positions[0]), Vec3d(500000.125, 5200000.0625, 300));
    EXPECT_EQ(mesh.origin + Vec3d(mesh.positions[1]), Vec3d(500001.375, 5200000, 300));
    EXPECT_LT(length(mesh.positions[2]), 8.f);
}

/// Every prefix of a file is read as a mesh or refused with one of our errors.
TEST(MeshReader, TruncatedFilesAreReadOrRejected) {
    const std::vector<std::pair<std::string, MeshFormat>> files{
        {kObj, MeshFormat::obj},
        {kAsciiPly, MeshFormat::ply},
        {binary_ply(true), MeshFormat::ply},
        {kOff, MeshFormat::off},
        {kAsciiStl, MeshFormat::stl},
        {binary_stl({{Vec3{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {Vec3{0, 0, 0}, {1, 1, 0}, {0, 1, 0}}}),
         MeshFormat::stl},
        {triangle_glb(R"([{"mesh":0}])"), MeshFormat::glb}};
    for (const auto& [file, format] : files) {
        EXPECT_NO_THROW(parse_mesh(file, format, "f"));
        const bool is_binary = file.find('\0') != std::string::npos;
        for (std::size_t size = 0; size < file.size(); ++size) {
            const std::string cut(file, 0, size);  // a copy, so that sanitizers detect reads beyond the end
            // GLB is padded with two zeros; the header reveals that they are missing. A prefix of text may be
            // a smaller complete mesh.
            if (is_binary) {
                EXPECT_NE(error_of(cut, format), "no error") << size;
            } else if (error_of(cut, format) == "no error") {
                const PolygonMesh mesh = parse_mesh(cut, format, "f");
                EXPECT_GT(mesh.face_count(), 0u) << size;
                for (const std::uint32_t v : mesh.corners) EXPECT_LT(v, mesh.positions.size()) << size;
            }
        }
    }
}

class ReadMeshFile : public test::FolderTest {
  protected:
    fs::path put(const std::string& name, std::string_view bytes) const {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return folder_ / name;
    }
    std::string error_of_file(const std::string& name, std::string_view bytes) const {
        const fs::path path = put(name, bytes);
        const std::string text = test::error_of<Error>([&] { read_mesh(path); });
        EXPECT_TRUE(text.starts_with(path.string() + ":")) << text;
        return text.substr(std::min(text.size(), path.string().size()));
    }
};

TEST_F(ReadMeshFile, ContentTakesPrecedenceOverTheName) {
    EXPECT_EQ(read_mesh(put("a.obj", kOff)).face_count(), 2u);
    EXPECT_EQ(read_mesh(put("a.ply", triangle_glb(R"([{"mesh":0}])"))).face_count(), 1u);
    EXPECT_EQ(read_mesh(put("a.txt", kObj)).face_count(), 2u);
    EXPECT_EQ(read_mesh(put("a.OFF", "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")).face_count(), 1u);
}

TEST_F(ReadMeshFile, ReportsOtherFormats) {
    EXPECT_EQ(error_of_file("a.obj", ""), ": the file is empty");
    EXPECT_EQ(error_of_file("a.fbx", "Kaydara FBX Binary  "),
              ": FBX is not read; export the mesh as GLB, PLY or OBJ");
    EXPECT_NE(error_of_file("a.gltf", "{\"asset\":{}}").find("JSON"), std::string::npos);
    EXPECT_NE(error_of_file("a.3mf", "PK\x03\x04....").find("ZIP"), std::string::npos);
    EXPECT_NE(error_of_file("a.usda", "#usda 1.0\n").find("USD is written only"), std::string::npos);
    EXPECT_NE(error_of_file("a.swc", "1 1 0 0 0 1 -1\n").find("no mesh was found"), std::string::npos);
    EXPECT_THROW(read_mesh("/nowhere/a.obj"), IoError);
    EXPECT_THROW(read_mesh(fs::path(testing::TempDir())), IoError);
}

/// Numbers of faces and welded vertices as counted by the collectors of the files (see data/README.md there).
TEST(MeshReader, ReadsRealFiles) {
    const fs::path data = source_dir().parent_path() / "shared" / "data";
    if (!fs::exists(data)) GTEST_SKIP() << "the collection of real files is not here";
    const std::map<std::string, std::array<std::size_t, 2>> expected{
        {"cgal_retinal.off", {3643, 7282}},
        {"eztree_ash_small.obj", {3706, 5616}},
        {"eztree_oak_medium.obj", {2780, 3166}},
        {"eztree_aspen_medium_leaves.obj", {7600, 7200}},
        {"kaykit_tree_single_B.obj", {112, 120}},
        {"kenney_grass-trees.glb", {232, 380}},
        {"modulartree_small.obj", {1330, 1264}},
        {"navis_1734350788.ply", {17369, 35106}},
        {"navis_722817260.ply", {17875, 36127}},
        {"quaternius_BirchTree_Dead_1.glb", {1680, 820}},
        {"quaternius_CommonTree_Dead_1.glb", {4720, 2360}},
        {"quaternius_CommonTree_Dead_3.glb", {1888, 944}},
        {"quaternius_PalmTree_1.glb", {3600, 1772}},
        {"quaternius_Willow_2.glb", {5500, 2752}},
        {"shapespark_tree_1.obj", {590, 646}},
        {"cgal_blobby_3cc.off", {1820, 3417}},
        {"cgal_dino.off", {3916, 7828}},
        {"cgal_elephant.off", {2775, 5558}},
        {"cgal_knot1.off", {3200, 6400}},
        {"gel_bunny-1hole.obj", {349, 693}},
        {"geometry-central_spot.ply", {2930, 5856}},
        {"pmp_bunny.off", {34835, 69666}},
        {"potpourri3d_bunny_small.ply", {1241, 2478}}};
    std::size_t counted = 0;
    for (const char* folder : {"tree_mesh", "closed_mesh"}) {
        for (const auto& entry : fs::directory_iterator(data / folder)) {
            SCOPED_TRACE(entry.path().filename().string());
            const PolygonMesh mesh = read_mesh(entry.path());
            EXPECT_GT(mesh.face_count(), 0u);
            const auto known = expected.find(entry.path().filename().string());
            if (known == expected.end()) continue;
            EXPECT_EQ(mesh.positions.size(), known->second[0]);
            EXPECT_EQ(mesh.face_count(), known->second[1]);
            ++counted;
        }
    }
    EXPECT_EQ(counted, expected.size());
}

}  // namespace
}  // namespace coppice
