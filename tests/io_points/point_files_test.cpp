#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <string>

#include "coppice/base/random.h"
#include "coppice/io_points/reader.h"
#include "coppice/io_points/writer.h"
#include "coppice/system/file.h"
#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

namespace fs = std::filesystem;

PointSet many(std::size_t n) {
    PointSet set;
    const CounterRandom random(3, 1);
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3d p(random.uniform(3 * i, -1, 1), random.uniform(3 * i + 1),
                      random.uniform(3 * i + 2, 0, 1e-6));
        set.positions.push_back(Vec3(p));
    }
    return set;
}

std::string error_of(std::string_view bytes) {
    return test::error_of([&] { parse_points(bytes, "p.xyz"); });
}

class PointFiles : public test::FolderTest {};

TEST_F(PointFiles, AreReadBackBitIdentically) {
    const PointSet set = many(20000);  // three runs of the writer
    for (const char* name : {"a.xyz", "a.txt", "a.csv", "a.ply", "a.PLY"}) {
        write_points(folder_ / name, set);
        EXPECT_EQ(read_points(folder_ / name), set) << name;
    }
}

TEST_F(PointFiles, PlyPreservesDistancesAndColours) {
    PointCloud point_cloud{many(20000), {}, {}};
    for (std::size_t i = 0; i < point_cloud.points.size(); ++i) {
        point_cloud.distances.push_back(static_cast<float>(i) / 7 - 3);
        point_cloud.colors.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i / 256), 255});
    }
    for (const Vec3d origin : {Vec3d{}, Vec3d{500000, 4.5e6, 0.5}}) {
        point_cloud.points.origin = origin;
        write_point_cloud(folder_ / "a.ply", point_cloud, {.note = "a note"});
        const PointCloud back = read_point_cloud(folder_ / "a.ply");
        EXPECT_EQ(back.distances, point_cloud.distances);
        EXPECT_EQ(back.colors, point_cloud.colors);
        EXPECT_LT(distance(back.points.world(77), point_cloud.points.world(77)), 1e-6);
    }
    EXPECT_NE(read_file(folder_ / "a.ply").find("\ncomment a note\n"), std::string::npos);
    point_cloud.distances.clear();
    write_point_cloud(folder_ / "a.ply", point_cloud, {});
    EXPECT_TRUE(read_point_cloud(folder_ / "a.ply").distances.empty());
    EXPECT_EQ(read_point_cloud(folder_ / "a.ply").colors, point_cloud.colors);
}

/// Points with all attributes except distances.
PointCloud known_points(std::size_t count) {
    PointCloud out{many(count), {}, {}};
    for (std::size_t i = 0; i < count; ++i) {
        const auto byte = [&](std::size_t n) { return static_cast<std::uint8_t>(n % 256); };
        out.colors.push_back({byte(i), byte(i / 256), 255});
        out.classes.push_back(byte(i / 7));
        out.intensities.push_back(static_cast<float>(i % 65536));
        out.return_counts.push_back(byte(1 + i % 5));
        out.return_numbers.push_back(byte(1 + i % 3));
        out.tree_ids.push_back(static_cast<std::uint32_t>(i % 11 * 400000000));
    }
    return out;
}

void expect_same_columns(const PointCloud& a, const PointCloud& b) {
    EXPECT_EQ(a.colors, b.colors);
    EXPECT_EQ(a.classes, b.classes);
    EXPECT_EQ(a.intensities, b.intensities);
    EXPECT_EQ(a.return_counts, b.return_counts);
    EXPECT_EQ(a.return_numbers, b.return_numbers);
    EXPECT_EQ(a.tree_ids, b.tree_ids);
}

