#include "coppice/io_skeleton/parsers_internal.h"

#include <matio.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/io/text.h"
#include "coppice/system/file.h"
#include "io_skeleton/two_cylinders.h"
#include "skeleton/text.h"

namespace coppice {
namespace {

using test::error_of;
using test::to_bytes;

TEST(Text, ParsesNumbersInAllNotations) {
    EXPECT_EQ(parse_number("1.0000e+000"), 1.0);
    EXPECT_EQ(parse_number("-1."), -1.0);
    EXPECT_EQ(parse_number("+.5"), 0.5);
    EXPECT_EQ(parse_number("1e400"), std::numeric_limits<double>::infinity());
    EXPECT_EQ(parse_number("-1e400"), -std::numeric_limits<double>::infinity());
    EXPECT_EQ(parse_number("1e-400"), 0.0);
    for (const char* bad : {"", "+", "-", ".", "1,5", "0x10", "1 ", "+-1", "1e", "abc"})
        EXPECT_FALSE(parse_number(bad)) << bad;
    EXPECT_EQ(parse_integer("-1."), -1);
    EXPECT_EQ(parse_integer("1.2e+001"), 12);
    for (const char* bad : {"1.5", "1e300", "nan", "9223372036854775807", "99999999999999999999", "x"}) {
        EXPECT_FALSE(parse_integer(bad)) << bad;
    }
}

TEST(Text, ReadsLinesOfAllSystems) {
    LineReader lines(
        "\xEF\xBB\xBF"
        "a\r\nb\n\rc");
    std::vector<std::string> all;
    while (lines.next()) all.emplace_back(lines.line());
    EXPECT_EQ(all, (std::vector<std::string>{"a", "b", "", "c"}));
    EXPECT_EQ(lines.number(), 4u);
}

TEST(Text, SplitsQuotedCells) {
    std::vector<std::string_view> cells;
    split_at(" a ,\"b, c\",, \"d\" ,", ',', cells);
    EXPECT_EQ(cells, (std::vector<std::string_view>{"a", "b, c", "", "d"}));
    split_at("\"open,x", ',', cells);
    EXPECT_EQ(cells, (std::vector<std::string_view>{"\"open", "x"}));
}

TEST(Raycloud, ReadsSeveralTreesWithAttributes) {
    const auto nodes = parse_raycloud(
        "# Tree file\nheight,crown, x,y,z,radius,parent_id,section\n"
        "7,2, 0,0,0,9,-1,0, 0,0,1,0.5,0,0, 1,0,2,0.25,1,0\n8,3, 5,0,0,0.75,-1,0\n",
        "t.txt");
    ASSERT_EQ(nodes.size(), 4u);
    EXPECT_EQ(nodes[0].parent, -1);
    EXPECT_EQ(nodes[0].radius, 0.5) << "the radius of the base is that of its child";
    EXPECT_EQ(nodes[2].parent, nodes[1].id);
    EXPECT_EQ(nodes[2].position, Vec3d(1, 0, 2));
    EXPECT_EQ(nodes[3].parent, -1);
    EXPECT_EQ(nodes[3].radius, 0.75);
    EXPECT_EQ(nodes[3].line, 4u);
}

TEST(Raycloud, ReportsErrors) {
    const auto error = [](const std::string& text) {
        return error_of<InvalidInput>([&] { parse_raycloud(text, "t.txt"); });
    };
    EXPECT_EQ(error("x,y,z\n"),
              "t.txt:1: expected a header with 'x,y,z,radius', as written by raycloudtools");
    const std::string head = "x,y,z,radius,parent_id\n";
    EXPECT_EQ(error(head + "0,0,0,1,-1, 0,0,1\n"),
              "t.txt:2: 8 values do not form a tree: expected 0 and then 5 for each segment");
    EXPECT_EQ(error(head + "0,0,0,1,-1, 0,0,1,x,0\n"),
              "t.txt:2: 'x' is not a number; it should be the radius of segment 1");
    EXPECT_EQ(
        error(head + "0,0,0,1,-1, 0,0,1,1,2\n"),
        "t.txt:2: '2' is not the number of a segment of this tree; it should be the parent of segment 1");
    EXPECT_EQ(error("x,y,z,radius\n0,0,0,1, 0,0,1,1\n"),
              "t.txt:2: a tree with several segments needs a column parent_id in the header");
}

std::vector<std::int64_t> find_parents(const Forest& forest) {
    std::vector<std::int64_t> parents;
    for (const RawNode& node : forest.nodes) parents.push_back(node.parent);
    return parents;
}

TEST(EdgeGraph, RootIsTheLowestEndAndLoopsAreCut) {
    // A square 1-2-3-4 on a stem 0-1, and an isolated node.
    EdgeGraph graph;
    graph.position = {{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 2}, {0, 0, 2}, {9, 9, 9}};
    graph.edges = {{1, 0}, {1, 2}, {3, 2}, {3, 4}, {4, 1}, {1, 4}, {2, 2}};
    const Forest forest = make_forest(graph, "t");
    EXPECT_EQ(find_parents(forest), (std::vector<std::int64_t>{-1, 0, 1, 2, 1, -1}));
    EXPECT_EQ(forest.loops_cut, 1u);
    graph.drop_isolated = true;
    EXPECT_EQ(make_forest(graph, "t").nodes.size(), 5u);
}

TEST(EdgeGraph, RootIsTheThickestEnd) {
    EdgeGraph graph;
    graph.position = {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}};
    graph.edges = {{0, 1}, {1, 2}};
    graph.radius = {0.1, 5, 0.2};
    EXPECT_EQ(find_parents(make_forest(graph, "t")), (std::vector<std::int64_t>{1, 2, -1}));
    graph.directed = true;
    EXPECT_EQ(find_parents(make_forest(graph, "t")), (std::vector<std::int64_t>{-1, 0, 1}));
    graph.edges = {{0, 1}, {2, 1}};  // two parents: not a forest, so directions are ignored
    EXPECT_EQ(find_parents(make_forest(graph, "t")), (std::vector<std::int64_t>{1, 2, -1}));
    graph.edges = {{0, 1}, {1, 2}, {2, 0}};  // in a cycle each node has one parent, but there is no root
    EXPECT_EQ(make_forest(graph, "t").loops_cut, 1u);
}

TEST(EdgeGraph, RejectsNonFinitePositions) {
    EdgeGraph graph;
    graph.position = {{0, 0, 0}, {0, std::nan(""), 1}};
    EXPECT_EQ(error_of<InvalidInput>([&] { make_forest(graph, "t"); }),
              "t: the position of vertex 2 is not finite");
}

TEST(Gel, ReadsNodesAndConnections) {
    const Forest forest =
        make_forest(parse_gel("n 0 0 1\nn 0 0 0\nn 0 1 1.5\nc 0 1\nc 2 0\n", "t.graph"), "t.graph");
    EXPECT_EQ(find_parents(forest), (std::vector<std::int64_t>{1, -1, 0}));
    const auto error = [](const std::string& text) {
        return error_of<InvalidInput>([&] { parse_gel(text, "t.graph"); });
    };
    EXPECT_EQ(error("n 0 0 0\nc 0 1\n"), "t.graph:2: there is no vertex 1; the file has 1");
    EXPECT_EQ(error("n 0 0 0\nc 0\n"), "t.graph:2: a connection needs the numbers of two nodes");
    EXPECT_EQ(error("n 0 0\n"), "t.graph:1: a position needs three numbers");
    EXPECT_EQ(error("n 0 0 q\n"), "t.graph:1: 'q' is not a number; it should be a coordinate");
    EXPECT_EQ(error("x 0 0\n"), "t.graph:1: a line of a GEL graph must begin with 'n' or 'c', not with 'x'");
}

TEST(ObjLines, ReadsPolylinesWithAllKindsOfIndices) {
    const EdgeGraph graph =
        parse_obj_lines("o tree\nv 0 0 0\nv 0 0 1 1.0\nv 0 0 2\nl 1 2/7 -1\nv 5 5 5\n", "t.obj");
    EXPECT_EQ(graph.edges, (std::vector<std::array<std::uint32_t, 2>>{{0, 1}, {1, 2}}));
    EXPECT_TRUE(graph.radius.empty());
    EXPECT_EQ(make_forest(graph, "t.obj").nodes.size(), 3u) << "vertices that no line names do not count";
    const auto error = [](const std::string& text) {
        return error_of<InvalidInput>([&] { parse_obj_lines(text, "t.obj"); });
    };
    EXPECT_EQ(error("v 0 0 0\nf 1 1 1\n"),
              "t.obj: there are no line elements ('l'), so this is not a skeleton but a mesh");
    EXPECT_EQ(error("v 0 0 0\nl 1 2\n"), "t.obj:2: there is no vertex 2; the file has 1");
    EXPECT_EQ(error("v 0 0 0\nl 0 1\n"), "t.obj:2: '0' is not the number of a vertex");
    EXPECT_EQ(error("v 0 0 0\nl -2 1\n"), "t.obj:2: there is no vertex 0; the file has 1");
}

TEST(EdgePly, WeldsThePolylinesOfAdTree) {
    std::string file =
        "ply\nformat binary_little_endian 1.0\nelement vertex 5\nproperty float x\nproperty float "
        "y\nproperty float z\n"
        "property float radius\nelement edge 3\nproperty list uint int vertex_indices\nend_header\n";
    // A trunk of three vertices, and a branch of two that starts with a copy of the trunk's second one.
    for (const float v : {0.f, 0.f,  0.f, 1.f, 0.f, 0.f,   1.f, .5f, 0.f, 0.f,
                          2.f, .25f, 0.f, 0.f, 1.f, .125f, 1.f, 0.f, 2.f, .0625f}) {
        file += to_bytes(v);
    }
    for (const std::uint32_t v : {2u, 0u, 1u, 2u, 1u, 2u, 2u, 3u, 4u}) file += to_bytes(v);
    const Forest forest = make_forest(parse_edge_ply(file, "t.ply"), "t.ply");
    EXPECT_EQ(find_parents(forest), (std::vector<std::int64_t>{-1, 0, 1, 1}));
    EXPECT_EQ(forest.nodes[1].radius, 0.5);
    EXPECT_EQ(forest.nodes[3].id, 4);
    for (std::size_t size = 0; size < file.size(); ++size) {
        EXPECT_THROW(parse_edge_ply(file.substr(0, size), "t.ply"), InvalidInput) << size;
    }
}

TEST(EdgePly, ReadsAsciiWithTwoVertexProperties) {
    const std::string head =
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\n";
    const EdgeGraph graph = parse_edge_ply(
        head + "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n0 0 0\n0 0 1\n1 0\n",
        "t.ply");
    EXPECT_EQ(graph.edges, (std::vector<std::array<std::uint32_t, 2>>{{1, 0}}));
    EXPECT_FALSE(graph.directed) << "without radii nothing says that edges run upwards";
    const auto error = [&](const std::string& rest) {
        return error_of<InvalidInput>([&] { parse_edge_ply(head + rest, "t.ply"); });
    };
    EXPECT_EQ(error("end_header\n0 0 0\n0 0 1\n"),
              "t.ply: the PLY file has no element 'edge', so it contains a mesh or points, not a skeleton");
    EXPECT_EQ(error("element edge 1\nproperty int a\nend_header\n0 0 0\n0 0 1\n1 0\n"),
              "t.ply: the edges have neither a list 'vertex_indices' nor 'vertex1' and 'vertex2'");
    EXPECT_EQ(
        error("element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n0 0 0\n0 0 1\n1 2\n"),
        "t.ply: an edge refers to vertex 2, but there are only 2, numbered from 0");
    EXPECT_EQ(
        error("element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n0 0 0\n0 0 1\n1 -2\n"),
        "t.ply: an edge refers to vertex -2, which cannot exist");
}

TEST(SkeletonJson, ReadsColumnsInAnyOrderAmongOthers) {
    const auto [nodes, attributes, notes] = parse_skeleton_json(
        R"({"radius": [1, null], "sure": [0.5, null], "Loud": [1, 2], "words": ["a", 3], "notes": {"parent": [9, {"a": []}]}, "parent": [-1, 0],
            "position": [[0, 0, 0], [0, 0.5, 1]], "origin": [100, 0, 0], "format": "coppice-skeleton"})",
        "t.json");
    ASSERT_EQ(nodes.size(), 2u);
    EXPECT_EQ(nodes[1].parent, 0);
    EXPECT_EQ(nodes[1].position, Vec3d(100, 0.5, 1));
    EXPECT_TRUE(std::isnan(nodes[1].radius));
    ASSERT_EQ(attributes.size(), 2u);  // neither attributes with invalid names nor nested ones
    EXPECT_EQ(attributes[0].name, "sure");
    ASSERT_EQ(attributes[0].values.size(), 2u);
    EXPECT_EQ(attributes[0].values[0], 0.5);
    EXPECT_TRUE(std::isnan(attributes[0].values[1]));
    EXPECT_EQ(attributes[1].name, "words");
}

