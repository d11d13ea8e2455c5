#include <gtest/gtest.h>

#include <algorithm>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/skeleton/measure.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;

/// A header with the classes P, A, U, E at scales 1 to 4; the last row names the columns.
std::string head(std::string_view features, std::string_view columns) {
    std::string text =
        "# by hand\nCODE :\tFORM-A\n\nCLASSES:\nSYMBOL\tSCALE\tDECOMPOSITION\tINDEXATION\tDEFINITION\n"
        "$\t0\tFREE\tFREE\tIMPLICIT\nP \t1\tCONNECTED\tFREE\tEXPLICIT\nA\t2\t<-LINEAR\tFREE\tEXPLICIT\n"
        "U\t3\tFREE\tFREE\tEXPLICIT\nE\t4\tNONE\tFREE\tEXPLICIT\nDESCRIPTION :\nLEFT\tRIGHT\tRELTYPE\tMAX\n"
        "U\tU\t<\t1\nE\tE\t+\t?\n\nFEATURES:\nNAME\tTYPE\n\n";
    for (std::size_t at = 0; at < features.size();) {
        const std::size_t end = std::min(features.find(' ', at), features.size());
        text += fmt::format("{}\tREAL\n", features.substr(at, end - at));
        at = end + 1;
    }
    return text + "\nMTG :\n\n" + std::string(columns) + "\n";
}

const std::string kPlaced = head("XX YY ZZ radius", "ENTITY-CODE\t\t\tXX\tYY\tZZ\tradius");

SkeletonFile read(const std::string& text) { return parse_skeleton(text, "t.mtg"); }

/// "0(0 0 0) 0>1(0 0 1)": the parent and the position of each node.
std::string tree(const Skeleton& s) {
    std::string text;
    for (const NodeId n : nodes(s)) {
        const Vec3d p = s.origin() + Vec3d(s.position(n));
        text += s.is_root(n) ? fmt::format("{}{}", text.empty() ? "" : " ", n.index())
                             : fmt::format(" {}>{}", s.parent(n).index(), n.index());
        text += fmt::format("({:g} {:g} {:g})", p.x, p.y, p.z);
    }
    return text;
}

std::string read_tree(const std::string& rows) { return tree(read(kPlaced + rows).skeleton); }

TEST(Mtg, RowsContinueThePreviousOrTheirOwnColumn) {
    const SkeletonFile file = read(kPlaced +
                                   "/P1\n"
                                   "^/A1/U1/E1\t\t\t0\t0\t0\t0.5\n"
                                   "^<E2\t\t\t0\t0\t1\t0.4\n"
                                   "\t+A2/U1/E1\t\t1\t0\t1\t0.2\n"
                                   "\t^<E2\t\t2\t0\t1\t0.1\n"
                                   "\t\t+A3/U1/E1\t2\t1\t1\t0.1\n"
                                   "^<U2/E3\t\t\t0\t0\t2\t0.3\n");
    EXPECT_EQ(file.format, "mtg");
    EXPECT_EQ(tree(file.skeleton), "0(0 0 0) 0>1(0 0 1) 1>2(1 0 1) 2>3(2 0 1) 3>4(2 1 1) 1>5(0 0 2)");
    EXPECT_EQ(file.skeleton.radius(NodeId(1)), 0.4f);
    EXPECT_TRUE(std::ranges::equal(file.attribute("order"), std::vector<float>{0, 0, 1, 1, 2, 0}));
    EXPECT_TRUE(std::ranges::equal(file.attribute("axis"), std::vector<float>{0, 0, 1, 1, 2, 0}));
    ASSERT_EQ(file.notes.size(), 1u);
    EXPECT_EQ(file.notes[0],
              "MTG specifies no unit: lengths were assumed to be in metres; set scale for another unit");
}