TEST_F(PointFiles, PreservePointAttributes) {
    PointCloud points = known_points(20000);
    for (const Vec3d origin : {Vec3d{}, Vec3d{500000, 4.5e6, 0.5}}) {
        points.points.origin = origin;
        for (const char* name : {"a.ply", "a.txt", "a.csv", "a.asc", "a.las"}) {
            SCOPED_TRACE(name);
            write_point_cloud(folder_ / name, points);
            const PointCloud back = read_point_cloud(folder_ / name);
            expect_same_columns(back, points);
            ASSERT_EQ(back.points.size(), points.points.size());
            // Half a step of 0.1 mm along each axis, plus the rounding of doubles at 4.5e6.
            for (std::size_t i = 0; i < back.points.size(); i += 99)
                EXPECT_LT(distance(back.points.world(i), points.points.world(i)), 0.87e-4 + 1e-6);
        }
    }
    write_point_cloud(folder_ / "a.xyz", points);
    EXPECT_TRUE(read_point_cloud(folder_ / "a.xyz").classes.empty());
}

TEST_F(PointFiles, LasHasTheMaximumResolutionOf32Bits) {
    PointCloud points{many(3), {}, {}};
    points.points.positions[0] = {-3e5f, 0, 0};  // 6e5 m: 0.1 mm would need 33 bits
    points.points.positions[1] = {3e5f, 0.002f, 0.25f};
    points.intensities = {-1, 0, 1};
    write_point_cloud(folder_ / "a.las", points);
    const PointCloud back = read_point_cloud(folder_ / "a.las");
    EXPECT_NEAR(back.points.world(1).y, 0.002, 1e-7);
    EXPECT_NEAR(back.points.world(0).x, -3e5, 1e-3);
    EXPECT_EQ(back.intensities, (std::vector<float>{0, 32768, 65535}));  // 32767.5 is rounded up
}

TEST_F(PointFiles, LasPreservesTheCoordinateSystem) {
    const CoordinateSystem system{{{34735, std::string("\1\0\1\0", 4)}, {2112, "PROJCS[\"here\"]"}}};
    write_point_cloud(folder_ / "a.las", known_points(10), {.system = system});
    const PointFile back = read_point_file(folder_ / "a.las", {.ranges = true});
    EXPECT_EQ(back.system.records, system.records);
    EXPECT_EQ(back.system.name(), "here");
    EXPECT_EQ(back.format, "LAS 1.4, point format 7");
    ASSERT_EQ(back.dimensions.size(), 1u);
    EXPECT_EQ(back.dimensions[0].name, "tree_id");
    EXPECT_EQ(back.dimensions[0].high, 3.6e9);
    expect_same_columns(back.point_cloud, known_points(10));
}

TEST_F(PointFiles, ReadsColoursOfBytesOnly) {
    const auto read = [&](const char* type, const char* color = "7 8 9") {
        AtomicFile file(folder_ / "a.ply");
        file.write(std::string("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float "
                               "y\nproperty float z\nproperty list uchar float distance\nproperty ") +
                   type + " red\nproperty " + type + " green\nproperty " + type +
                   " blue\nend_header\n1 2 3 1 5 " + color + "\n");
        file.commit();
        return read_point_cloud(folder_ / "a.ply");
    };
    EXPECT_EQ(read("uchar").colors, (std::vector<Rgb>{{7, 8, 9}}));
    EXPECT_EQ(read("uchar", "2955 -1 9").colors, (std::vector<Rgb>{{0, 0, 9}}));
    EXPECT_TRUE(read("float").colors.empty());
    EXPECT_TRUE(read("uchar").distances.empty());  // a list is not a number
}

TEST_F(PointFiles, PreserveTheDigitsOfDistantPoints) {
    PointSet set = many(1000);
    set.origin = {500000, 4.5e6, 0.5};
    for (const char* name : {"a.xyz", "a.ply"}) {
        write_points(folder_ / name, set);
        const PointSet back = read_points(folder_ / name);
        ASSERT_EQ(back.size(), set.size());
        for (std::size_t i = 0; i < set.size(); ++i) {
            EXPECT_LT(distance(back.world(i), set.world(i)), 1e-6) << name;
        }
    }
}