TEST(SkeletonJson, ReportsErrors) {
    const auto error = [](const std::string& text) {
        return error_of<InvalidInput>([&] { parse_skeleton_json(text, "t.json"); });
    };
    EXPECT_EQ(error("{\n\"format\": oops}"), "t.json:2: this is not valid JSON near '\"format\": o'");
    EXPECT_EQ(error("{}"), "t.json: this JSON is not a skeleton: it needs \"format\": \"coppice-skeleton\"");
    const std::string head = "{\"format\": \"coppice-skeleton\", ";
    EXPECT_EQ(error(head + "\"parent\": [-1], \"position\": [[0,0,0]]}"),
              "t.json: the columns differ in length: 1 parents, 1 positions, 0 radii");
    EXPECT_EQ(error(head + "\"position\": [[0,0]]}"), "t.json: position 0 must have three numbers");
    EXPECT_EQ(error(head + "\"parent\": [0.5]}"),
              "t.json: the parent of node 0 is 0.5; it must be an index, or -1 for none");
    EXPECT_EQ(error(head + "\"parent\": [1e300]}"),
              "t.json: the parent of node 0 is 1e+300; it must be an index, or -1 for none");
    EXPECT_EQ(error(std::string(1000000, '[')), "t.json: the JSON is nested too deeply");
    EXPECT_THROW(parse_skeleton_json(head + "\"version\": 2}", "t.json"), Unsupported);
}