TEST(Mtg, ReadsAllNotationsOfEntities) {
    const std::string expected = "0(0 0 0) 0>1(0 0 1) 1>2(1 0 1) 1>3(0 0 2)";
    // A branch named in a separate row, its continuation in the next column, then the stem continues.
    EXPECT_EQ(read_tree("/P1\n\t/A1/U1\n\t^/E1\t\t0\t0\t0\n\t^<E2\t\t0\t0\t1\n\t^+A2\n\t\t/U1/E1\t1\t0\t1\n"
                        "\t^<E3\t\t0\t0\t2\n"),
              expected);
    // Two such branches at the same node.
    EXPECT_EQ(
        read_tree("/P1\n\t/A1/U1/E1\t\t0\t0\t0\n\t^+A2\n\t\t/U1/E1\t1\t0\t0\n\t^+A3\n\t\t/U1/E1\t0\t1\t0\n"),
        "0(0 0 0) 0>1(1 0 0) 0>2(0 1 0)");
    // Full names.
    EXPECT_EQ(
        read_tree(
            "/P1/A1/U1/E1\t\t\t0\t0\t0\n/P1/A1/U1/E1<E2\t\t\t0\t0\t1\n/P1/A1/U1/E1<E2+A2/U1/E1\t\t\t1\t0\t1\n"
            "/P1/A1/U1/E1<E2<E3\t\t\t0\t0\t2\n"),
        expected);
    // An alias.
    const std::string alias = "\nAlias\tALPHA\n\nMTG:\nTOPO\t\tAlias\tXX\tYY\tZZ\n";
    std::string text = head("XX YY ZZ", "");
    text.resize(text.find("\nMTG :"));
    EXPECT_EQ(tree(read(text + alias +
                        "/P1/A1/U1/E1\t\t\t0\t0\t0\n^<E2\t\tfork\t0\t0\t1\n^<E3\t\t\t0\t0\t2\n"
                        "(fork)+A2/U1/E1\t\t\t1\t0\t1\n")
                       .skeleton),
              "0(0 0 0) 0>1(0 0 1) 1>2(0 0 2) 1>3(1 0 1)");
}

TEST(Mtg, ReadsUnusualFiles) {
    // Comments up to the next tab, CR LF, blanks in cells, decimal commas, rows that end early, an entity
    // observed on two days, labels without numbers, a repeated position.
    EXPECT_EQ(
        read_tree(
            "/P #the plant\r\n^/A/U/E\t# here\t\t0,0\t 0 \t0\t0,5\r\n\r\n# a line\r\n^<E\t\t\t0\t0\t0,5\r\n"
            "*\t\t\t0\t0\t1\r\n\t +A/U/E\t\t1\t0\t1\t\t\t\r\n^<E\t\t\t0\t0\t1\r\n^<E\t\t\t0\t0\t2"),
        "0(0 0 0) 0>1(0 0 1) 1>2(1 0 1) 1>3(0 0 2)");
    // Two plants.
    EXPECT_EQ(read_tree("/P1\n^/A1/U1/E1\t\t\t0\t0\t0\n^<E2\t\t\t0\t0\t1\n/P2\n^/A1/U1/E1\t\t\t5\t0\t0\n"),
              "0(0 0 0) 0>1(0 0 1) 2(5 0 0)");
    // Blanks instead of tabs.
    std::string blanks =
        kPlaced + "/P1\n /A1/U1/E1\t0 0 0 1\n ^<E2\t0 0 1 1\n   +A2/U1/E1\t1 0 1 1\n ^<E3\t0 0 2 1\n";
    std::ranges::replace(blanks, '\t', ' ');
    EXPECT_EQ(
        read_tree(
            "/P1\n\t/A1/U1/E1\t\t0\t0\t0\n\t^<E2\t\t0\t0\t1\n\t\t+A2/U1/E1\t1\t0\t1\n\t^<E3\t\t0\t0\t2\n"),
        tree(read(blanks).skeleton));
}

TEST(Mtg, BranchesStartAtInterpolatedEntities) {
    // E1 to E4 represent four entities; the branch leaves the second.
    EXPECT_EQ(read_tree("/P1/A1/U1\t\t\t0\t0\t0\n^/E1<E2\n\t+A2/U1/E1\t\t1\t0\t2\n^<E3<<E4\t\t\t0\t0\t4\n"),
              "0(0 0 0) 0>1(0 0 2) 1>2(1 0 2) 1>3(0 0 4)");
    // Without entities behind it, it is where the branch begins.
    EXPECT_EQ(read_tree("/P1/A1/U1\t\t\t0\t0\t0\n^/E1<E2\n\t+A2/U1/E1\t\t1\t0\t2\n\t^<E2\t\t2\t0\t2\n"),
              "0(0 0 0) 0>1(1 0 2) 1>2(2 0 2)");
    // Without coordinates before it, it is the root of all of them.
    EXPECT_EQ(
        read(kPlaced +
             "/P1/A1/U1/E1\n\t+A2/U1/E1\t\t1\t0\t2\n\t^<E2\t\t2\t0\t2\n\n^<E2\n\t+A3/U1/E1\t\t3\t0\t3\n")
            .skeleton.tree_count(),
        1u);
}