TEST_F(PointFiles, AreIdenticalForAnyNumberOfThreads) {
    const PointSet set = many(30000);
    for (const char* name : {"a.xyz", "a.ply", "a.las"}) {
        write_points(folder_ / name, set, {.threads = 1});
        const std::string one = read_file(folder_ / name);
        write_points(folder_ / name, set, {.threads = 7});
        EXPECT_EQ(read_file(folder_ / name), one);
    }
}

TEST_F(PointFiles, RejectedOutputCreatesNoFile) {
    PointSet set = many(3);
    EXPECT_THROW(write_points(folder_ / "a.obj", set), Unsupported);
    EXPECT_THROW(write_points(folder_ / "a.laz", set), Unsupported);
    EXPECT_EQ(remedy_for_points_name("a.LAZ"), "LAZ is read only; use .las, and pack that file with laszip");
    EXPECT_THROW(write_points(folder_ / "none" / "a.xyz", set), IoError);
    set.positions[1].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(write_points(folder_ / "a.xyz", set), InvalidInput);
    EXPECT_TRUE(fs::is_empty(folder_));
}

/// Rays of a ray cloud: the first and the third have a return. `nx` is the last number that varies.
std::string rays(std::string_view nx, std::string_view last = "property uchar alpha") {
    std::string text = "ply\nformat ascii 1.0\nelement vertex 3\n";
    for (const char* name : {"x", "y", "z", "time", "nx", "ny", "nz"})
        text += std::string("property double ") + name + "\n";
    text += "property uchar red\nproperty uchar green\nproperty uchar blue\n" + std::string(last) +
            "\nend_header\n";
    const char* const tails[] = {" 0 0 1 2 3 255\n", " 0 0 4 5 6 0\n", " 0 0 7 8 9 1\n"};
    for (int i = 0; i < 3; ++i) text += std::to_string(i) + " 5 6 0.5 " + std::string(nx) + tails[i];
    return text;
}

TEST(PointPly, SkipsRaysWithoutReturn) {
    const PointFile found = parse_point_file(rays("2.5"), "p.ply");
    EXPECT_EQ(found.without_return, 1u);
    EXPECT_EQ(found.format, "ray cloud (PLY)");
    EXPECT_EQ(found.point_cloud.points.positions, (Buffer<Vec3>{{0, 5, 6}, {2, 5, 6}}));
    EXPECT_EQ(found.point_cloud.colors, (std::vector<Rgb>{{1, 2, 3}, {7, 8, 9}}));
}

TEST(PointPly, PreservesTransparentPointsWithNormals) {
    for (const std::string& text :
         {rays("1"), rays("0"), rays("2.5", "property uchar a"), rays("2.5", "property float alpha")}) {
        const PointFile found = parse_point_file(text, "p.ply");
        EXPECT_EQ(found.point_cloud.points.size(), 3u);
        EXPECT_EQ(found.without_return, 0u);
        EXPECT_EQ(found.format, "PLY");
    }
}

TEST(PointText, ReadsTreeIds) {
    const PointCloud found = parse_point_cloud(
        "x,y,z,label,treeID\n1,2,3,9,4\n2,2,3,9,NA\n3,2,3,9,-1\n4,2,3,9,4294967295\n", "p.csv");
    EXPECT_EQ(found.tree_ids, (std::vector<std::uint32_t>{4, 0, 0, 4294967295}));
    EXPECT_EQ(parse_point_cloud("//X Y Z scalar_PredInstance\n1 2 3 8.000\n", "p.asc").tree_ids,
              (std::vector<std::uint32_t>{8}));
    EXPECT_TRUE(parse_point_cloud("x y z height_of_tree\n1 2 3 8\n", "p.txt").tree_ids.empty());
}