/// A .mat file under construction, written with matio.
class MatWriter {
  public:
    explicit MatWriter(const std::string& name)
        : path_(std::filesystem::path(testing::TempDir()) / (name + ".mat")),
          file_(Mat_CreateVer(path_.c_str(), nullptr, MAT_FT_MAT5)) {}

    template <class T>
    static matvar_t* array(const char* name, matio_classes kind, matio_types type, std::size_t rows,
                           std::size_t columns, std::vector<T> values) {
        std::size_t dims[2]{rows, columns};
        return Mat_VarCreate(name, kind, type, 2, dims, values.data(), 0);
    }
    static matvar_t* doubles(const char* name, std::size_t rows, std::size_t columns,
                             std::vector<double> values) {
        return array(name, MAT_C_DOUBLE, MAT_T_DOUBLE, rows, columns, std::move(values));
    }

    /// Two cylinders as a struct of columns; `shift` moves them along x.
    static matvar_t* cylinder(const char* name, float shift) {
        const char* fields[]{"radius", "length", "start", "axis", "parent"};
        std::size_t dims[2]{1, 1};
        matvar_t* s = Mat_VarCreateStruct(name, 2, dims, fields, 5);
        const auto set = [&](const char* field, matvar_t* value) {
            Mat_VarSetStructFieldByName(s, field, 0, value);
        };
        set("radius", array<float>("radius", MAT_C_SINGLE, MAT_T_SINGLE, 2, 1, {0.5f, 0.25f}));
        set("length", array<float>("length", MAT_C_SINGLE, MAT_T_SINGLE, 2, 1, {2, 1}));
        set("start",
            array<float>("start", MAT_C_SINGLE, MAT_T_SINGLE, 2, 3, {1 + shift, 1 + shift, 2, 2, 3, 5}));
        set("axis", array<float>("axis", MAT_C_SINGLE, MAT_T_SINGLE, 2, 3, {0, 1, 0, 0, 1, 0}));
        set("parent", array<std::uint16_t>("parent", MAT_C_UINT16, MAT_T_UINT16, 2, 1, {0, 1}));
        return s;
    }

