#include "coppice/io_skeleton/writer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/io_skeleton/reader.h"
#include "paths.h"
#include "skeleton/text.h"

namespace coppice {
namespace {

using test::error_of;

/// Two trees: a fork with numbers without a short decimal form, and a single node.
Skeleton fork(Vec3d origin = {}) {
    return Skeleton({NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId::none()},
                    {{0.1f, 0.2f, 0}, {0.1f, 1.0f / 3, 1}, {0.5f, 0, 2e-7f}, {-0.5f, 0, 1.7f}, {7, 7, 7}},
                    {0.3f, 1.0f / 7, 0.1f, 0.05f, 0.75f}, origin);
}

void expect_equal(const Skeleton& a, const Skeleton& b) {
    ASSERT_EQ(a.size(), b.size());
    for (const NodeId n : nodes(a)) {
        EXPECT_EQ(a.parent(n), b.parent(n));
        EXPECT_EQ(a.position(n), b.position(n)) << n.index();
        EXPECT_EQ(a.radius(n), b.radius(n)) << n.index();
    }
}

const std::vector<WriteSkeletonOptions> kLossless{
    {SkeletonFormat::swc},        {SkeletonFormat::json}, {SkeletonFormat::obj}, {SkeletonFormat::ply, true},
    {SkeletonFormat::ply, false}, {SkeletonFormat::rsml}, {SkeletonFormat::mtg}};

TEST(SkeletonWriter, LosslessFormatsAreReadBackBitIdentically) {
    for (const WriteSkeletonOptions& options : kLossless) {
        SCOPED_TRACE(name_of(options.format));
        const SkeletonFile file =
            parse_skeleton(encode_skeleton(fork(), options), "t", {.format = options.format});
        expect_equal(file.skeleton, fork());
        EXPECT_EQ(file.report.total(), 0u);
        EXPECT_TRUE(file.notes.empty());
    }
}

TEST(SkeletonWriter, TreesWithAttributesAreReadBackBitIdentically) {
    using enum SkeletonFormat;
    for (const char* name : {"tree300.swc", "tree300hard.swc", "tree3k.swc"}) {
        const auto path = source_dir() / ".." / "shared" / "workloads" / name;
        if (!std::filesystem::exists(path)) GTEST_SKIP() << "no workloads next to the checkout";
        const Skeleton s = read_skeleton(path).skeleton;
        std::vector<float> numbers;
        for (const NodeId n : nodes(s)) numbers.push_back(static_cast<float>(n.index() % 1000));
        for (const SkeletonFormat format : {json, ply, rsml, mtg}) {
            SCOPED_TRACE(std::string(name) + " as " + std::string(name_of(format)));
            const std::vector<NodeAttribute> attributes{{"kind", numbers}};
            const SkeletonFile back =
                parse_skeleton(encode_skeleton(s, {.format = format}, attributes), "t", {.format = format});
            expect_equal(back.skeleton, s);
            EXPECT_TRUE(std::ranges::equal(back.attribute("kind"), numbers));
            EXPECT_TRUE(back.attribute("node").empty());
            EXPECT_EQ(back.report.total(), 0u);
            EXPECT_TRUE(back.notes.empty());
        }
    }
}

TEST(SkeletonWriter, PreservesTheDigitsOfGeoreferencedTrees) {
    const Vec3d origin{5123456, 612345, -100};
    const Skeleton s = fork(origin);
    for (const WriteSkeletonOptions& options : kLossless) {
        SCOPED_TRACE(name_of(options.format));
        const Skeleton back =
            parse_skeleton(encode_skeleton(s, options), "t", {.format = options.format}).skeleton;
        ASSERT_EQ(back.size(), s.size());
        for (const NodeId n : nodes(s)) {
            const Vec3d world = s.origin() + Vec3d(s.position(n)),
                        read = back.origin() + Vec3d(back.position(n));
            EXPECT_NEAR(distance(world, read), 0, 2e-6) << n.index();
        }
    }
}

TEST(SkeletonWriter, CylindersHaveTheVolumeOfTheirSegments) {
    const std::string text = encode_skeleton(fork(), {SkeletonFormat::cylinders});
    // Cone 0 to 1: radii 0.3 and 1/7, so sqrt((0.09 + 0.042857 + 0.020408) / 3) = 0.2260275;
    // length 1.0088497.
    EXPECT_EQ(text.substr(0, text.find('\n', 130)),
              "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius,length,branchOrder,branchID,segmentID,"
              "parentSegmentID\n"
              "0,-1,0.1,0.2,0,0.1,0.33333334,1,0.22602752,1.0088497,0,0,0,-1");
    EXPECT_NE(text.find("\n1,0,0.1,0.33333334,1,0.5,0,2e-07,"), std::string::npos);
    EXPECT_NE(text.find(",0,0,1,0\n2,0,"), std::string::npos)
        << "the leader stays in its branch, in a new segment";
    EXPECT_EQ(text.substr(text.size() - 9), ",1,1,2,0\n") << "the other child begins a branch";
    const SkeletonFile file = parse_skeleton(text, "t.csv");
    EXPECT_EQ(file.format, "cylinders");
    EXPECT_EQ(file.skeleton.tree_count(), 1u);
}

TEST(SkeletonWriter, CylindersPreserveOrdersAxesAndTrees) {
    const std::uint32_t count = fork().size();
    const std::vector<NodeAttribute> known{{"order", std::vector<float>(count, 3)},
                                           {"axis", std::vector<float>(count, 9)},
                                           {"tree", std::vector<float>(count, 17)}};
    const std::string text = encode_skeleton(fork(), {SkeletonFormat::cylinders}, known);
    EXPECT_NE(text.find(",parentSegmentID,treeID\n"), std::string::npos);
    EXPECT_NE(text.find(",3,9,0,-1,17\n"), std::string::npos);
    const SkeletonFile back = parse_skeleton(text, "t.csv");
    EXPECT_EQ(back.skeleton.tree_count(), 1u);
    for (const NodeAttribute& a : known) {
        const auto read = back.attribute(a.name);
        EXPECT_EQ(std::vector<float>(read.begin(), read.end()),
                  std::vector<float>(back.skeleton.size(), a.values[0]));
    }
    // Fractions are not orders.
    const std::vector<NodeAttribute> halves{{"order", std::vector<float>(count, 0.5f)}};
    EXPECT_EQ(encode_skeleton(fork(), {SkeletonFormat::cylinders}, halves),
              encode_skeleton(fork(), {SkeletonFormat::cylinders}));
}

TEST(SkeletonWriter, DeterminesTheFormatByTheExtension) {
    const std::filesystem::path folder(testing::TempDir());
    for (const char* name : {"w.swc", "w.JSON", "w.obj", "w.ply", "w.rsml", "w.mtg"}) {
        write_skeleton(folder / name, fork());
        expect_equal(read_skeleton(folder / name).skeleton, fork());
    }
    write_skeleton(folder / "w.txt", fork(), {.format = SkeletonFormat::swc});
    EXPECT_EQ(read_skeleton(folder / "w.txt").format, "swc");
}

TEST(SkeletonWriter, WritesAttributesThatAreReadBack) {
    const Skeleton s({NodeId::none(), NodeId(0)}, {{0, 0, 0}, {0, 0, 1}}, {0.1f, 0.05f});
    const std::vector<NodeAttribute> attributes{{"samples", {12, 7}}, {"residual", {0.25f, 0.5f}}};
    const std::string json = encode_skeleton(s, {.format = SkeletonFormat::json}, attributes);
    EXPECT_NE(json.find("\"samples\": [12,7]"), std::string::npos);
    EXPECT_NE(json.find("\"residual\": [0.25,0.5]"), std::string::npos);
    const std::string ply = encode_skeleton(s, {.format = SkeletonFormat::ply, .binary = false}, attributes);
    EXPECT_NE(ply.find("property float samples\nproperty float residual\n"), std::string::npos);
    EXPECT_NE(ply.find("0 0 1 0.05 7 0.5\n"), std::string::npos);
    const std::string binary = encode_skeleton(s, {.format = SkeletonFormat::ply}, attributes);
    for (const auto& [bytes, name] : {std::pair{json, "a.json"}, {ply, "a.ply"}, {binary, "a.ply"}}) {
        const SkeletonFile file = parse_skeleton(bytes, name);
        const Skeleton& back = file.skeleton;
        ASSERT_EQ(file.attributes.size(), 2u) << name;
        EXPECT_EQ(file.attributes[0].name, "samples") << name;
        EXPECT_EQ(file.attributes[1].values, (std::vector<float>{0.25f, 0.5f})) << name;
        EXPECT_EQ(file.attribute("samples")[1], 7) << name;
        EXPECT_TRUE(file.attribute("none").empty()) << name;
        EXPECT_EQ(back.size(), 2u) << name;
        EXPECT_EQ(back.radius(NodeId(1)), 0.05f) << name;
        EXPECT_EQ(back.position(NodeId(1)), Vec3(0, 0, 1)) << name;
    }
}

TEST(SkeletonWriter, PreservesSwcTypesThroughOtherFormats) {
    const std::string swc =
        "# SWC written by Coppice; units: m\n# id type x y z radius parent\n"
        "1 1 0 0 0 5 -1\n2 3 0 0 9 1 1\n3 256 4 0 12 0.5 2\n";
    const auto through = [](const std::string& text, const char* name, SkeletonFormat next) {
        const SkeletonFile file = parse_skeleton(text, name);
        return encode_skeleton(file.skeleton, {.format = next}, file.attributes);
    };
    const std::string json = through(swc, "t.swc", SkeletonFormat::json);
    const std::string ply = through(json, "t.json", SkeletonFormat::ply);
    EXPECT_EQ(through(ply, "t.ply", SkeletonFormat::swc), swc);
    const SkeletonFile file = parse_skeleton(swc, "t.swc");
    const std::vector<NodeAttribute> shares{{"type", {0.5f, 1, 2}}};
    EXPECT_NE(
        encode_skeleton(file.skeleton, {.format = SkeletonFormat::swc}, shares).find("\n2 0 0 0 9 1 1\n"),
        std::string::npos)
        << "invalid types are not written";
}

TEST(SkeletonWriter, PreservesSwcIds) {
    const std::string head = "# SWC written by Coppice; units: m\n# id type x y z radius parent\n";
    const auto converted = [&](const std::string& rows) {
        const SkeletonFile file = parse_skeleton(head + rows, "t.swc");
        return encode_skeleton(file.skeleton, {.format = SkeletonFormat::swc}, file.attributes);
    };
    const std::string gaps = "7 0 0 0 0 5 -1\n3 0 0 0 9 1 7\n16777216 0 4 0 12 0.5 3\n";
    EXPECT_EQ(converted(gaps), head + gaps);
    EXPECT_EQ(converted("2 0 0 0 9 1 1\n1 0 0 0 0 5 -1\n"), head + "1 0 0 0 0 5 -1\n2 0 0 0 9 1 1\n")
        << "parents come first, with their ids";
    EXPECT_EQ(converted("4 0 0 0 0 5 -1\n5 0 0 0 0 5 4\n6 0 0 0 9 1 5\n"),
              head + "4 0 0 0 0 5 -1\n6 0 0 0 9 1 4\n")
        << "a node at the place of its parent is merged into it";
    for (const char* first : {"0", "16777217"}) {
        EXPECT_EQ(converted(std::string(first) + " 0 0 0 0 5 -1\n9 0 0 0 9 1 " + first + "\n"),
                  head + "1 0 0 0 0 5 -1\n2 0 0 0 9 1 1\n")
            << first;
    }
    const std::string json =
        encode_skeleton(parse_skeleton(head + gaps, "t.swc").skeleton, {.format = SkeletonFormat::json},
                        parse_skeleton(head + gaps, "t.swc").attributes);
    const SkeletonFile back = parse_skeleton(json, "t.json");
    EXPECT_EQ(encode_skeleton(back.skeleton, {.format = SkeletonFormat::swc}, back.attributes), head + gaps);
    // Ids that count from 1 in the order of the nodes are not stored.
    EXPECT_TRUE(parse_skeleton(head + "1 0 0 0 0 5 -1\n2 0 0 0 9 1 1\n", "t.swc").attributes.empty());
}

TEST(SkeletonWriter, NodesWithoutAUniqueIdAreNumberedAfterTheOthers) {
    // The first of the nodes with id 4 keeps it; 0 and 2.5 are not ids.
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(2), NodeId(3)},
                     {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {0, 0, 4}}, {1, 1, 1, 1, 1});
    const std::vector<NodeAttribute> ids{{"id", {4, 4, 9, 0, 2.5f}}};
    const std::string text = encode_skeleton(s, {.format = SkeletonFormat::swc}, ids);
    EXPECT_NE(
        text.find("\n4 0 0 0 0 1 -1\n10 0 0 0 1 1 4\n9 0 0 0 2 1 10\n11 0 0 0 3 1 9\n12 0 0 0 4 1 11\n"),
        std::string::npos)
        << text;
}