TEST(PointText, ReadsAllNotations) {
    PointSet expected;
    expected.positions = {{1, 2, 3}, {-0.5f, 1000, 0}};
    EXPECT_EQ(parse_points("1 2 3\n-.5 1e3 0\n", "p"), expected);
    EXPECT_EQ(parse_points("\xEF\xBB\xBFx,y,z,r\r\n1,2,3,9\r\n-0.5;1000;0;9", "p"), expected);
    EXPECT_EQ(parse_points("# head\n\n  1\t2\t3 255 0 0 # red\r-0.5 1000 0 // end", "p"), expected);
    EXPECT_EQ(
        parse_points("ply\nformat ascii 1.0\nelement note 1\nproperty int n\nelement vertex 2\n"
                     "property float z\nproperty uchar red\nproperty float x\nproperty double y\nend_header\n"
                     "7\n3 255 1 2\n0 1 -0.5 1000\n",
                     "p"),
        expected);
}

TEST(PointText, ReadsNamedColumns) {
    PointSet expected;
    expected.positions = {{1, 2, 3}, {-0.5f, 1000, 0}};
    for (const char* text :
         {"\"id\" \"X\" \"Y\" \"Z\"\n7 1 2 3\n8 -0.5 1000 0\n",             // as R writes a table
          "\"X\" \"Y\" \"Z\"\n\"1\" 1 2 3\n\"2\" -0.5 1000 0\n",            // with row names
          "\"\",\"z\",\"y\",\"x\"\n\"1\",3,2,1\n\"2\",0,1000,-0.5\n",       // and as CSV
          "//X Y Z R G B\n1 2 3 9 9 9\n-0.5 1000 0 9 9 9\n",                // CloudCompare
          "id,Intensity,Z,X,Y\n1,,3,1,2\n2,9,0,-0.5,1000\n",                // an empty cell counts
          "# t x y z\n0 1 2 3\n0 -0.5 1000 0\n",                            // numpy.savetxt
          "'y_coord'; 'x_coord'; 'z_coord (m)'\n2; 1; 3\n1000; -0.5; 0\n",  // any quotes, order and case
          "\"Points:0\",\"Points:1\",\"Points:2\"\n1,2,3\n-0.5,1000,0\n",   // ParaView
          "Height Northing Easting Elevation\n5 2 1 3\n5 1000 -0.5 0\n"}) {
        EXPECT_EQ(parse_points(text, "p"), expected) << text;
    }
    // A comment that is not a list of columns is ignored.
    EXPECT_EQ(parse_points("# made by z and y\n# x\n1 2 3\n-0.5 1000 0\n", "p"), expected);
}

TEST(PointText, RejectsNamesWithoutCoordinates) {
    EXPECT_EQ(error_of("id,east,red\n1,2,3\n"),
              "p.xyz:1: the columns are named 'id', 'east', 'red', but x, y and z are not among them");
    EXPECT_EQ(error_of("id x y z\n1 2 3\n"), "p.xyz:2: it has 3 values for 4 named columns");
    EXPECT_EQ(error_of("x,y,z\n1,,3\n"), "p.xyz:2: '' is not a number");
    EXPECT_EQ(error_of("tree1 2 3 4\n"), "p.xyz:1: 'tree1' is not a number");
}

TEST(PointText, SkipsRowNamesOfR) {
    PointSet expected;
    expected.positions = {{5, 2, 3}, {-0.5f, 1000, 0}, {1, 1, 7}};
    EXPECT_EQ(parse_points("\"X\" \"Y\" \"Z\"\n\"1\" 5 2 3\n\"2\" -0.5 1000 0\n\"9\" 1 1 7\n", "p"),
              expected);
    EXPECT_EQ(parse_points("X Y Z\n1 5 2 3\n2 -0.5 1000 0\n3 1 1 7\n", "p"), expected);
    EXPECT_EQ(parse_points("\"\",\"X\",\"Y\",\"Z\"\n\"1\",5,2,3\n\"2\",-0.5,1000,0\n\"3\",1,1,7\n", "p"),
              expected);
    // Rows that do not count up have a column without a name at their end.
    EXPECT_EQ(parse_points("X Y Z\n5 2 3 9\n-0.5 1000 0 8\n1 1 7 7\n", "p"), expected);
}