TEST(Mtg, CoordinatesOfComplexesAreAtTheirBaseOrTop) {
    // The coordinates of an axis at its beginning, next to its parent branch.
    EXPECT_EQ(
        read_tree("/P1/A1/U1/E1\t\t\t0\t0\t0\n^<E2\t\t\t0\t0\t4\n\t+A2\t\t0.5\t0\t4\n\t^/U1/E1\t\t3\t0\t4\n"
                  "\t^<E2\t\t5\t0\t4\n"),
        "0(0 0 0) 0>1(0 0 4) 1>2(0.5 0 4) 2>3(3 0 4) 3>4(5 0 4)");
    // Coordinates at the end of the last component of a unit: visiting them first would lead forth and back.
    EXPECT_EQ(
        read_tree("/P1/A1/U1/E1\t\t\t0\t0\t0\n^<E2\t\t\t0\t0\t4\n\t+A2\t\t5\t0\t4\n\t^/U1/E1\t\t3\t0\t4\n"
                  "\t^<E2\t\t5\t0\t4\n"),
        "0(0 0 0) 0>1(0 0 4) 1>2(3 0 4) 2>3(5 0 4)");
}

TEST(Mtg, PlantsWithoutCoordinatesAreLaidOutByLengths) {
    const std::string text =
        head("longueur diabase diasom alpha azimuth", "TOPO\t\tlongueur\tdiabase\tdiasom\talpha\tazimuth");
    const SkeletonFile file =
        read(text +
             "/P1/A1/U1\t\t4\t0.4\t0.2\n^/E1<E2\n\t+A2/U1\t2\t0.1\t0.1\n\t^/E1\n^<E3<E4\n"
             "\t+A3/U1/E1\t1\t\t0.1\t90\t180\n/P2/A1/U1\t\t1\t0.1\t0.1\n");
    const auto place = [&](std::uint32_t n) {
        return file.skeleton.origin() + Vec3d(file.skeleton.position(NodeId(n)));
    };
    ASSERT_EQ(file.skeleton.size(), 9u);
    EXPECT_EQ(file.skeleton.tree_count(), 2u);
    EXPECT_NEAR(distance(place(3), place(2)), 2, 1e-5) << "the unit's length goes to its only part";
    EXPECT_NEAR(distance(place(3), Vec3d(std::sqrt(2.0), 0, 2 + std::sqrt(2.0))), 0, 1e-5)
        << tree(file.skeleton);
    EXPECT_NEAR(distance(place(6), Vec3d(-1, 0, 4)), 0, 1e-5);
    EXPECT_NEAR(file.skeleton.radius(NodeId(0)), 0.2, 1e-6);
    EXPECT_NEAR(file.skeleton.radius(NodeId(2)), 0.15, 1e-6);
    EXPECT_NEAR(file.skeleton.radius(NodeId(5)), 0.1, 1e-6);
    EXPECT_GT(place(7).x, std::sqrt(2.0)) << "plants are placed next to each other";
    ASSERT_EQ(file.notes.size(), 2u);
    EXPECT_NE(file.notes[0].find("lengths and no coordinates"), std::string::npos);
}

TEST(Mtg, DetectsDiametersInASmallerUnit) {
    const std::string text = head("XX YY ZZ TopDia", "ENTITY-CODE\t\t\tXX\tYY\tZZ\tTopDia");
    const auto radius = [&](int diameter) {
        const SkeletonFile file =
            read(text + fmt::format("/P1/A1/U1/E1\t\t\t0\t0\t0\t{0}\n^<E2\t\t\t0\t0\t1000\t{0}\n", diameter));
        return std::pair(file.skeleton.radius(NodeId(0)), file.notes.size());
    };
    EXPECT_EQ(radius(20), std::pair(10.0f, std::size_t{1}));
    EXPECT_EQ(radius(100), std::pair(50.0f, std::size_t{1}));
    EXPECT_EQ(radius(300), std::pair(15.0f, std::size_t{2}));   // tenths
    EXPECT_EQ(radius(2000), std::pair(10.0f, std::size_t{2}));  // hundredths
}

