#include "coppice/measure/axes.h"

#include <gtest/gtest.h>

#include <vector>

#include "measure/support.h"
#include "mesh/shapes.h"

namespace coppice {
namespace {

using namespace shapes;

/// One segment of ten metres along z, of radius 0.5.
Skeleton pole() { return Skeleton({kRoot, NodeId(0)}, {{0, 0, 0}, {0, 0, 10}}, {0.5f, 0.5f}); }

/// The same axis with a node every tenth of a metre.
Skeleton dense_pole() {
    std::vector<NodeId> parent{kRoot};
    std::vector<Vec3> position{{0, 0, 0}};
    for (int k = 1; k <= 100; ++k) {
        parent.push_back(NodeId(static_cast<std::uint32_t>(k - 1)));
        position.push_back({0, 0, 0.1f * static_cast<float>(k)});
    }
    return Skeleton(parent, position, std::vector<float>(101, 0.5f));
}

AxesFound find(const PolygonMesh& m, const Skeleton& s, EndShape tips = EndShape::round) {
    return judge_axes(m, s, ConeUnion(s, m.origin, EndShape::flat, tips), tips);
}
AxesReport judge(const PolygonMesh& m, const Skeleton& s, EndShape tips = EndShape::round) {
    return find(m, s, tips).report;
}

/// The pole in two components, with a gap from 4.5 to 5.5 m.
PolygonMesh broken_pole() { return both(capsule(32, 16, 0.5f, 0, 4), capsule(32, 16, 0.5f, 6, 10)); }

TEST(Axes, OfAnExactSurfaceAreWhole) {
    const AxesFound found = find(capsule(64, 16, 0.5f, 0, 10), pole());
    const AxesReport& r = found.report;
    EXPECT_NEAR(r.length, 10 - 2 * 0.6, 0.25);  // without the ends, within the spacing of the points
    EXPECT_EQ(r.outside, 0);
    EXPECT_EQ(r.thin, 0);
    EXPECT_EQ(r.segments, 1u);
    EXPECT_EQ(r.missing, 0u);
    EXPECT_TRUE(r.is_perfect());
    EXPECT_EQ(r.beyond, 0);
    EXPECT_EQ(found.is_deep, std::vector<std::uint8_t>{1});
}

TEST(Axes, AreSeveredWhereTheyLeaveTheSurface) {
    for (const Skeleton& s : {pole(), dense_pole()}) {
        const AxesFound found = find(broken_pole(), s);
        const AxesReport& r = found.report;
        EXPECT_NEAR(r.outside, 1, 0.25);
        EXPECT_NEAR(r.thin, 2 * 0.2, 0.3);
        ASSERT_EQ(r.severed, 1u);  // independent of the number of nodes
        EXPECT_NEAR(r.longest[0].length, r.outside + r.thin, 1e-6);
        EXPECT_NEAR(r.longest[0].place.z, 4.3, 0.25);
        EXPECT_EQ(r.longest[0].node, s.size() == 2 ? NodeId(1) : NodeId(44));
        EXPECT_FALSE(r.is_whole());
        EXPECT_EQ(found.is_deep.front(), s.size() == 2 ? 0 : 1);
        EXPECT_EQ(found.is_deep.back(), s.size() == 2 ? 0 : 1);
    }
}

TEST(Axes, AreSeveredWhereTheSurfaceIsThin) {
    EXPECT_TRUE(judge(capsule(32, 16, 0.25f, 0, 10), pole()).is_whole());
    const AxesReport thin = judge(capsule(32, 16, 0.15f, 0, 10), pole());
    EXPECT_EQ(thin.severed, 1u);
    EXPECT_EQ(thin.thin_percent(), 100);
    EXPECT_EQ(thin.missing, 0u);
}

TEST(Axes, OfMissingBranchesAreOutside) {
    EXPECT_EQ(judge(PolygonMesh{}, pole()).missing, 1u);
    EXPECT_EQ(judge(cube(), pole()).missing, 1u);
    // A twig of two segments that is missing in the surface.
    const Skeleton s({kRoot, NodeId(0), NodeId(1), NodeId(1), NodeId(3)},
                     {{0, 0, 0}, {0, 0, 5}, {0, 0, 10}, {3, 0, 5}, {6, 0, 5}},
                     {0.5f, 0.5f, 0.5f, 0.1f, 0.1f});
    const AxesReport r = judge(capsule(32, 16, 0.5f, 0, 10), s);
    EXPECT_EQ(r.segments, 4u);
    EXPECT_EQ(r.missing, 2u);
    ASSERT_EQ(r.severed, 1u);
    EXPECT_NEAR(r.longest[0].length, 5.5 - 0.12, 0.1);
    EXPECT_EQ(r.longest[0].node, NodeId(3));
    EXPECT_NEAR(r.beyond, 6, 1e-6);  // the twig
    EXPECT_FALSE(r.is_whole());
}

TEST(Axes, MayBeInsideOtherBranches) {
    // The axis of a twig begins in the middle of a stem that is fifty times as thick.
    const Skeleton s({kRoot, NodeId(0), NodeId(1), NodeId(1)},
                     {{0, 0, 0}, {0, 0, 5}, {0, 0, 10}, {0.3f, 0, 5}}, {0.5f, 0.5f, 0.5f, 0.01f});
    const AxesReport r = judge(capsule(32, 16, 0.5f, 0, 10), s);
    EXPECT_TRUE(r.is_whole());
    EXPECT_TRUE(r.reaches_tips());
    EXPECT_EQ(r.tips, 2u);
    EXPECT_EQ(r.tip_reach.n, 1u);  // the twig's tip is inside the stem
}

TEST(Tips, OfACompleteSurfaceAreReached) {
    const AxesReport r = judge(capsule(64, 16, 0.5f, 0, 10), pole());
    EXPECT_EQ(r.tips, 1u);
    EXPECT_EQ(r.tip_reach.n, 1u);
    EXPECT_NEAR(r.tip_reach.p50, 1, 1e-6);
    EXPECT_TRUE(r.reaches_tips());
    EXPECT_NEAR(judge(capsule(32, 8, 0.6f, 0, 10), pole()).tip_reach.p50, 1.2, 1e-5);
}

TEST(Tips, OfATruncatedSurfaceAreShort) {
    const AxesReport r = judge(capsule(32, 8, 0.5f, 0, 9), pole());
    EXPECT_NEAR(r.tip_reach.p50, -1, 1e-5);  // half a metre short of the tip
    ASSERT_EQ(r.short_tips, 1u);
    EXPECT_NEAR(r.shortest[0].missing, 2, 1e-5);
    EXPECT_EQ(r.shortest[0].node, NodeId(1));
    EXPECT_EQ(r.shortest[0].place.z, 10);
}

TEST(Tips, MayBeFlat) {
    const PolygonMesh flat = box({-0.5f, -0.5f, 0}, {0.5f, 0.5f, 10});
    EXPECT_NEAR(judge(flat, pole(), EndShape::flat).tip_reach.p50, 0, 1e-6);
    EXPECT_TRUE(judge(flat, pole(), EndShape::flat).reaches_tips());
    EXPECT_FALSE(judge(flat, pole(), EndShape::round).reaches_tips());
}

TEST(Axes, AreIndependentOfTheOrderOfFacesAndTheOrigin) {
    const PolygonMesh whole = broken_pole();
    PolygonMesh shuffled;
    shuffled.positions = whole.positions;
    shuffled.origin = {5e5, 4e6, 100};
    const std::uint32_t n = whole.face_count();
    for (std::uint32_t k = 0; k < n; ++k) {
        const auto face = whole.face(static_cast<std::uint32_t>(std::uint64_t{k} * 7919 % n));
        shuffled.add_face(std::vector<std::uint32_t>(face.begin(), face.end()));
    }
    const Skeleton moved({kRoot, NodeId(0)}, {{1, 0, 0}, {1, 0, 10}}, {0.5f, 0.5f}, {5e5 - 1, 4e6, 100});
    const AxesReport a = judge(whole, pole()), b = judge(shuffled, moved);
    EXPECT_EQ(a.severed, b.severed);
    EXPECT_EQ(a.outside, b.outside);
    EXPECT_EQ(a.thin, b.thin);
    EXPECT_EQ(b.longest[0].place, a.longest[0].place + Vec3d(5e5, 4e6, 100));
}

TEST(Axes, SeveredPartsAreLimitedToTheGivenSegments) {
    const PolygonMesh broken = broken_pole();
    const Skeleton s = dense_pole();
    const CapsuleTree segments(s, broken.origin);
    std::vector<std::uint8_t> wanted(s.size(), 0);
    EXPECT_TRUE(find_severed_ranges(broken, s, segments, EndShape::round, wanted).empty());
    for (std::size_t n = 50; n < 55; ++n) wanted[n] = 1;  // from 4.9 to 5.4 m
    const auto parts = find_severed_ranges(broken, s, segments, EndShape::round, wanted);
    ASSERT_EQ(parts.size(), 5u);
    for (std::uint32_t k = 0; k < parts.size(); ++k) {
        EXPECT_EQ(parts[k].node, NodeId(50 + k));
        EXPECT_EQ(parts[k].from, 0);
        EXPECT_EQ(parts[k].to, 1);
    }
    EXPECT_TRUE(
        find_severed_ranges(capsule(64, 16, 0.5f, 0, 10), s, segments, EndShape::round, wanted).empty());
}

}  // namespace
}  // namespace coppice
