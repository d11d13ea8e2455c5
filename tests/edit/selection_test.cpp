#include "coppice/edit/selection.h"

#include <gtest/gtest.h>

#include "edit/trees.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;
using test::id;
using test::ids;

NodeSet of(const EditableTree& tree, std::string_view text) {
    const Solid ball = sphere({0, 0, 1}, {.radius = 1.2f});
    return selected(tree, parse_selection(text),
                    [&](const std::string& name) { return name == "ball" ? &ball : nullptr; });
}

TEST(Selection, SelectsNodesByEveryPredicate) {
    const EditableTree tree(test::stem_with_branches());
    EXPECT_EQ(of(tree, "all").size(), 9u);
    EXPECT_EQ(of(tree, "roots"), ids({0}));
    EXPECT_EQ(of(tree, "tips"), ids({3, 6, 7, 8}));
    EXPECT_EQ(of(tree, "forks"), ids({1, 2, 5}));
    EXPECT_EQ(of(tree, "4"), ids({4}));
    EXPECT_EQ(of(tree, "id(7,2-4)"), ids({2, 3, 4, 7}));
    EXPECT_EQ(of(tree, "subtree(4)"), ids({4, 5, 6, 7}));
    EXPECT_EQ(of(tree, "axis(5)"), ids({4, 5, 6}));  // 6 is thicker than 7
    EXPECT_EQ(of(tree, "axis(2)"), ids({0, 1, 2, 3}));
    EXPECT_EQ(of(tree, "path(7)"), ids({0, 1, 4, 5, 7}));
    EXPECT_EQ(of(tree, "children(1,5)"), ids({2, 4, 6, 7}));
    EXPECT_EQ(of(tree, "tree(7)").size(), 9u);
    EXPECT_EQ(of(tree, "order(0)"), ids({0, 1, 2, 3}));
    EXPECT_EQ(of(tree, "order(1,)"), ids({4, 5, 6, 7, 8}));
    EXPECT_EQ(of(tree, "order(2)"), ids({7}));
    EXPECT_EQ(of(tree, "radius(0.03,0.05)"), ids({4, 5, 6}));  // bounds are included, as floats
    EXPECT_EQ(of(tree, "radius(,0.02)"), ids({7, 8}));
    EXPECT_EQ(of(tree, "height(2,)"), ids({2, 3, 8}));
    EXPECT_EQ(of(tree, "box(-2,-1,0.5, 1.5,1,2.5)"), ids({1, 2, 4, 8}));
    EXPECT_EQ(of(tree, "solid(ball)"), ids({0, 1, 2, 4}));
    EXPECT_EQ(of(tree, "near(2,1.4,1)"), ids({7}));
}

TEST(Selection, CombinesPredicates) {
    const EditableTree tree(test::stem_with_branches());
    EXPECT_EQ(of(tree, "subtree(4) & !tips"), ids({4, 5}));
    EXPECT_EQ(of(tree, "tips and not subtree(4) or roots"), ids({0, 3, 8}));
    EXPECT_EQ(of(tree, "tips & (subtree(4) | 3)"), ids({3, 6, 7}));
    EXPECT_EQ(of(tree, "!!roots"), ids({0}));
    EXPECT_TRUE(of(tree, "roots & tips").empty());
}

TEST(Selection, SelectsNodesByPositionAndAttributes) {
    const EditableTree tree(test::stem_with_branches());  // 4 m along x
    EXPECT_EQ(of(tree, "at(2.05,0,1,1,0.05)"), ids({5}));
    EXPECT_EQ(of(tree, "at(2,0,1,1,0.04,0.67,3)"), ids({5}));
    EXPECT_EQ(of(tree, "at(2.05,0,1,1,0.05,0.67,3,0.06,77)"), ids({5}));
    EXPECT_EQ(
        error_of([&] { of(tree, "at(2.05,0,1,1,0.05,0.67,3,0.04)"); }),
        "no node is like at(2.05,0,1,1,0.05,0.67,3,0.04): no node is within 0.04 m; the nearest is node 5 "
        "at 2,0,1, 0.05 m away");
    EXPECT_EQ(error_of([&] { of(tree, "at(2,0,1,0,0.04)"); }),
              "no node is like at(2,0,1,0,0.04): the order of the axis there is different; the nearest is "
              "node 5 at "
              "2,0,1, 0 m away");
    EXPECT_THROW(of(tree, "at(2,0,1,1,0.04) | at(2,0,1,1,0.1)"), InvalidInput);
}