    void add(matvar_t* variable, matio_compression packing = MAT_COMPRESSION_ZLIB) {
        Mat_VarWrite(file_, variable, packing);
        Mat_VarFree(variable);
    }
    std::filesystem::path close() {
        Mat_Close(file_);
        return path_;
    }

  private:
    std::filesystem::path path_;
    mat_t* file_;
};

RawCylinders read_mat(const std::filesystem::path& path, int model) {
    return parse_mat(read_file(path), path.string(), model);
}

TEST(Mat, ReadsAStructOfColumns) {
    MatWriter writer("struct");
    std::size_t dims[2]{1, 1};
    const char* fields[]{"rundata", "cylinder"};
    matvar_t* qsm = Mat_VarCreateStruct("QSM", 2, dims, fields, 2);
    Mat_VarSetStructFieldByName(qsm, "rundata", 0, MatWriter::doubles("rundata", 1, 1, {3}));
    Mat_VarSetStructFieldByName(qsm, "cylinder", 0, MatWriter::cylinder("cylinder", 0));
    writer.add(qsm);
    const auto path = writer.close();
    expect_two_cylinders(read_mat(path, 0));
    expect_two_cylinders(read_mat(path, 1));
    EXPECT_EQ(error_of<InvalidInput>([&] { read_mat(path, 2); }),
              path.string() + ": there is no model 2; the file contains 1");
}