TEST(SkeletonWriter, WritesUnits) {
    for (const char* name : {"swc", "json", "obj", "ply"}) {
        const SkeletonFormat format = *format_of_extension(std::string("t.") + name);
        for (const LengthUnit units : {LengthUnit::m, LengthUnit::um, LengthUnit::inch}) {
            const std::string bytes = encode_skeleton(fork(), {.format = format, .units = units});
            EXPECT_EQ(parse_skeleton(bytes, std::string("t.") + name).units, units) << name;
        }
    }
}

TEST(NodeAttribute, IsPreservedThroughEdits) {
    const auto node = [](std::uint32_t i) { return NodeId(i); };
    const Skeleton before({NodeId::none(), node(0), node(1)}, {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}}, {1, 1, 1});
    // The last node is removed; one is new between the two remaining ones, with a twig, and there is another
    // tree.
    const Skeleton after({NodeId::none(), node(0), node(1), node(1), NodeId::none()},
                         {{0, 0, 0}, {0, 0, 0.5f}, {0, 0, 1}, {1, 0, 1}, {5, 0, 0}}, {1, 1, 1, 1, 1}, {},
                         {StableId(0), StableId(7), StableId(1), StableId(8), StableId(9)});
    const std::vector<NodeAttribute> carried = kept_attributes({{{"type", {1, 3, 4}}}}, before, after);
    ASSERT_EQ(carried.size(), 1u);
    EXPECT_EQ(carried[0].name, "type");
    EXPECT_EQ(carried[0].values, (std::vector<float>{1, 1, 3, 1, 0}));
    EXPECT_TRUE(kept_attributes({}, before, after).empty());
}

TEST(SkeletonWriter, ReportsErrors) {
    EXPECT_EQ(error_of<Unsupported>([] { write_skeleton("t.xyz", fork()); }),
              "t.xyz: the extension is not that of a skeleton format; use .swc, .csv, .ply, .obj, .json, "
              ".rsml or .mtg");
    EXPECT_EQ(error_of<Unsupported>([] { write_skeleton("t.mat", fork()); }),
              "skeletons are not written as mat; choose swc, cylinders, ply, obj, json, rsml or mtg");
    EXPECT_THROW(encode_skeleton(Skeleton({NodeId::none()}, {Vec3{}}, {1.0f}), {SkeletonFormat::cylinders}),
                 Unsupported);
    EXPECT_THROW(encode_skeleton(Skeleton(), {SkeletonFormat::swc}), InvalidInput);
    EXPECT_THROW(write_skeleton("no/such/folder/t.swc", fork()), IoError);
    EXPECT_FALSE(std::filesystem::exists("t.mat"));
}

}  // namespace
}  // namespace coppice