TEST(PointText, RejectsDecimalCommas) {
    for (const char* text : {"1,5;2,25;3\n", "1,5 2,25 3\n", "x;y;z\n1,5;2,25;3,0\n", "0 0 0\n1,5\t2\t3\n",
                             "x,y,z\n1,5,2,25,3,0\n"})
        EXPECT_NE(error_of(text).find("its numbers have decimal commas"), std::string::npos) << text;
    PointSet expected;
    expected.positions = {{1, 2, 3}};
    EXPECT_EQ(parse_points("1,2,3,2026-01-02 10:11:12\n", "p"), expected);
    EXPECT_EQ(parse_points("1, 2, 3\n", "p"), expected);
    EXPECT_EQ(parse_points("x,y,z\n1,2,3,4.5,5,6\n", "p"), expected);
}

TEST(PointText, PreservesNamedColumns) {
    const PointCloud found = parse_point_cloud(
        "//X Y Z R G B Scalar_Classification Intensity\n1 2 3 255 0 10 4 -0.5\n4 5 6 1 2 3 2 7e2\n", "p");
    EXPECT_EQ(found.colors, (std::vector<Rgb>{{255, 0, 10}, {1, 2, 3}}));
    EXPECT_EQ(found.classes, (std::vector<std::uint8_t>{4, 2}));
    EXPECT_EQ(found.intensities, (std::vector<float>{-0.5f, 700}));
    // A column with a missing value is dropped, and so is one that is not requested.
    EXPECT_TRUE(parse_point_cloud("x y z reflectance\n1 2 3 NA\n4 5 6 1\n", "p").intensities.empty());
    EXPECT_TRUE(parse_point_cloud("x y z class\n1 2 3 4\n", "p", {.classes = false}).classes.empty());
    const PointCloud ply = parse_point_cloud(
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "property float scalar_Classification\nproperty float reflectance\nend_header\n1 2 3 5 -12.5\n",
        "p");
    EXPECT_EQ(ply.classes, (std::vector<std::uint8_t>{5}));
    EXPECT_EQ(ply.intensities, (std::vector<float>{-12.5f}));
}

TEST(ScannerText, ReadsPtsByBlocks) {
    const PointCloud found =
        parse_point_cloud("2\n1 2 3 -700 10 20 30\n4 5 6 900 1 2 3\n\n1\r\n7 8 9 0 0 0 255\n", "p");
    PointSet expected;
    expected.positions = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
    EXPECT_EQ(found.points, expected);
    EXPECT_EQ(found.intensities, (std::vector<float>{-700, 900, 0}));
    EXPECT_EQ(found.colors, (std::vector<Rgb>{{10, 20, 30}, {1, 2, 3}, {0, 0, 255}}));
    EXPECT_EQ(error_of("3\n1 2 3 0\n4 5 6 0\n"),
              "p.xyz: the file is cut off: it specifies 3 points, but 2 follow");
    EXPECT_EQ(error_of("1\n1 2\n"), "p.xyz:2: a point needs three coordinates");
    EXPECT_EQ(error_of("2\n1 2 3\n1 2 x\n"), "p.xyz:3: 'x' is not a number");
}

TEST(ScannerText, MovesPtxScansToTheirPoses) {
    // A quarter turn about z, then a translation by (10, 20, 30): (1, 2, 3) is mapped to (-2, 1, 3) + (10,
    // 20, 30).
    const std::string turned =
        "2\n1\n10 20 30\n1 0 0\n0 1 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 30 1\n";
    const std::string plain = "1\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
    const PointCloud found =
        parse_point_cloud(turned + "1 2 3 0.25\n0 0 0 0.5\n" + plain + "4 5 6 0.75\n7 8 9 1\n", "p");
    PointSet expected;
    expected.positions = {{8, 21, 33}, {4, 5, 6}, {7, 8, 9}};
    EXPECT_EQ(found.points, expected);
    EXPECT_EQ(found.intensities, (std::vector<float>{0.25f, 0.75f, 1}));
    EXPECT_EQ(error_of(turned + "1 2 3 0\n"),
              "p.xyz: the file is cut off: it specifies 2 points, but 1 follow");
    EXPECT_NE(error_of("2\n1\n0 0 0\n1 0 0\n").find("the position and the axes of the scanner"),
              std::string::npos);
    EXPECT_EQ(error_of(turned + "0 0 0 0\n0 0 0 0\n"), "p.xyz: it contains no points");
}