TEST(Mat, RequiresAChoiceAmongSeveralModels) {
    MatWriter writer("several");
    std::size_t dims[2]{1, 2};
    const char* fields[]{"cylinder"};
    matvar_t* qsm = Mat_VarCreateStruct("QSM", 2, dims, fields, 1);
    Mat_VarSetStructFieldByName(qsm, "cylinder", 0, MatWriter::cylinder("cylinder", 7));
    Mat_VarSetStructFieldByName(qsm, "cylinder", 1, MatWriter::cylinder("cylinder", 0));
    writer.add(qsm);
    matvar_t* cells = Mat_VarCreate("more", MAT_C_CELL, MAT_T_CELL, 2, dims, nullptr, 0);
    Mat_VarSetCell(cells, 0, MatWriter::cylinder("cylinder", 9));
    Mat_VarSetCell(cells, 1, MatWriter::doubles("x", 1, 1, {1}));
    writer.add(cells);
    const auto path = writer.close();
    EXPECT_EQ(error_of<InvalidInput>([&] { read_mat(path, 0); }),
              path.string() + ": it contains 3 models; choose one with the option model, 1 to 3");
    EXPECT_EQ(read_mat(path, 1).cylinders[0].start.x, 8);
    expect_two_cylinders(read_mat(path, 2));
    EXPECT_EQ(read_mat(path, 3).cylinders[0].start.x, 10);
}

