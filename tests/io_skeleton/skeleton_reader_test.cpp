#include "coppice/io_skeleton/reader.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "described_options.h"
#include "skeleton/text.h"

namespace coppice {
namespace {

using test::error_of;

const std::string kSwc = "1 0 0 0 0 0.5 -1\n2 0 0 0 4 0.25 1\n";
const std::string kGel = "n 0 0 0\nn 0 0 4\nc 0 1\n";

TEST(SkeletonReader, RecognizesFormatsByContentIfTheNameDoesNot) {
    const auto format = [](const std::string& text, const std::string& name) {
        return parse_skeleton(text, name).format;
    };
    EXPECT_EQ(format(kSwc, "t.txt"), "swc");
    EXPECT_EQ(format("# c\n" + kGel, "t"), "gel");
    EXPECT_EQ(format("v 0 0 0\nv 0 0 1\nl 1 2\n", "t.txt"), "obj");
    EXPECT_EQ(format("x,y,z,radius,parent_id\n0,0,0,1,-1, 0,0,1,1,0\n", "t_trees.txt"), "raycloud");
    EXPECT_EQ(format("x,y,z,radius,parent_id\n0,0,0,1,-1, 0,0,1,1,0\n", "t.csv"), "raycloud");
    EXPECT_EQ(format("0.5\t2\t1\t2\t3\t0\t0\t1\t0\t0\n", "cylinder_1.txt"), "cylinders");
    EXPECT_EQ(format("parent radius startX startY startZ endX endY endZ\n0 1 0 0 0 0 0 3\n", "t.txt"),
              "cylinders");
    EXPECT_EQ(
        format("{\"format\":\"coppice-skeleton\",\"parent\":[-1],\"position\":[[0,0,0]],\"radius\":[1]}",
               "t"),
        "json");
    EXPECT_EQ(
        format(
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
            "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n0 0 0\n0 0 1\n0 1\n",
            "t.obj"),
        "ply");
    EXPECT_EQ(format(kSwc, "TREE.SWC"), "swc");
}

TEST(SkeletonReader, AttributesFollowReorderedNodes) {
    // Node 0 precedes its parent, and node 3 coincides with its parent.
    const SkeletonFile file = parse_skeleton(
        R"({"a": [10, 11, 12, 13], "b": [1, 2, 3], "c": [1, 1e99, 3, 4], "a": [0, 0, 0, 0], "d": [1, null, 1, 1],
            "format": "coppice-skeleton", "parent": [1, -1, 1, 2], "radius": [1, 1, 1, 1],
            "position": [[0, 0, 1], [0, 0, 0], [1, 0, 0], [1, 0, 0]]})",
        "t.json");
    ASSERT_EQ(file.skeleton.size(), 3u);
    ASSERT_EQ(file.attributes.size(), 1u) << "too few, too large, twice, or unknown";
    EXPECT_EQ(file.attributes[0].values, (std::vector<float>{11, 10, 12}));
}

TEST(SkeletonReader, ReadsStatedUnitsAndRecognizesNeurons) {
    const auto units = [](const std::string& text, const std::string& name,
                          ReadSkeletonOptions options = {}) {
        return name_of(parse_skeleton(text, name, options).units);
    };
    const std::string neuron = "1 1 0 0 0 5 -1\n2 3 0 0 190 1 1\n", tree = "1 5 0 0 0 5 -1\n2 5 0 0 9 1 1\n";
    EXPECT_EQ(units(tree, "t.swc"), "m");
    EXPECT_EQ(units(neuron, "t.swc"), "um");
    EXPECT_EQ(units("1 1 0 0 0 5 -1\n2 3 0 0 90 1 1\n", "t.swc"), "m") << "a tree with such types";
    EXPECT_EQ(units(neuron, "t.swc", {.scale = 1e-6f}), "m") << "metres were made";
    EXPECT_EQ(units(neuron, "t.swc", {.units = LengthUnit::mm}), "mm");
    EXPECT_EQ(units("# Meta: {\"id\": \"7\", \"units\": \"1 nanometer\"}\n" + neuron, "t.swc"), "nm");
    EXPECT_EQ(units("# Meta: {\"units\": \"8 nanometer\"}\n" + tree, "t.swc"), "m") << "8 of them are none";
    EXPECT_EQ(units("# written; units: Centimeters\n" + tree, "t.swc"), "cm");
    EXPECT_EQ(units("# subunits: mm\n# units: furlong\n" + tree, "t.swc"), "m");
    EXPECT_EQ(parse_skeleton(neuron, "t.swc").notes.size(), 1u) << "assumptions are reported";
}

