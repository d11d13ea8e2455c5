#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/io_skeleton/parsers_internal.h"
#include "coppice/io_skeleton/reader.h"
#include "io_skeleton/two_cylinders.h"
#include "skeleton/text.h"

namespace coppice {
namespace {

using test::error_of;

constexpr const char* kTreeQsmRow =
    "0.5\t2\t1\t2\t3\t0\t0\t1\t0\t2\t1\t0\t1\t0.001\t0.9\t0\t0.5\t\n0."
    "25\t1\t1\t2\t5\t1\t0\t0\t1\t0\t1\t0\t2\t0.001\t0.9\t0\t0.25\n";

TEST(CylinderTable, ReadsTreeQsmWithThirteenNamesForSeventeenColumns) {
    const std::string head =
        "radius (m)\tlength (m)\tstart_point\taxis_direction\tparent\textension\tbranch\tbranch_order\t"
        "position_in_branch\tmad\tSurfCov\tadded\tUnmodRadius (m)\n";
    expect_two_cylinders(parse_cylinders(head + kTreeQsmRow, "t.txt"));
}

TEST(CylinderTable, ReadsTreeQsmWithoutHeader) {
    expect_two_cylinders(parse_cylinders(kTreeQsmRow, "t.txt"));
    expect_two_cylinders(parse_cylinders(
        "0.5 2 1 2 3 0 0 1 0 2 0 .5 1 0 1\r\n0.25 1 1 2 5 1 0 0 1 0 0 .25 1 0 2\r\n", "t.txt"));
}

TEST(CylinderTable, ReadsSimpleForestInAnyOrderAndCase) {
    expect_two_cylinders(parse_cylinders(
        " id, PARENTID, startX, startY, startZ, endX, endY, endZ, radius, length, growthLength\n"
        "0,-1,1,2,3,1,2,5,0.5,2,3\n1,0,1,2,5,2,2,5,0.25,1,1\n",
        "t.csv"));
    expect_two_cylinders(
        parse_cylinders("radius;endz;endy;endx;startz;starty;startx;parentid;id\n0,5;5;2;1;3;2;1;-1;0\n0,25;"
                        "5;2;2;5;2;1;0;1\n",
                        "t.csv"));
}

TEST(CylinderTable, ReadsTheNamesOfArchiArborAndTreegraph) {
    expect_two_cylinders(parse_cylinders(
        "startX,startY,startZ,endX,endY,endZ,cyl_ID,parent_ID,extension_ID,radius_cyl,length\n"
        "1,2,3,1,2,5,1,0,2,0.5,2\n1,2,5,2,2,5,2,1,0,0.25,1\n",
        "t.csv"));
    expect_two_cylinders(
        parse_cylinders("startX,startY,startZ,endX,endY,endZ,cyl_ID,parent_ID,axis_ID,branch_order,dist_to_"
                        "root,subtree_length,radius,quality\n"
                        "1,2,3,1,2,5,4,NA,1,0,0,3,0.5,1\n1,2,5,2,2,5,9,4,1,0,2,1,0.25,1\n",
                        "t.csv"));
    expect_two_cylinders(parse_cylinders(
        "p1,p2,sx,sy,sz,ax,ay,az,radius,length,nbranch\n0,-1,1,2,3,0,0,1,0.5,2,0\n1,0,1,2,5,1,0,0,0.25,1,0\n",
        "t.csv"));
}

TEST(CylinderTable, RejectsRowsWithMoreValuesThanColumns) {
    // 0,1,1,5,... would be read as a start at 1, 5 instead of 1.5.
    EXPECT_EQ(error_of<InvalidInput>([] {
                  parse_cylinders(
                      "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius\n"
                      "1,0,1,5,0,0,0,0,1,0,0,1\n",
                      "t.csv");
              }),
              "t.csv:2: the row has 12 values for 9 columns; if these are decimal commas, write decimal "
              "points, or separate the columns by semicolons");
}

TEST(CylinderTable, ReadsQuotedNamesAndRowNamesOfR) {
    expect_two_cylinders(
        parse_cylinders("\"startX\",\"startY\",\"startZ\",\"endX\",\"endY\",\"endZ\",\"cyl_ID\",\"parent_"
                        "ID\",\"radius_cyl\"\n"
                        "\"1\",1,2,3,1,2,5,1,0,0.5\n\"2\",1,2,5,2,2,5,2,1,0.25\n",
                        "t.csv"));
}

TEST(CylinderTable, ErrorsReportMissingColumns) {
    const auto error = [](const std::string& text) {
        return error_of<InvalidInput>([&] { parse_cylinders(text, "t.csv"); });
    };
    EXPECT_EQ(error("ID,parentID,startX,startY,startZ,endX,endY,endZ\n"),
              "t.csv:1: no column of the header contains the radius ('radius'); see docs/user/formats.md for "
              "the names");
    EXPECT_EQ(error("# c\nradius,parent,startX,startY,startZ,length\n"),
              "t.csv:2: no column of the header contains the end ('endX', 'endY', 'endZ', or 'axis_x', "
              "'axis_y', 'axis_z' and 'length'); see docs/user/formats.md for the names");
    const std::string head = "parent,radius,startX,startY,startZ,endX,endY,endZ\n";
    EXPECT_EQ(error(head + "0,1,1,2,3,1,2\n"), "t.csv:2: the row has 7 values, but the end is column 8");
    EXPECT_EQ(error(head + "0,abc,1,2,3,1,2,3\n"),
              "t.csv:2: 'abc' is not a number; column 2 should be the radius");
    EXPECT_EQ(error(head + "0.5,1,1,2,3,1,2,3\n"),
              "t.csv:2: '0.5' is not a whole number; column 1 should be the parent");
    EXPECT_EQ(error("1 2 3\n"),
              "t.csv:1: no header names the columns, and there are too few for TreeQSM's order: radius "
              "length start(3) "
              "axis(3) parent extension");
    EXPECT_EQ(error("1 2 3 4 5 6 7 8 9 10\n"),
              "t.csv:1: no header names the columns, and columns 6 to 8 are not an axis of length 1 as in "
              "TreeQSM's order");
}

constexpr const char* kRows = "0,0.5,1,2,3,1,2,5,2,0,0,1\n1,0.25,1,2,5,2,2,5,1,1,0,0\n";

TEST(CylinderTable, ReadsAnyNamesOfCoordinates) {
    const auto read = [](const std::string& start, const std::string& end, const std::string& axis) {
        return parse_cylinders("parent,radius," + start + "," + end + ",length," + axis + "\n" + kRows,
                               "t.csv");
    };
    expect_two_cylinders(read("start_1,start_2,start_3", "u,v,w", "axis_1,axis_2,axis_3"));
    expect_two_cylinders(read("start.1,start.2,start.3", "u,v,w", "axis.1,axis.2,axis.3"));
    expect_two_cylinders(read("start1,start2,start3", "u,v,w", "axis1,axis2,axis3"));
    expect_two_cylinders(read("start_0,start_1,start_2", "u,v,w", "axis_0,axis_1,axis_2"));
    expect_two_cylinders(read("Start X,Start Y,Start Z", "u,v,w", "axisX,axisY,axisZ"));
    expect_two_cylinders(read("start.x,start.y,start.z", "u,v,w", "Axis_X (m),Axis_Y (m),Axis_Z (m)"));
    expect_two_cylinders(read("x_start,y_start,z_start", "x_end,y_end,z_end", "u,v,w"));
    expect_two_cylinders(read("start_1,start_2,start_3", "end_1,end_2,end_3", "u,v,w"));
}

TEST(CylinderTable, ReadsDiametersAsRadii) {
    expect_two_cylinders(
        parse_cylinders("ID;parentID;startX;startY;startZ;endX;endY;endZ;Diameter (m)\n"
                        "0;-1;1;2;3;1;2;5;1\n1;0;1;2;5;2;2;5;0,5\n",
                        "t.csv"));
}

TEST(CylinderTable, ConvertsTheUnitsInColumnNames) {
    const std::string rows = "0;1;2;3;0;0;1;50;2000\n1;1;2;5;1;0;0;25;1000\n";
    expect_two_cylinders(parse_cylinders(
        "parent;startX (m);startY (m);startZ (m);ax;ay;az;radius [cm];length (mm)\n" + rows, "t.csv"));
    expect_two_cylinders(
        parse_cylinders("parent;startX;startY;startZ;ax;ay;az;radius (cm);length (mm)\n" + rows, "t.csv"));
    // Nothing is converted if all have the same unit, or if brackets contain something else.
    const auto radius = [](const std::string& start, const std::string& name) {
        return parse_cylinders(
                   "parent;" + start + ";startY;startZ;endX;endY;endZ;" + name + "\n0;1;2;3;4;5;6;7;7\n",
                   "t.csv")
            .cylinders[0]
            .radius;
    };
    EXPECT_EQ(radius("startX (mm)", "radius (mm)"), 7);
    EXPECT_EQ(radius("startX", "radius (fitted)"), 7);
    EXPECT_EQ(radius("startX", "radius ("), 7);
    EXPECT_EQ(radius("length (mm);startX", "radius (mm)"), 7);  // the start is in mm too
}

/// Returns the values of an attribute; empty if it does not exist.
std::vector<double> get_values(const RawCylinders& read, std::string_view name) {
    for (const RawAttribute& a : read.attributes)
        if (a.name == name) return a.values;
    return {};
}

TEST(CylinderTable, PreservesOrdersAndBranches) {
    const auto read = parse_cylinders(
        "type, ID, parentID, startX, startY, startZ, endX, endY, endZ, radius, volume,branchOrder, branchID\n"
        "cylinder, 0, -1, 1, 2, 3, 1, 2, 5, 0.5, 9, 0, 4\ncylinder, 1, 0, 1, 2, 5, 2, 2, 5, 0.25, 9, 1, 7\n",
        "t.csv");
    expect_two_cylinders(read);
    EXPECT_EQ(get_values(read, "order"), (std::vector<double>{0, 1}));
    EXPECT_EQ(get_values(read, "axis"), (std::vector<double>{4, 7}));
}

TEST(CylinderTable, ReadsOrdersByTheVersionOfTheTable) {
    // After the extension: branch, order, position; or added, unmodified radius, branch, order, position.
    const std::vector<double> orders{0, 1}, branches{3, 8};
    for (const char* text : {"0.5 2 1 2 3 0 0 1 0 2 3 0 1 0\n0.25 1 1 2 5 1 0 0 1 0 8 1 1 0\n",
                             "0.5 2 1 2 3 0 0 1 0 2 0 .5 3 0 1\n0.25 1 1 2 5 1 0 0 1 0 0 .25 8 1 1\n",
                             "0.5 2 1 2 3 0 0 1 0 2 0 1 3 0 1\n0.25 1 1 2 5 1 0 0 1 0 0 2 8 1 1\n"}) {
        const auto read = parse_cylinders(text, "t.txt");
        expect_two_cylinders(read);
        EXPECT_EQ(get_values(read, "order"), orders) << text;
        EXPECT_EQ(get_values(read, "axis"), branches) << text;
    }
    EXPECT_TRUE(parse_cylinders("0.5 2 1 2 3 0 0 1 0 2\n", "t.txt").attributes.empty());
}

TEST(CylinderTable, OmitsIncompleteOrders) {
    const SkeletonFile file = parse_skeleton(
        "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius,branchOrder,branchID\n"
        "0,-1,0,0,0,0,0,2,.5,0,1\n1,0,0,0,2,1,0,4,.25,NA,1\n",
        "t.csv");
    EXPECT_TRUE(file.attribute("order").empty());
    EXPECT_EQ(file.attribute("axis").size(), file.skeleton.size());
}

TEST(CylinderTable, RowsMayEndBeforeTheirOrders) {
    const auto read = parse_cylinders(
        "parent radius startX startY startZ endX endY endZ branch_order treeID\n0 .5 1 2 3 1 2 5\n1 .25 1 2 "
        "5 2 2 5\n",
        "t.txt");
    expect_two_cylinders(read);
}

TEST(CylinderTable, NodesHaveTheOrderOfTheirCylinder) {
    const SkeletonFile file = parse_skeleton(
        "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius,branch_order\n"
        "0,-1,0,0,0,0,0,4,.5,0\n1,0,0,0,4,0,0,8,.4,0\n2,0,0,0,2,6,0,2,.2,1\n",
        "t.csv");
    const std::span<const float> order = file.attribute("order");
    ASSERT_EQ(order.size(), file.skeleton.size());
    for (const NodeId n : nodes(file.skeleton))
        EXPECT_EQ(order[n.index()], file.skeleton.position(n).x > 1 ? 1 : 0) << n.index();
}

TEST(CylinderTable, IdsAreUniquePerTree) {
    const std::string head = "tree_id,ID,parentID,startX,startY,startZ,endX,endY,endZ,radius\n";
    const auto read = parse_cylinders(head +
                                          "7,1,0,0,0,0,0,0,2,.5\n9,1,0,5,0,0,5,0,2,.5\n"
                                          "7,2,1,0,0,2,0,0,3,.4\n9,2,1,5,0,2,5,0,3,.4\n",
                                      "t.csv");
    ASSERT_EQ(read.cylinders.size(), 4u);
    EXPECT_EQ(read.cylinders[2].parent, read.cylinders[0].id);
    EXPECT_EQ(read.cylinders[3].parent, read.cylinders[1].id);
    EXPECT_EQ(get_values(read, "tree"), (std::vector<double>{7, 9, 7, 9}));
    const auto named = parse_cylinders(head + "oak,1,0,0,0,0,0,0,2,.5\nelm,1,0,5,0,0,5,0,2,.5\n", "t.csv");
    EXPECT_EQ(get_values(named, "tree"), (std::vector<double>{1, 2}));
    EXPECT_EQ(
        error_of<InvalidInput>(
            [&] { parse_cylinders(head + "7,1,0,0,0,0,0,0,2,.5\n7,1,0,5,0,0,5,0,2,.5\n", "t.csv"); }),
        "t.csv, line 3: the id 1 was used before in this tree; give every cylinder of a tree a unique id");
}

TEST(CylinderTable, TreesWithoutIdsHaveParentsByRowOrByTree) {
    const std::string head = "tree,parent,radius,start_1,start_2,start_3,end_1,end_2,end_3\n";
    const auto own = parse_cylinders(head +
                                         "1,0,.5,0,0,0,0,0,2\n1,1,.4,0,0,2,0,0,3\n"
                                         "2,0,.5,5,0,0,5,0,2\n2,1,.4,5,0,2,5,0,3\n",
                                     "t.csv");
    EXPECT_EQ(own.cylinders[3].parent, own.cylinders[2].id);
    const auto all = parse_cylinders(head +
                                         "1,0,.5,0,0,0,0,0,2\n1,1,.4,0,0,2,0,0,3\n"
                                         "2,0,.5,5,0,0,5,0,2\n2,3,.4,5,0,2,5,0,3\n",
                                     "t.csv");
    EXPECT_EQ(all.cylinders[3].parent, all.cylinders[2].id);
    EXPECT_EQ(
        parse_skeleton(head + "1,0,.5,0,0,0,0,0,2\n2,0,.5,5,0,0,5,0,2\n", "t.csv").skeleton.tree_count(), 2u);
}

TEST(CylinderTable, TreegraphCylindersEndAtTheirParents) {
    // Each cylinder starts at its own node and ends at that of its parent; node 0, the base, has none.
    const SkeletonFile file = parse_skeleton(
        "p1,p2,sx,sy,sz,ax,ay,az,radius,length,nbranch,is_tip\n"
        "3,0,0,0,2,0,0,-1,0.5,2,0,False\n5,3,0,0,3,0,0,-1,0.4,1,0,True\n8,0,1,0,0,-1,0,0,0.2,1,1,True\n",
        "t.csv");
    EXPECT_EQ(file.skeleton.tree_count(), 1u);
    EXPECT_EQ(file.report.missing_parents, 0u);
    EXPECT_EQ(file.skeleton.position(NodeId(0)), Vec3(0, 0, 0));
    EXPECT_EQ(file.skeleton.bounds().high.z, 3.4f);
}

TEST(CylinderTable, ReadsTheTableInTreegraphJson) {
    const std::string cylinders =
        R"({"p1":{"0":1,"1":2},"p2":{"0":0,"1":1},"sx":{"0":1.0,"1":2.0},"sy":{"0":2.0,"1":2.0},)"
        R"("sz":{"0":5.0,"1":5.0},"ax":{"0":0,"1":-1},"ay":{"0":0,"1":0},"az":{"0":-1,"1":0},)"
        R"("radius":{"0":0.5,"1":0.25},"length":{"0":2.0,"1":1.0},"nbranch":{"0":0,"1":1},)"
        R"("branch_order":{"0":0,"1":1},"is_tip":{"0":false,"1":true},"vol":{"0":null,"1":0.2}})";
    const auto quoted = [](std::string text) {
        for (std::size_t at = 0; (at = text.find('"', at)) != text.npos; at += 2) text.insert(at, 1, '\\');
        return text;
    };
    const std::string json = R"({"name": "oak", "tree": "{}", "cyls": ")" + quoted(cylinders) + R"("})";
    const auto read = parse_treegraph(json, "t.json");
    ASSERT_TRUE(read.has_value());
    expect_two_cylinders(*read);
    EXPECT_EQ(get_values(*read, "order"), (std::vector<double>{0, 1}));
    EXPECT_EQ(parse_skeleton(json, "t.json").declared->cylinders, 2u);

    EXPECT_FALSE(parse_treegraph(R"({"name": "cyls"})", "t.json").has_value());
    EXPECT_FALSE(parse_treegraph(R"({"cyls": 3)", "t.json").has_value());
    const auto error = [](const std::string& table) {
        return error_of<InvalidInput>([&] { parse_treegraph(R"({"cyls": ")" + table + R"("})", "t.json"); });
    };
    EXPECT_EQ(error("[1"),
              "t.json: the table 'cyls' is not JSON of columns by name, each with a value for every row");
    EXPECT_EQ(error("{}"), error("[1"));
    EXPECT_EQ(error(quoted(R"({"p1":{"0":[1]}})")), error("[1"));
    EXPECT_EQ(error(quoted(R"({"p1":{"0":1},"p2":{}})")),
              "t.json: the table 'cyls' has columns of different lengths");
    EXPECT_NE(error(quoted(R"({"p1":{"0":1}})")).find("no column of the header contains the radius"),
              std::string::npos);
}

TEST(CylinderTable, CylindersWithoutParentsJoinTheNearest) {
    // A trunk of two cylinders, a lateral that starts at the side of the first one, and its continuation over
    // a gap.
    const std::string head = "name , startX, startY, startZ, endX, endY, endZ, volume, radius, length, \n";
    const std::string rows =
        "oak,.2,0,1.2,1,0,1.5,0,.05,1\noak,0,0,0,0,0,2,0,.2,2\noak,1.1,0,1.5,2,0,2,0,.04,1\n"
        "oak,0,0,2,0,0,4,0,.15,2\n";
    const auto read = parse_cylinders(head + rows, "t.csv");
    ASSERT_EQ(read.cylinders.size(), 4u);
    EXPECT_EQ(read.cylinders[0].parent, 2);
    EXPECT_EQ(read.cylinders[1].parent, -1);
    EXPECT_EQ(read.cylinders[2].parent, 1);
    EXPECT_EQ(read.cylinders[3].parent, 2);
    ASSERT_EQ(read.notes.size(), 1u);
    EXPECT_EQ(read.notes[0],
              "no column specifies the parents of cylinders: each was joined to the closest one at its "
              "start; 1 remain without a parent");
    // Another tree at a great distance.
    EXPECT_EQ(parse_cylinders(head + rows + "elm,50,0,0,50,0,3,0,.1,3\n", "t.csv").cylinders[4].parent, -1);
}

TEST(CylinderTable, CylindersWithoutParentsMayCoincideOrFormARing) {
    const std::string head = "startX,startY,startZ,endX,endY,endZ,radius\n";
    // A ring, cylinders at the same position, and without radius.
    const auto ring = parse_cylinders(head + "0,0,0,1,0,0,.1\n1,0,0,0,1,0,.1\n0,1,0,0,0,0,.1\n", "t.csv");
    int roots = 0;
    for (const RawCylinder& c : ring.cylinders) roots += c.parent < 0;
    EXPECT_EQ(roots, 1);
    std::string same = head;
    for (int i = 0; i < 2000; ++i) same += "1,1,1,1,1,1,0\n";
    EXPECT_EQ(parse_cylinders(same, "t.csv").cylinders.size(), 2000u);
    for (const char* bad : {"nan", "inf", "1e300"}) {
        const std::string text = head + "0,0,0,1,0,0,.1\n" + bad + ",0,0,0,1,0,.1\n";
        EXPECT_NE(
            error_of<InvalidInput>([&] { parse_skeleton(text, "t.csv"); }).find("t.csv, line 3: a coord"),
            std::string::npos);
    }
}

constexpr const char* kHead =
    "radius (m)\tlength (m)\tstart_point\taxis_direction\tparent\textension\tbranch\tbranch_order\t"
    "position_in_branch\tmad\tSurfCov\tadded\tUnmodRadius (m)\n";
constexpr const char* kBranches =
    "order\tparent\tdiameter (m)\tvolume (L)\tarea (m^2)\tlength (m)\n0\t0\t1\t2\t3\t4\n1\t1\t1\t2\t3\t4\n";
constexpr const char* kFigures = "TotalVolume\t 12.5\nDBHqsm\t 0.4\n";

TEST(CylinderTable, SkipsOtherTablesAndLists) {
    const std::string cylinders = std::string(kHead) + kTreeQsmRow;
    for (const std::string& text : {cylinders + kBranches + kFigures, cylinders + kFigures + kBranches,
                                    cylinders + "\n# branches\n" + kBranches, kFigures + cylinders,
                                    kBranches + cylinders + kFigures, "Tree 12\n" + cylinders + "The end\n",
                                    std::string("Cylinders\n") + kTreeQsmRow + "Branches\n0 1 2\n"}) {
        SCOPED_TRACE(text);
        const auto read = parse_cylinders(text, "t.txt");
        expect_two_cylinders(read);
        ASSERT_EQ(read.notes.size(), 1u);
        EXPECT_NE(read.notes[0].find("contain no cylinders and were skipped"), std::string::npos);
        EXPECT_EQ(parse_skeleton(text, "tree.txt").format, "cylinders");
    }
    EXPECT_EQ(parse_cylinders(cylinders + kBranches + kFigures, "t.txt").notes[0],
              "5 lines, from line 4 on, contain no cylinders and were skipped");
}

TEST(CylinderTable, TablesWithoutNamesEndAtADifferentWidth) {
    const std::string cylinders = "0.5 2 1 2 3 0 0 1 0 2 1 0 1 0\n0.25 1 1 2 5 1 0 0 1 0 2 1 1 0\n";
    const std::string branches = "0 0 492 3.4 0 1.3\n1 1 209 2.4 45 1.7\n", figures = "1.12\n0.49\n";
    expect_two_cylinders(parse_cylinders(
        "# Cylinder data\n" + cylinders + "# Branch data\n" + branches + "# Tree data\n" + figures, "t.txt"));
    expect_two_cylinders(parse_cylinders(cylinders + branches + figures, "t.txt"));
    expect_two_cylinders(parse_cylinders(cylinders + "\n" + "0 0 492 3.4 0 1.3\n", "t.txt"));
    // A truncated row is not a table.
    const auto error = [](const std::string& text) {
        return error_of<InvalidInput>([&] { parse_cylinders(text, "t.txt"); });
    };
    EXPECT_EQ(error(cylinders + "0.25 1 1 2 5 1\n"),
              "t.txt:3: the row has 6 values, but the rows before it have 14");
    EXPECT_EQ(error(cylinders + "0.25 1 1 2 5 1\n" + cylinders), error(cylinders + "0.25 1 1 2 5 1\n"));
    EXPECT_EQ(error(cylinders + "0.25 1 1 2 5 1 0 0 1 0\n"),
              "t.txt:3: the row has 10 values, but the rows before it have 14");
}

TEST(CylinderTable, SeveralTablesAreModels) {
    const std::string one = std::string(kHead) + kTreeQsmRow;
    const std::string text =
        std::string(kHead) + "1\t1\t7\t7\t7\t0\t0\t1\t0\t0\t1\t0\t1\t0\t0\t0\t1\n" + kBranches + one;
    EXPECT_EQ(error_of<InvalidInput>([&] { parse_cylinders(text, "t.txt"); }),
              "t.txt: it contains 2 models; choose one with the option model, 1 to 2");
    expect_two_cylinders(parse_cylinders(text, "t.txt", 2));
    EXPECT_EQ(parse_cylinders(text, "t.txt", 1).cylinders.size(), 1u);
    EXPECT_EQ(parse_skeleton(text, "t.txt", {.model = 2}).models, 2u);
    EXPECT_EQ(error_of<InvalidInput>([&] { parse_skeleton(text, "t.txt", {.model = 3}); }),
              "t.txt: there is no model 3; the file contains 2");
    EXPECT_EQ(error_of<InvalidInput>([&] { parse_skeleton(one, "t.txt", {.model = 2}); }),
              "t.txt: there is no model 2; the file contains 1");
}

}  // namespace
}  // namespace coppice