TEST(Mat, ReadsVariablesOfTheOldLayout) {
    MatWriter writer("old");
    writer.add(MatWriter::doubles("Rad", 2, 1, {0.5, 0.25}), MAT_COMPRESSION_NONE);
    writer.add(MatWriter::doubles("Len", 2, 1, {2, 1}));
    writer.add(MatWriter::doubles("Sta", 2, 3, {1, 1, 2, 2, 3, 5}));
    writer.add(MatWriter::doubles("Axe", 2, 3, {0, 1, 0, 0, 1, 0}));
    writer.add(MatWriter::doubles("CPar", 2, 1, {0, 1}));
    expect_two_cylinders(read_mat(writer.close(), 0));
}

TEST(Mat, RejectsWrongShapesAndValues) {
    const auto error = [](const char* name, matvar_t* radius, matvar_t* start, std::vector<double> parent) {
        MatWriter writer(name);
        writer.add(radius);
        writer.add(start);
        writer.add(MatWriter::doubles("Len", 2, 1, {2, 1}));
        writer.add(MatWriter::doubles("Axe", 2, 3, {0, 1, 0, 0, 1, 0}));
        writer.add(MatWriter::doubles("CPar", 2, 1, std::move(parent)));
        const std::filesystem::path path = writer.close();
        const std::string text = error_of<InvalidInput>([&] { read_mat(path, 0); });
        return text.substr(path.string().size() + 2);
    };
    const auto radius = [] { return MatWriter::doubles("Rad", 2, 1, {1, 1}); };
    const auto start = [] { return MatWriter::doubles("Sta", 2, 3, {1, 1, 2, 2, 3, 5}); };
    EXPECT_EQ(error("w1", radius(), MatWriter::doubles("Sta", 3, 2, {1, 1, 2, 2, 3, 5}), {0, 1}),
              "there are 2 radii, but the column 'start' has another shape");
    std::size_t dims[2]{1, 1};
    matvar_t* cell = Mat_VarCreate("Rad", MAT_C_CELL, MAT_T_CELL, 2, dims, nullptr, 0);
    Mat_VarSetCell(cell, 0, radius());
    EXPECT_EQ(error("w2", cell, start(), {0, 1}),
              "the column 'radius' of the cylinders is not an array of numbers");
    EXPECT_EQ(error("w3", radius(), start(), {0, 3}), "the parent of cylinder 2 is 3; it should be 0 to 2");
    EXPECT_EQ(error("w4", radius(), start(), {0.5, 1}),
              "the parent of cylinder 1 is 0.5; it should be 0 to 2");
}

TEST(Mat, RejectsFilesWithoutCylindersAndDamagedFiles) {
    MatWriter writer("none");
    writer.add(MatWriter::doubles("Rad", 1, 1, {1}));
    const auto path = writer.close();
    EXPECT_NE(error_of<InvalidInput>([&] { read_mat(path, 0); }).find("it contains no cylinders"),
              std::string::npos);

    MatWriter toolbox("toolbox");
    std::size_t dims[2]{1, 1};
    const char* fields[]{"dA", "X", "Y", "Z", "D"};
    matvar_t* cells = Mat_VarCreate("trees", MAT_C_CELL, MAT_T_CELL, 2, dims, nullptr, 0);
    Mat_VarSetCell(cells, 0, Mat_VarCreateStruct("tree", 2, dims, fields, 5));
    toolbox.add(cells);
    const auto tree = toolbox.close();
    EXPECT_NE(error_of<Unsupported>([&] { read_mat(tree, 0); }).find("a tree of the TREES toolbox"),
              std::string::npos);

    const auto garbage = std::filesystem::path(testing::TempDir()) / "garbage.mat";
    std::ofstream(garbage) << "this is no MATLAB file at all";
    EXPECT_THROW(read_mat(garbage, 0), InvalidInput);

    MatWriter whole("whole");
    whole.add(MatWriter::cylinder("c", 0), MAT_COMPRESSION_NONE);
    const auto whole_path = whole.close();
    const auto size = std::filesystem::file_size(whole_path);
    for (std::uintmax_t cut = 0; cut + 8 < size; cut += 7) {
        std::filesystem::copy_file(whole_path, garbage, std::filesystem::copy_options::overwrite_existing);
        std::filesystem::resize_file(garbage, cut);
        EXPECT_THROW(read_mat(garbage, 0), InvalidInput) << cut;
    }
}

