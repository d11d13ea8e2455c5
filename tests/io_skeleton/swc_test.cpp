#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "coppice/io_skeleton/parsers_internal.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;

TEST(Swc, ReadsCommentsBlanksAndNumbersInAllNotations) {
    const auto [nodes, attributes, notes] = parse_swc(
        "\xEF\xBB\xBF# head\r\n\r\n  1 1 0.5 -1 2. 0.25 -1.\r\n 7\t5 1 2 3 1.0e+000 1.0000e+000 # tip\r\n",
        "t.swc");
    ASSERT_EQ(nodes.size(), 2u);
    EXPECT_EQ(nodes[0].id, 1);
    EXPECT_EQ(nodes[0].parent, -1);
    EXPECT_EQ(nodes[0].position, Vec3d(0.5, -1, 2));
    EXPECT_EQ(nodes[0].radius, 0.25);
    EXPECT_EQ(nodes[0].line, 3u);
    EXPECT_EQ(nodes[1].id, 7);
    EXPECT_EQ(nodes[1].parent, 1);
    EXPECT_EQ(nodes[1].line, 4u);
    ASSERT_EQ(attributes.size(), 1u);
    EXPECT_EQ(attributes[0].name, "type");
    EXPECT_EQ(attributes[0].values, (std::vector<double>{1, 5}));
}

TEST(Swc, ParentZeroIsARootUnlessThereIsANodeZero) {
    EXPECT_EQ(parse_swc("1 0 0 0 0 1 0\n", "t").nodes.front().parent, -1);
    EXPECT_EQ(parse_swc("0 0 0 0 0 1 -1\n1 0 0 0 1 1 0\n", "t").nodes.back().parent, 0);
}

TEST(Swc, ErrorsReportLineAndColumn) {
    const auto error = [](const std::string& text) {
        return error_of<InvalidInput>([&] { parse_swc(text, "tree.swc"); });
    };
    EXPECT_EQ(error("1 0 0 0 0 1 -1\n2 0 0 0 0 abc 1\n"),
              "tree.swc:2: 'abc' is not a number; column 6 should be the radius");
    EXPECT_EQ(error("1.5 0 0 0 0 1 -1\n"),
              "tree.swc:1: '1.5' is not a whole number; column 1 should be the id");
    EXPECT_EQ(error("\n1 0 0 0 0 1\n"),
              "tree.swc:2: 6 values, but a node of SWC has 7: id type x y z radius parent");
    EXPECT_EQ(error(std::string("\x01\x02\0\xff", 4)),
              "tree.swc:1: 1 values, but a node of SWC has 7: id type x y z radius parent");
}

TEST(Swc, RejectsDecimalCommas) {
    for (const char* text :
         {"1 1 0,0 0,5 0,0 0,1 -1\n", "1;1;0,0;0,5;0;0,1;-1\n", "1\t1\t-0,25\t1e2\t0\t1\t-1\n",
          "1 1 0 0 0 1 -1\n2 1 0 0 1,5 1 1\n", "1,1,0,0,0,5,0,0,0,1,-1\n"}) {
        EXPECT_NE(
            error_of<InvalidInput>([&] { parse_swc(text, "t.swc"); }).find("its numbers have decimal commas"),
            std::string::npos)
            << text;
    }
    for (const char* text :
         {"1,1,0.5,0,0,1,-1\n", "1, 1, 0, 0, 0, 1, -1\n", "1;1;0.5;0;0;1;-1\n", "1,1,0,0,0,1,-1\n"})
        EXPECT_EQ(parse_swc(text, "t.swc").nodes.size(), 1u) << text;
}

TEST(Swc, AcceptsAdditionalColumnsAfterTheSevenOfSwc) {
    // Columns appended by Vaa3D: segment, level, mode, time.
    const auto nodes =
        parse_swc(
            "#n type x y z r parent seg level mode time\n1 1 0 0 0 1.5 -1 0 1 0 1\n2 3 0 0 2 1 1 0 1 0 1\n",
            "t")
            .nodes;
    ASSERT_EQ(nodes.size(), 2u);
    EXPECT_EQ(nodes[1].parent, 1);
    const auto error = [](const std::string& text) {
        return error_of<InvalidInput>([&] { parse_swc(text, "t.swc"); });
    };
    EXPECT_EQ(error("1 1 0 0 0 1 -1\n2 1 0 0 1 1 1 9 9\n"),
              "t.swc:2: 9 values, but the first row has 7; write notes after a #");
    EXPECT_EQ(error("1 1 0 0 0 1 -1 7\n2 1 0 0 1 1 1\n"),
              "t.swc:2: 7 values, but the first row has 8; write notes after a #");
    // The seventh column is the radius here.
    EXPECT_EQ(error("1 1 1 0 0 0 20 -1\n2 2 1 0 0 5 30 1\n"),
              "t.swc: the rows have 8 values, and the seventh, the parent, refers to no node in 2 of 2 rows; "
              "the first seven columns of SWC are id type x y z radius parent");
}

}  // namespace
}  // namespace coppice