TEST(SkeletonReader, RejectsUnknownFiles) {
    EXPECT_EQ(error_of<Unsupported>([] { parse_skeleton("1 2 3\n4 5 6\n", "cloud.txt"); }),
              "cloud.txt: neither its name nor its first line is that of a skeleton file; supported are SWC, "
              "cylinder tables, TreeQSM .mat, raycloudtools trees, edge PLY, GEL graphs, OBJ lines, RSML, "
              "MTG and JSON");
    EXPECT_THROW(parse_skeleton("", "empty"), Unsupported);
    EXPECT_THROW(parse_skeleton("", "empty.swc"), InvalidInput);
    EXPECT_THROW(parse_skeleton("MATLAB 5.0 MAT-file", "t"), InvalidInput);
    EXPECT_EQ(error_of<Unsupported>([] { parse_skeleton("MATLAB 7.3 MAT-file", "t"); }),
              "t: MATLAB files of version 7.3 are not read; save it again with '-v7'");
    EXPECT_THROW(read_skeleton("no/such/file.swc"), IoError);
}

TEST(SkeletonReader, UsesTheRequestedFormat) {
    EXPECT_EQ(parse_skeleton(kSwc, "t.obj", {.format = SkeletonFormat::swc}).skeleton.size(), 2u);
    EXPECT_THROW(parse_skeleton(kSwc, "t.swc", {.format = SkeletonFormat::gel}), InvalidInput);
}

TEST(SkeletonReader, ScalesPositionsAndRadiiExactly) {
    const Skeleton s = parse_skeleton(kSwc, "t.swc", {.scale = 0.001f}).skeleton;
    EXPECT_EQ(s.position(NodeId(1)).z, 0.004f);
    EXPECT_EQ(s.radius(NodeId(0)), 0.0005f);
    // 500,000.25 mm: with 0.001f instead of 0.001 the position would be 0.02 mm off.
    const Skeleton far =
        parse_skeleton("1 0 500000.25 0 0 1 -1\n2 0 500000.25 0 1 1 1\n", "t.swc", {.scale = 0.001f})
            .skeleton;
    EXPECT_NEAR(far.origin().x + far.position(NodeId(0)).x, 500.00025, 1e-7);
}

TEST(SkeletonReader, FilesWithoutRadiiHaveTheDefaultOrANote) {
    const SkeletonFile given = parse_skeleton(kGel, "t.graph", {.default_radius = 0.125f});
    EXPECT_EQ(given.skeleton.radius(NodeId(1)), 0.125f);
    EXPECT_TRUE(given.notes.empty());
    const SkeletonFile estimated = parse_skeleton(kGel, "t.graph");
    EXPECT_GT(estimated.skeleton.radius(NodeId(1)), 0.0f);
    ASSERT_EQ(estimated.notes.size(), 1u);
    EXPECT_EQ(estimated.notes[0],
              "the file has no radii: 1 % of its size was used; set default_radius for another radius");
    EXPECT_EQ(parse_skeleton(kSwc, "t.swc", {.default_radius = 0.125f}).skeleton.radius(NodeId(0)), 0.5f);
}

TEST(SkeletonReader, ReportsCutLoops) {
    const SkeletonFile file = parse_skeleton("n 0 0 0\nn 0 0 1\nn 0 1 1\nc 0 1\nc 1 2\nc 2 0\n", "t.graph",
                                             {.default_radius = 0.1f});
    ASSERT_EQ(file.notes.size(), 1u);
    EXPECT_EQ(file.notes[0], "1 edges that closed loops were omitted");
}

TEST(SkeletonReader, RejectsInvalidOptions) {
    EXPECT_THROW(parse_skeleton(kSwc, "t.swc", {.scale = 0}), InvalidInput);
    EXPECT_THROW(parse_skeleton(kSwc, "t.swc", {.model = -1}), InvalidInput);
    EXPECT_THROW(parse_skeleton(kSwc, "t.swc", {.model = 2}), InvalidInput);
    EXPECT_THROW(parse_skeleton(kSwc, "t.swc", {.default_radius = -1}), InvalidInput);
    EXPECT_NO_THROW(parse_skeleton(kSwc, "t.swc", {.model = 1}));
}

TEST(SkeletonReader, EveryOptionIsDescribedWithADefaultInRange) {
    test::expect_described<ReadSkeletonOptions>();
}

TEST(SkeletonReader, EveryParserRejectsBinaryGarbage) {
    std::string garbage;
    for (std::uint32_t i = 0; i < 4096; ++i) garbage += static_cast<char>((i * 2654435761u) >> 13);
    for (const SkeletonFormat format :
         {SkeletonFormat::swc, SkeletonFormat::cylinders, SkeletonFormat::raycloud, SkeletonFormat::ply,
          SkeletonFormat::gel, SkeletonFormat::obj, SkeletonFormat::json}) {
        EXPECT_THROW(parse_skeleton(garbage, "t", {.format = format}), InvalidInput) << name_of(format);
    }
}

TEST(SkeletonReader, ReadsFiles) {
    const auto path = std::filesystem::path(testing::TempDir()) / "reader_test.swc";
    std::ofstream(path) << kSwc;
    const SkeletonFile file = read_skeleton(path);
    EXPECT_EQ(file.skeleton.size(), 2u);
    EXPECT_EQ(file.report.total(), 0u);
    EXPECT_EQ(file.format, "swc");
}

}  // namespace
}  // namespace coppice