TEST(Mtg, CompleteColumnsAreAttributes) {
    const std::string text = head("XX YY ZZ radius NbFe age", "ENTITY-CODE\t\tXX\tYY\tZZ\tradius\tNbFe\tage");
    const SkeletonFile file =
        read(text + "/P1\n^/A1/U1/E1\t\t0\t0\t0\t1\t7\t1\n^<E2\t\t0\t0\t5\t1\t8.5\tNA\n");
    ASSERT_EQ(file.attribute("nbfe").size(), 2u);
    EXPECT_EQ(file.attribute("nbfe")[1], 8.5f);
    EXPECT_TRUE(file.attribute("age").empty());
    EXPECT_TRUE(file.attribute("xx").empty());
}

TEST(Mtg, DeeplyNestedBranchesAreWrittenInFewColumns) {
    // Every node has a thick stub, which leads, and a thin branch, which continues.
    constexpr std::uint32_t kNodes = 20'000;
    std::vector<NodeId> parent{NodeId::none()};
    std::vector<Vec3> position{{0, 0, 0}};
    std::vector<float> radius{0.5f};
    for (std::uint32_t i = 1; i < kNodes; ++i) {
        const auto bearer = i % 2 == 1 ? i - 1 : i - 2;
        parent.push_back(NodeId(bearer));
        position.push_back({static_cast<float>(i), static_cast<float>(i % 2), 0});
        radius.push_back(i % 2 == 1 ? 0.5f : 0.1f);
    }
    const Skeleton s(parent, position, radius);
    const std::string text = encode_skeleton(s, {.format = SkeletonFormat::mtg});
    EXPECT_LT(text.size(), 100u * kNodes);
    const Skeleton back = read(text).skeleton;
    EXPECT_TRUE(std::ranges::equal(back.parents(), s.parents()));
    EXPECT_TRUE(std::ranges::equal(back.positions(), s.positions()));
}

TEST(Mtg, ReportsErrors) {
    const auto error = [](const std::string& text) { return error_of([&] { read(text); }); };
    EXPECT_EQ(error("CODE: FORM-A\n"),
              "t.mtg: this is not an MTG file: it needs a section MTG with a first line, ENTITY-CODE or "
              "TOPO, that names the columns");
    EXPECT_EQ(error(head("diam", "TOPO\tdiam") + "/P1/A1<A2\t3\n"),
              "t.mtg: there are no nodes: the plants have neither coordinates (columns XX, YY and ZZ) nor "
              "lengths (Length), so that their shape is unknown");
    EXPECT_EQ(error(kPlaced + "/P1/X1\n"), "t.mtg:27: the class of 'X1' is not among the CLASSES");
    EXPECT_EQ(error(kPlaced + "/P1/A1\n\tE1\n"), "t.mtg:28: 'E1' does not begin with one of / < + ^");
    EXPECT_EQ(error(kPlaced + "<A1\n"),
              "t.mtg:27: the first entity must be a component of the scene: begin it with /");
    EXPECT_EQ(error(kPlaced + "(a)/A1\n"), "t.mtg:27: no entity has the alias 'a'");
    EXPECT_EQ(error(kPlaced + "(a/A1\n"), "t.mtg:27: '(a/A1' lacks its ')'");
    EXPECT_EQ(
        error(kPlaced + "/P1/A1<<A4000000000\t\t\t0\t0\t0\n"),
        "t.mtg:27: ranges imply more entities than a file of this size can contain; check their numbers");
    EXPECT_EQ(error("CODE: FORM-A\nCLASSES:\nP 1000\n"),
              "t.mtg:3: the scale of class 'P' is '1000'; it must be a whole number from 0 to 64");
    EXPECT_EQ(error(kPlaced + "/P1/A1/U1/E1\t\t\tinf\t0\t0\n"),
              "t.mtg, line 27: a coordinate is not a finite number");
}

TEST(Mtg, IsRecognizedByItsContent) {
    EXPECT_EQ(format_of_content(kPlaced), SkeletonFormat::mtg);
    EXPECT_EQ(format_of_content("CODE:\tFORM-A\n"), SkeletonFormat::mtg);
    EXPECT_EQ(format_of_content("CODE\tNAME\n1\t2\n"), std::nullopt);
    EXPECT_EQ(format_of_extension("a.MTG"), SkeletonFormat::mtg);
}

TEST(Mtg, StopsWhenCancelled) {
    std::stop_source stop;
    stop.request_stop();
    EXPECT_THROW(parse_skeleton(kPlaced + "/P1\n", "t.mtg", {}, {.stop = stop.get_token()}), Cancelled);
}

}  // namespace
}  // namespace coppice