/// Builds a .mat file byte by byte, in the specified byte order.
class RawMat {
  public:
    explicit RawMat(bool big_endian) : big_endian_(big_endian) {
        bytes_ = std::string("MATLAB 5.0 MAT-file") + std::string(105, ' ') + number<std::uint16_t>(0x0100);
        bytes_ += big_endian ? "MI" : "IM";
    }

    template <class T>
    std::string number(T value) const {
        std::string bytes = to_bytes(value);
        if (big_endian_) std::reverse(bytes.begin(), bytes.end());
        return bytes;
    }
    std::string element(std::uint32_t type, const std::string& data) const {
        return number(type) + number(static_cast<std::uint32_t>(data.size())) + data +
               std::string((8 - data.size() % 8) % 8, '\0');
    }
    std::string make_head(std::uint32_t kind, std::int32_t rows, std::int32_t columns,
                          const char* name) const {
        return element(6, number(kind) + number(0u)) + element(5, number(rows) + number(columns)) +
               element(1, name);
    }
    std::string doubles(const char* name, std::int32_t rows, std::int32_t columns,
                        const std::vector<double>& values) const {
        std::string data;
        for (const double v : values) data += number(v);
        return element(14, make_head(6, rows, columns, name) + element(9, data));
    }
    std::string with(const std::string& variables) const { return bytes_ + variables; }

  private:
    bool big_endian_;
    std::string bytes_;
};

TEST(Mat, ReadsBothByteOrders) {
    for (const bool big_endian : {false, true}) {
        const RawMat mat(big_endian);
        expect_two_cylinders(parse_mat(
            mat.with(mat.doubles("Rad", 2, 1, {0.5, 0.25}) + mat.doubles("Len", 2, 1, {2, 1}) +
                     mat.doubles("Sta", 2, 3, {1, 1, 2, 2, 3, 5}) +
                     mat.doubles("Axe", 2, 3, {0, 1, 0, 0, 1, 0}) + mat.doubles("CPar", 2, 1, {0, 1})),
            "t.mat", 0));
    }
}

TEST(Mat, RejectsSizesBeyondTheFile) {
    const RawMat mat(false);
    const auto error = [&](const std::string& variable) {
        return error_of<InvalidInput>([&] { parse_mat(mat.with(variable), "t.mat", 0); });
    };
    const std::string damaged = "t.mat: the MATLAB file is truncated or damaged";
    // A struct of 2,000,000,000 x 4 elements with one field.
    EXPECT_EQ(error(mat.element(14, mat.make_head(2, 2000000000, 4, "QSM") + mat.element(5, mat.number(8u)) +
                                        mat.element(1, std::string("radius\0\0", 8)))),
              damaged);
    EXPECT_EQ(error(mat.element(14, mat.make_head(1, 3, 1, "cells"))), damaged);
    EXPECT_EQ(error(mat.element(14, mat.make_head(6, -1, 1, "x"))), damaged);
    EXPECT_EQ(error(mat.number(14u) + mat.number(1000u)), damaged);

    std::string nested = mat.element(14, mat.make_head(6, 0, 0, "x"));
    for (int depth = 0; depth < 20; ++depth) nested = mat.element(14, mat.make_head(1, 1, 1, "x") + nested);
    EXPECT_EQ(error(nested), "t.mat: structures are nested too deeply");

    // 80 MiB of zeros need 80 KiB when compressed.
    const std::string zeros(std::size_t{80} << 20, '\0');
    uLongf size = compressBound(zeros.size());
    std::string packed(size, '\0');
    ASSERT_EQ(compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                        reinterpret_cast<const Bytef*>(zeros.data()), zeros.size(), 9),
              Z_OK);
    packed.resize(size);
    EXPECT_EQ(error(mat.element(15, packed)),
              "t.mat: a variable decompresses to more data than is plausible for the size of the file");
}

}  // namespace
}  // namespace coppice