TEST(Selection, NestedSelectionsMatchSelectionsById) {
    const EditableTree tree(test::stem_with_branches());
    EXPECT_EQ(of(tree, "subtree(near(1,0,1))"), of(tree, "subtree(4)"));
    EXPECT_EQ(of(tree, "subtree(4|5|7)"), of(tree, "subtree(4)"));
    EXPECT_EQ(of(tree, "axis(at(3,0,1,1,0.03))"), of(tree, "axis(6)"));
    EXPECT_EQ(of(tree, "path(tips)").size(), 9u);
    EXPECT_EQ(of(tree, "path(near(2,1,1))"), of(tree, "path(7)"));
    EXPECT_EQ(of(tree, "children(forks)"), of(tree, "children(1,2,5)"));
    EXPECT_EQ(of(tree, "tree(tips)").size(), 9u);
    EXPECT_EQ(of(tree, "subtree(radius(5,6))"), NodeSet{});
    EXPECT_EQ(of(tree, "subtree(id(4))"), of(tree, "subtree(4)"));
}

TEST(Selection, ParsesItsOwnText) {
    for (const char* text :
         {"all", "4", "id(1,3-5,9)", "subtree(4)&!tips", "(tips|roots)&!(order(1,)|solid(a.b-c))",
          "radius(,0.25)", "order(2)", "order(,2)", "near(1,-2.5,3e-05)", "box(0,0,0,1,2,3)",
          "at(1,-2.5,3e-05,2,0.1)", "axis(at(0,0,1,0,0.1,0.5,7.25,0.03,12))", "subtree(tips&!order(0))"}) {
        EXPECT_EQ(to_text(parse_selection(text)), text);
        EXPECT_EQ(parse_selection(to_text(parse_selection(text))), parse_selection(text));
    }
}

TEST(Selection, ForEachIdChangesItsIds) {
    Selection s = parse_selection("subtree(4) & !(id(5-6) | tips)");
    for_each_id(s, [](StableId& n) { n = StableId(n.index() + 10); });
    EXPECT_EQ(to_text(s), "subtree(14)&!(id(15-16)|tips)");
}

TEST(Selection, ReportsSyntaxErrors) {
    EXPECT_EQ(error_of([] { parse_selection("subtree 4"); }),
              "the selection 'subtree 4' needs ( after subtree at its '4'");
    EXPECT_EQ(
        error_of([] { parse_selection("radius(0.1)"); }),
        "the selection 'radius(0.1)' needs two numbers separated by a comma, one of which may be left out "
        "at its ')'");
    EXPECT_EQ(error_of([] { parse_selection("tips roots"); }),
              "the selection 'tips roots' needs & or | at its 'roots'");
    EXPECT_NE(error_of([] { parse_selection("leaves"); }).find("needs an id, or one of all, roots"),
              std::string::npos);
    EXPECT_NE(error_of([] { parse_selection(std::string(100, '(')); }).find("nested at most 64"),
              std::string::npos);
    EXPECT_NE(error_of([] { parse_selection("id(0-4000000000)"); }).find("at most 1000000"),
              std::string::npos);
    for (const char* text : {"at(1,2,3,1)", "at(1,2,3,1,0)", "at(1,2,3,0.5,1)", "at(1,2,3,1,1,0.5)",
                             "at(1,2,3,1,1,2,3)", "at(1,2,3,1,1,0.5,3,0)", "at(1,2,3,1,1,0.5,3,1,-1)"})
        EXPECT_TRUE(error_of([&] { parse_selection(text); }).starts_with("at() requires x,y,z,order,radius"))
            << text;
    EXPECT_NE(error_of([] { parse_selection("id(9-5)"); }).find("the smaller id comes first"),
              std::string::npos);
}

TEST(Selection, ReportsMissingNodesAndSolids) {
    const EditableTree tree(test::stem_with_branches());
    EXPECT_EQ(error_of([&] { of(tree, "subtree(40)"); }),
              "there is no node 40; 9 ids from 0 to 8 are in use, and select lists them");
    EXPECT_EQ(error_of([&] { of(tree, "solid(crown)"); }),
              "there is no solid 'crown' to select by; create it first, as in: sphere crown");
    EXPECT_EQ(error_of([&] { selected_node(tree, parse_selection("tips")); }),
              "'tips' contains 4 nodes where one is needed; name its id, or use near(x,y,z)");
}

TEST(Selection, UsesWorldSpace) {
    Skeleton far({NodeId::none(), NodeId(0)}, {{0, 0, 0}, {0, 0, 1}}, {0.1f, 0.1f}, {500'000, 0, 100});
    const EditableTree tree(far);
    EXPECT_EQ(of(tree, "height(100.5,)"), ids({1}));
    EXPECT_EQ(of(tree, "near(500000,0,100.1)"), ids({0}));
    EXPECT_EQ(of(tree, "box(499999,-1,99,500001,1,100.5)"), ids({0}));
}

}  // namespace
}  // namespace coppice