TEST(PointFormats, ReportsOtherFormatsWithTheirRemedy) {
    const auto refusal = [](std::string_view bytes) -> std::string {
        try {
            parse_points(bytes, "p");
        } catch (const Unsupported& e) {
            return e.what();
        }
        return "none";
    };
    EXPECT_EQ(refusal("\x1f\x8b\x08"), "p: it is compressed by gzip; unpack it first: gunzip FILE");
    EXPECT_NE(refusal("PK\3\4").find("a ZIP archive"), std::string::npos);
}

TEST(PointText, ReadsAnOffFileWithoutFaces) {
    PointSet expected;
    expected.positions = {{1, 2, 3}, {-0.5f, 1000, 0}};
    EXPECT_EQ(parse_points("OFF\n2 0 0\n1 2 3\n-0.5 1000 0\n", "p"), expected);
    EXPECT_EQ(parse_points("COFF\n2 0 0\n1 2 3 255 0 0 255\n-0.5 1000 0 0 0 0 255\n", "p"), expected);
    EXPECT_EQ(error_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
              "p.xyz: it has faces, so it is a mesh, not points");
    EXPECT_EQ(error_of("OFF\n2 0 0\n1 2 3\n"),
              "p.xyz:3: the file ends after 1 of 2 vertices; it is truncated");
}

TEST(PointText, ErrorsReportTheLine) {
    EXPECT_EQ(error_of(""), "p.xyz: it contains no points");
    EXPECT_EQ(error_of("# nothing\n"), "p.xyz: it contains no points");
    EXPECT_EQ(error_of("1 2 3\n1 2\n"), "p.xyz:2: a point needs three coordinates");
    EXPECT_EQ(error_of("1 2 3\n1 2 3x\n"), "p.xyz:2: '3x' is not a number");
    EXPECT_EQ(error_of("1.2.3 2 3\n"), "p.xyz:1: '1.2.3' is not a number");
    EXPECT_EQ(error_of("1 2 3\nx y z\n"), "p.xyz:2: 'x' is not a number");
    EXPECT_EQ(error_of("1 2 nan\n"), "p.xyz:1: a coordinate is not finite or beyond 1e30");
    EXPECT_EQ(error_of("1 2 1e31\n"), "p.xyz:1: a coordinate is not finite or beyond 1e30");
    EXPECT_NE(error_of(std::string("\0\1\2\3", 4)), "no error");
}

TEST(PointText, RejectsDamagedPly) {
    const std::string head = "ply\nformat binary_little_endian 1.0\nelement vertex ";
    const std::string xyz = "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    EXPECT_NE(error_of(head + "99999999999" + xyz).find("too short"), std::string::npos);
    EXPECT_NE(error_of(head + "2" + xyz + std::string(23, '\0')).find("too short"), std::string::npos);
    EXPECT_EQ(error_of(head + "0" + xyz), "p.xyz: it contains no points");
    EXPECT_NE(error_of(head + "1\nproperty float x\nproperty float y\nend_header\n12345678").find("lack"),
              std::string::npos);
    EXPECT_NE(
        error_of(head + "1\nproperty list uchar float x\nproperty float y\nproperty float z\nend_header\n" +
                 std::string(20, '\0'))
            .find("lists"),
        std::string::npos);
    const std::string nan("\0\0\xc0\x7f", 4);
    EXPECT_NE(error_of(head + "1" + xyz + nan + nan + nan).find("point 0 is not finite"), std::string::npos);
    EXPECT_NE(error_of("ply\nformat ascii 1.0\nelement face 0\nproperty int x\nend_header\n")
                  .find("no element vertex"),
              std::string::npos);
}

}  // namespace
}  // namespace coppice
