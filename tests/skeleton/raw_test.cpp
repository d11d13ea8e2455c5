#include "coppice/skeleton/raw.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "coppice/base/error.h"
#include "coppice/base/random.h"
#include "coppice/skeleton/prepare.h"
#include "errors.h"

namespace coppice {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();

template <class Records>
std::string refusal(const Records& records) {
    return test::error_of([&] { repair(records, "tree.txt"); });
}

TEST(RepairNodes, ValidTreeIsUnchanged) {
    const RepairResult r =
        repair(std::vector<RawNode>{{1, -1, {0, 0, 0}, 2, 1}, {2, 1, {0, 0, 3}, 1, 2}}, "tree.txt");
    ASSERT_EQ(r.skeleton.size(), 2u);
    EXPECT_EQ(r.skeleton.parent(NodeId(1)), NodeId(0));
    EXPECT_EQ(r.skeleton.position(NodeId(1)), Vec3(0, 0, 3));
    EXPECT_EQ(r.skeleton.radius(NodeId(0)), 2);
    EXPECT_EQ(r.skeleton.origin(), Vec3d());
    EXPECT_EQ(r.report.total(), 0u);
}

TEST(RepairNodes, OrdersParentsFirstAndPreservesTheOrderOtherwise) {
    // In the file: 30 (child of 20), 10 (root), 20 (child of 10), 5 (child of 10).
    const RepairResult r = repair(std::vector<RawNode>{{30, 20, {0, 0, 2}, 1, 1},
                                                       {10, -1, {0, 0, 0}, 1, 2},
                                                       {20, 10, {0, 0, 1}, 1, 3},
                                                       {5, 10, {1, 0, 0}, 1, 4}},
                                  "tree.txt");
    EXPECT_EQ(r.report.reordered, 1u);  // only 30 preceded its parent
    ASSERT_EQ(r.skeleton.size(), 4u);
    EXPECT_EQ(r.skeleton.position(NodeId(2)), Vec3(0, 0, 2));
    EXPECT_EQ(r.skeleton.parent(NodeId(2)), NodeId(1));
    EXPECT_EQ(r.skeleton.parent(NodeId(3)), NodeId(0));
    EXPECT_EQ(r.source, (std::vector<std::uint32_t>{1, 2, 0, 3}));
}

TEST(RepairNodes, AcceptsIdsOfTheWholeRange) {
    const RepairResult r = repair(
        std::vector<RawNode>{
            {kMax, 7, {0, 0, 1}, 1, 1}, {kMin, kMax, {0, 0, 2}, 1, 2}, {7, kMin, {0, 0, 0}, 1, 3}},
        "tree.txt");
    EXPECT_EQ(r.skeleton.tree_count(), 1u);  // a negative parent means a root, even if a node has that id
    EXPECT_EQ(r.report.reordered, 1u);
}

TEST(RepairNodes, NodesWithoutTheirParentBecomeRoots) {
    const RepairResult r =
        repair(std::vector<RawNode>{{1, 99, {0, 0, 0}, 1, 1}, {2, -7, {5, 0, 0}, 1, 2}}, "tree.txt");
    EXPECT_EQ(r.skeleton.tree_count(), 2u);
    EXPECT_EQ(r.report.missing_parents, 1u);
}

TEST(RepairNodes, InterpolatesMissingRadiiByLength) {
    // Known: 4 at z = 0 and 1 at z = 3. Missing at z = 1: 4 + (1 - 4) / 3 = 3; beyond the last known one: 1.
    const RepairResult r = repair(std::vector<RawNode>{{1, -1, {0, 0, 0}, 4, 1},
                                                       {2, 1, {0, 0, 1}, 0, 2},
                                                       {3, 2, {0, 0, 3}, 1, 3},
                                                       {4, 3, {0, 0, 9}, kNan, 4},
                                                       {5, -1, {9, 0, 0}, -2, 5}},
                                  "tree.txt");
    EXPECT_EQ(r.report.missing_radii, 3u);
    EXPECT_FLOAT_EQ(r.skeleton.radius(NodeId(1)), 3);
    EXPECT_FLOAT_EQ(r.skeleton.radius(NodeId(3)), 1);
    EXPECT_FLOAT_EQ(r.skeleton.radius(NodeId(4)),
                    1);  // no known radius in its tree: the smallest of the file
}

TEST(RepairNodes, DefaultRadiusIsAHundredthOfTheSize) {
    const RepairResult r =
        repair(std::vector<RawNode>{{1, -1, {0, 0, 0}, 0, 1}, {2, 1, {0, 0, 5}, 0, 2}}, "tree.txt");
    EXPECT_FLOAT_EQ(r.skeleton.radius(NodeId(0)), 0.05f);
    EXPECT_EQ(r.report.missing_radii, 2u);
    const RepairResult dot = repair(std::vector<RawNode>{{1, -1, {0, 0, 0}, 0, 1}}, "tree.txt");
    EXPECT_FLOAT_EQ(dot.skeleton.radius(NodeId(0)), 0.01f);
}

TEST(RepairNodes, MergesCoincidentNodes) {
    // 2 coincides with 1 and passes its children 3 and 4, which coincide, to it; 5 is a child of 4.
    const RepairResult r = repair(std::vector<RawNode>{{1, -1, {0, 0, 0}, 1, 1},
                                                       {2, 1, {0, 0, 0}, 0.5, 2},
                                                       {3, 2, {0, 0, 2}, 0.3, 3},
                                                       {4, 2, {0, 0, 2}, 0.4, 4},
                                                       {5, 4, {0, 0, 4}, 0.2, 5}},
                                  "tree.txt");
    ASSERT_EQ(r.skeleton.size(), 3u);
    EXPECT_EQ(r.report.zero_length, 1u);
    EXPECT_EQ(r.report.coincident, 1u);
    EXPECT_FLOAT_EQ(r.skeleton.radius(NodeId(1)), 0.4f);
    EXPECT_EQ(r.skeleton.parent(NodeId(2)), NodeId(1));
}

// Radii of 1e-10 at coordinates of 1e-3, where floats are 1.2e-10 apart.
TEST(RepairNodes, SmallSkeletonsPreserveTheirDigits) {
    const Vec3d base{1.2e-3, 2e-4, -1.5e-3};
    const RepairResult r = repair(std::vector<RawNode>{{1, -1, base, 1e-10, 1},
                                                       {2, 1, base + Vec3d{3e-11, 0, 0}, 1e-10, 2},
                                                       {3, 2, base + Vec3d{0, 0, 3e-9}, 1e-10, 3}},
                                  "tree.txt");
    ASSERT_EQ(r.skeleton.size(), 3u);
    EXPECT_NEAR(r.skeleton.position(NodeId(1)).x - r.skeleton.position(NodeId(0)).x, 3e-11, 1e-15);
    EXPECT_NEAR(r.skeleton.origin().x + r.skeleton.position(NodeId(0)).x, base.x, 1e-17);
}

TEST(RepairNodes, OriginPreservesTheDigitsFarFromZero) {
    const Vec3d base{456'789.25, 5'400'000.5, 312.75};
    const RepairResult r = repair(
        std::vector<RawNode>{{1, -1, base, 0.1, 1}, {2, 1, base + Vec3d{0, 0, 0.001}, 0.1, 2}}, "tree.txt");
    // The bounding box of the balls of radius 0.1 has a diagonal of 0.347: steps of 2^-2 / 16.
    EXPECT_EQ(r.skeleton.origin(), base);
    EXPECT_EQ(r.skeleton.position(NodeId(0)), Vec3());
    EXPECT_NEAR(r.skeleton.position(NodeId(1)).z - r.skeleton.position(NodeId(0)).z, 0.001, 1e-6);
}

TEST(RepairNodes, ErrorsReportTheLine) {
    using Nodes = std::vector<RawNode>;
    EXPECT_EQ(refusal(Nodes{}), "tree.txt: there are no nodes");
    EXPECT_EQ(refusal(Nodes{{1, -1, {}, 1, 4}, {2, 1, {1, 0, 0}, 1, 5}, {1, 1, {2, 0, 0}, 1, 9}}),
              "tree.txt, line 9: the id 1 was used before (tree.txt, line 4); give every record a unique id");
    EXPECT_EQ(refusal(Nodes{{1, 2, {}, 1, 4}, {2, 1, {1, 0, 0}, 1, 5}}),
              "tree.txt, line 4: the record 1 is among its own ancestors; break the cycle");
    EXPECT_EQ(refusal(Nodes{{3, 3, {}, 1, 0}}),
              "tree.txt, record 1: the record 3 is among its own ancestors; break the cycle");
    EXPECT_EQ(refusal(Nodes{{1, -1, {0, kNan, 0}, 1, 7}}),
              "tree.txt, line 7: a coordinate is not a finite number");
    EXPECT_EQ(refusal(Nodes{{1, -1, {0, 0, 0}, kInf, 7}}),
              "tree.txt, line 7: the radius is not a finite number");
    EXPECT_EQ(refusal(Nodes{{1, -1, {0, 0, 2e30}, 1, 7}}),
              "tree.txt, line 7: a coordinate is 2e+30, beyond the limit of 1e+15; check the units");
}

TEST(RepairNodes, AcceptsAMillionNodesOfOneChainInAnyOrder) {
    constexpr std::int64_t kCount = 1'000'000;
    std::vector<RawNode> chain;
    for (std::int64_t i = kCount; i-- > 0;) {
        chain.push_back({i, i - 1, {0, 0, static_cast<double>(i)}, i % 1000 == 0 ? 1.0 : 0.0, 0});
    }
    const RepairResult r = repair(chain, "chain");
    EXPECT_EQ(r.skeleton.size(), kCount);
    EXPECT_EQ(r.report.reordered, kCount - 1);
    EXPECT_EQ(r.report.missing_radii, kCount - kCount / 1000);
    chain.front().parent = -1;
    chain.back().parent = kCount - 2;
    EXPECT_THROW(repair(chain, "chain"), InvalidInput);
}

const std::vector<RawCylinder> kTrunk{{1, -1, {0, 0, 0}, {0, 0, 5}, 1, 1},
                                      {2, 1, {0, 0, 5}, {0, 0, 10}, 1, 2}};

TEST(RepairCylinders, TouchingCylindersOfEqualRadiusBecomeAPlainChain) {
    const RepairResult r = repair(kTrunk, "qsm");
    EXPECT_EQ(r.skeleton.size(), 3u);
    EXPECT_EQ(r.report.total() + r.report.bridged_gaps + r.report.attached_inside + r.report.radius_jumps,
              0u);
}

TEST(RepairCylinders, LateralOnTheSurfaceIsExtendedToTheAxis) {
    // At 45 degrees from the surface point (1, 0, 3): extended backwards it meets the axis at z = 2.
    std::vector<RawCylinder> c = kTrunk;
    c.push_back({3, 1, {1, 0, 3}, {4, 0, 6}, 0.2, 3});
    const RepairResult r = repair(c, "qsm");
    EXPECT_EQ(r.report.attached_inside, 1u);
    EXPECT_EQ(r.report.bridged_gaps, 0u);
    ASSERT_EQ(r.skeleton.size(), 5u);  // trunk of 3, the node on it, the lateral's end
    const NodeId tip(4);
    EXPECT_EQ(r.skeleton.position(tip), Vec3(4, 0, 6));
    const Segment s = r.skeleton.segment(tip);
    EXPECT_NEAR(s.a.z, 2, 1e-6);
    EXPECT_NEAR(s.a.x, 0, 1e-6);
    EXPECT_FLOAT_EQ(s.radius_a, 0.2f);  // own radius from the start
}

TEST(RepairCylinders, LateralThatMissesTheAxisPreservesItsStart) {
    // Tangential: it runs along y from (1, 0, 2). A straight line from the axis would be a radius (its five)
    // off there.
    std::vector<RawCylinder> c = kTrunk;
    c.push_back({3, 1, {1, 0, 2}, {1, 4, 2}, 0.2, 3});
    const RepairResult r = repair(c, "qsm");
    ASSERT_EQ(r.skeleton.size(), 6u);
    EXPECT_EQ(r.skeleton.position(NodeId(4)), Vec3(1, 0, 2));
}

TEST(RepairCylinders, BridgesAGapWithTheRadiusOfTheNextCylinder) {
    const RepairResult r = repair(
        std::vector<RawCylinder>{{1, -1, {0, 0, 0}, {0, 0, 5}, 1, 1}, {2, 1, {0, 4, 5}, {0, 4, 10}, 0.5, 2}},
        "qsm");
    EXPECT_EQ(r.report.bridged_gaps, 1u);
    EXPECT_EQ(r.report.radius_jumps, 1u);
    bool found = false;
    for (const NodeId n : nodes(r.skeleton)) {
        if (r.skeleton.position(n) != Vec3(0, 4, 5)) continue;
        found = true;
        EXPECT_EQ(r.skeleton.segment(n).radius_a, 0.5f);
        EXPECT_EQ(r.skeleton.segment(n).radius_b, 0.5f);
    }
    EXPECT_TRUE(found);
}

// Wide gaps, so that no cylinder simply continues: straight ahead, and slightly oblique.
TEST(RepairCylinders, CylinderBeyondAGapContinuesFromTheEnd) {
    for (const double aside : {0.0, 0.05}) {
        const RepairResult r = repair(std::vector<RawCylinder>{{1, -1, {0, 0, 0}, {0, 0, 10}, 0.5, 1},
                                                               {2, 1, {0, 0, 15}, {aside, 0, 20}, 0.4, 2}},
                                      "qsm");
        EXPECT_EQ(r.report.bridged_gaps, 1u);
        double length = 0;
        for (const NodeId n : nodes(r.skeleton)) {
            EXPECT_LE(r.skeleton.children(n).size(), 1u);
            if (!r.skeleton.is_root(n))
                length += double{distance(r.skeleton.position(n), r.skeleton.position(r.skeleton.parent(n)))};
        }
        EXPECT_NEAR(length, 20, 1e-3);
    }
}

TEST(RepairCylinders, PreservesBothRadiiOfAJump) {
    const RepairResult r = repair(std::vector<RawCylinder>{{1, -1, {0, 0, 0}, {0, 0, 20}, 0.5, 1},
                                                           {2, 1, {0, 0, 20}, {0, 0, 80}, 13, 2}},
                                  "qsm");
    EXPECT_EQ(r.report.radius_jumps, 1u);
    ASSERT_EQ(r.skeleton.size(), 4u);
    const Segment jump = r.skeleton.segment(NodeId(2));
    EXPECT_FLOAT_EQ(jump.radius_a, 0.5f);
    EXPECT_FLOAT_EQ(jump.radius_b, 13);
    // As long as the change, 12.5, half of it on each side: at most a third of 20 is 6.67, so 6.25 fits.
    EXPECT_FLOAT_EQ(jump.a.z, 13.75f);
    EXPECT_FLOAT_EQ(jump.b.z, 26.25f);
}

TEST(RepairCylinders, JoinsASmallGapInItsMiddle) {
    const RepairResult r = repair(std::vector<RawCylinder>{{1, -1, {0, 0, 0}, {0, 0, 5}, 1, 1},
                                                           {2, 1, {0.5, 0, 5}, {0.5, 0, 10}, 1, 2}},
                                  "qsm");
    ASSERT_EQ(r.skeleton.size(), 3u);
    EXPECT_EQ(r.skeleton.position(NodeId(1)), Vec3(0.25f, 0, 5));
}

TEST(RepairCylinders, SkipsDiscsAndPreservesTheirChildren) {
    const RepairResult r = repair(std::vector<RawCylinder>{{1, -1, {0, 0, 0}, {0, 0, 5}, 1, 1},
                                                           {2, 1, {0, 0, 5}, {0, 0, 5}, 1, 2},
                                                           {3, 2, {0, 0, 5}, {0, 0, 9}, 0, 3}},
                                  "qsm");
    EXPECT_EQ(r.report.zero_length, 1u);
    EXPECT_EQ(r.report.missing_radii, 1u);
    EXPECT_EQ(r.skeleton.size(), 3u);
    EXPECT_EQ(repair(std::vector<RawCylinder>{{1, -1, {1, 1, 1}, {1, 1, 1}, 1, 1}}, "qsm").skeleton.size(),
              1u);
}

TEST(RepairCylinders, CountsReorderedCylindersAndMissingParents) {
    std::vector<RawCylinder> c{kTrunk[1], kTrunk[0]};
    c.push_back({8, 77, {30, 0, 0}, {30, 0, 3}, 1, 3});
    const RepairResult r = repair(c, "qsm");
    EXPECT_EQ(r.report.reordered, 1u);
    EXPECT_EQ(r.report.missing_parents, 1u);
    EXPECT_EQ(r.skeleton.tree_count(), 2u);
}

TEST(RepairCylinders, ErrorsReportTheLine) {
    using Cylinders = std::vector<RawCylinder>;
    EXPECT_EQ(refusal(Cylinders{}), "tree.txt: there are no cylinders");
    EXPECT_EQ(refusal(Cylinders{{1, 1, {}, {0, 0, 1}, 1, 3}}),
              "tree.txt, line 3: the record 1 is among its own ancestors; break the cycle");
    EXPECT_EQ(refusal(Cylinders{{1, -1, {}, {0, kInf, 1}, 1, 3}}),
              "tree.txt, line 3: a coordinate is not a finite number");
}

TEST(RepairCylinders, AcceptsManyLateralsAtOnePosition) {
    std::vector<RawCylinder> c{kTrunk[0]};
    for (int i = 0; i < 20'000; ++i) c.push_back({i + 10, 1, {1, 0, 2.5}, {3, 0, 2.5 + 1e-4 * i}, 0.1, 0});
    EXPECT_GT(repair(c, "qsm").skeleton.size(), 20'000u);
}

/// Few distinct numbers, so that ids, positions and radii often coincide; occasionally an extreme one.
class Mess {
  public:
    explicit Mess(std::uint64_t seed) : random_(seed, 0) {}
    double number() {
        static constexpr double kOdd[] = {1e15, -1e15, 1e-300, 1e-12, 0, -1};
        const double u = random_.uniform(next_++);
        return u < 0.02 ? kOdd[static_cast<int>(u * 300)] : std::floor(u * 6);
    }
    Vec3d point() { return {number(), number(), number()}; }

  private:
    CounterRandom random_;
    std::uint64_t next_ = 0;
};

TEST(Repair, NodesHaveTheCylinderOfTheirSegment) {
    // Out of order; the third is a disc, and the lateral branches off within the trunk.
    const RepairResult r = repair(std::vector<RawCylinder>{{2, 1, {0, 0, 5}, {0, 0, 9}, 0.5, 1},
                                                           {1, -1, {0, 0, 0}, {0, 0, 5}, 1, 2},
                                                           {3, 2, {0, 0, 9}, {0, 0, 9.001}, 0.5, 3},
                                                           {4, 1, {1, 0, 2}, {6, 0, 2}, 0.2, 4}},
                                  "tree.csv");
    ASSERT_EQ(r.source.size(), r.skeleton.size());
    for (const NodeId n : nodes(r.skeleton)) {
        const Vec3 p = r.skeleton.position(n);
        // Around the joint at 5 m the radius changes from that of one cylinder to that of the other.
        const std::uint32_t expected = p.x > 0 ? 3 : p.z > 5 ? 0 : 1;
        EXPECT_EQ(r.source[n.index()], expected) << n.index();
    }
}

TEST(Repair, AnyInputBecomesASkeletonThatCanBePrepared) {
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        SCOPED_TRACE(seed);
        Mess mess(seed);
        std::vector<RawNode> n;
        std::vector<RawCylinder> c;
        for (std::int64_t i = 0; i < 40; ++i) {
            const auto parent = static_cast<std::int64_t>(mess.number()) * i / 6 - 1;
            n.push_back({i, parent, mess.point(), mess.number(), 0});
            c.push_back({i, parent, mess.point(), mess.point(), mess.number(), 0});
        }
        for (const Skeleton& s : {repair(n, "mess").skeleton, repair(c, "mess").skeleton}) {
            const PrepareResult r = prepare(s, {.smooth_passes = 1, .max_children = 3});
            EXPECT_EQ(r.skeleton.tree_count(), s.tree_count());
        }
    }
}

}  // namespace
}  // namespace coppice
