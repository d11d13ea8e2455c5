#include "coppice/io_skeleton/format.h"

#include <gtest/gtest.h>

#include <string>

namespace coppice {
namespace {

constexpr auto kSwc = SkeletonFormat::swc;
constexpr auto kCylinders = SkeletonFormat::cylinders;

TEST(SkeletonFormat, IsRecognizedByNames) {
    EXPECT_EQ(format_of_extension("a/Tree.SWC"), kSwc);
    EXPECT_EQ(format_of_extension("tree.csv"), kCylinders);
    EXPECT_EQ(format_of_extension("tree.txt"), std::nullopt);
}

TEST(SkeletonFormat, IsRecognizedByContent) {
    EXPECT_EQ(format_of_content("ply\nformat ascii 1.0\n"), SkeletonFormat::ply);
    EXPECT_EQ(format_of_content("# made by hand\n\n{\"format\": 1}"), SkeletonFormat::json);
    EXPECT_EQ(format_of_content("v 0 0 0\nl 1 2\n"), SkeletonFormat::obj);
    EXPECT_EQ(format_of_content("n 0 0 0\n"), SkeletonFormat::gel);
    EXPECT_EQ(format_of_content("radius,start_x,start_y,start_z\n"), kCylinders);
    EXPECT_EQ(format_of_content(""), std::nullopt);
}

TEST(SkeletonFormat, RowsWithConsistentParentsAreSwc) {
    EXPECT_EQ(format_of_content("1 0 0 0 0 1 -1\n"), kSwc);
    EXPECT_EQ(format_of_content("# id type x y z r parent\n1 1 0 0 0 1 -1\n2 1 0 0 1 1 1\n"), kSwc);
    // As printed by MATLAB, after or before their parents, with a remark.
    EXPECT_EQ(format_of_content("1.0e+000 1.0 0 0 0 1 -1.\n2.0e+000 1.0 0 0 1 1 1.0e+000\n"), kSwc);
    EXPECT_EQ(format_of_content("7 1 0 0 0 1 9 # a twig\r\n9 1 0 0 1 1 -1\r\n8 1 0 0 2 1 9\r\n"), kSwc);
    EXPECT_EQ(format_of_content("1 1 0 0 0 1 -1\n2 1 0 0 1 1 1\n3 1 0"), kSwc);  // cut off
}

TEST(SkeletonFormat, PointsWithSevenColumnsAreNotSwc) {
    EXPECT_EQ(format_of_content("0.5 1 2 100 255 0 17\n"), std::nullopt);
    EXPECT_EQ(format_of_content("5 1 2 0.3 255 0 17.5\n"), std::nullopt);
    // Integer millimetres, an intensity and a colour: ids are repeated, or parents do not exist.
    std::string steps, rows;
    for (int i = 0; i < 200; ++i) {
        rows += std::to_string(1000 + i / 2) + " 250 12 100 90 80 " + std::to_string(i % 256) + "\n";
        steps += std::to_string(1000 + i) + " 250 12 100 90 80 " + std::to_string(i % 256) + "\n";
    }
    EXPECT_EQ(format_of_content(rows), std::nullopt);
    EXPECT_EQ(format_of_content(steps), std::nullopt);
    EXPECT_EQ(format_of_content("-1000 250 12 100 90 80 -1\n"), std::nullopt);
    EXPECT_EQ(format_of_content("nan 1 2 3 4 5 nan\n"), std::nullopt);
}

TEST(SkeletonFormat, TablesWithoutNamesNeedAUnitAxis) {
    EXPECT_EQ(format_of_content("0.1 1 0 0 0 0 0 1 0 2 0\n"), kCylinders);
    EXPECT_EQ(format_of_content("0.1,1,0,0,0,0.6,0,0.8,0,2\n"), kCylinders);
    // Points with a normal, a colour and more.
    EXPECT_EQ(format_of_content("0.1 1 2 0 0 1 255 200 90 12 3\n"), std::nullopt);
    EXPECT_EQ(format_of_content("0.1 1 0 0 0 0 0 1 0.5 2 0\n"), std::nullopt);
}

}  // namespace
}  // namespace coppice
