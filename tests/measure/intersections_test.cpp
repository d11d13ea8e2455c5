#include "coppice/measure/intersections.h"
#include "measure/support.h"

#include <gtest/gtest.h>

#include <optional>
#include <stop_token>

#include "mesh/shapes.h"

namespace coppice {
namespace {

using namespace shapes;

constexpr std::uint32_t kMany = 1'000'000;

std::size_t count(const PolygonMesh& m) { return crossing_faces(SurfaceTree(m), kMany).pairs.size(); }

TEST(CrossingFaces, FindsNoPairsOfSoundSurfaces) {
    EXPECT_EQ(count(cube()), 0u);
    EXPECT_EQ(count(torus(16, 40, 1, 3)), 0u);
    EXPECT_EQ(count(capsule(16, 4, 1, 0, 5)), 0u);
    EXPECT_EQ(count(moebius(20)), 0u);
    EXPECT_EQ(count(both(cube(), box({2, 0, 0}, {3, 1, 1}))), 0u);
    EXPECT_EQ(count(PolygonMesh{}), 0u);
}

TEST(CrossingFaces, FindsPairsOfTwoBoxes) {
    // Each of the three faces of one box that extend into the other intersects the two opposite faces.
    EXPECT_EQ(count(both(cube(), box({0.5f, 0.5f, 0.5f}, {1.5f, 1.5f, 1.5f}))), 6u);
    // A bar through a slab: its four sides intersect both faces of the slab.
    EXPECT_EQ(count(both(box({0, 0, 0}, {9, 9, 1}), box({4, 4, -3}, {5, 5, 3}))), 8u);
    // One box inside another does not touch it.
    EXPECT_EQ(count(both(box({0, 0, 0}, {9, 9, 9}), box({4, 4, 4}, {5, 5, 5}))), 0u);
}

TEST(CrossingFaces, FindsPairsOfTouchingBoxes) {
    // Five faces of each box touch the common square: the two in it meet all five, and a side meets all but
    // its opposite.
    EXPECT_EQ(count(both(cube(), box({1, 0, 0}, {2, 1, 1}))), 5u + 4 * 4);
    EXPECT_EQ(count(both(cube(), box({1, 1, 1}, {2, 2, 2}))), 9u);  // three faces each at one point
    EXPECT_EQ(count(both(cube(), box({std::nextafter(1.f, 2.f), 0, 0}, {2, 1, 1}))), 0u);
}

TEST(CrossingFaces, FindsPairsThatShareCorners) {
    // Folded flat onto each other along an edge; unfolded; upright.
    EXPECT_EQ(count(polygons({{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 0, 3}})), 1u);
    EXPECT_EQ(count(polygons({{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {1, -1, 0}}, {{0, 1, 2}, {1, 0, 3}})), 0u);
    EXPECT_EQ(count(polygons({{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {1, 1, 1}}, {{0, 1, 2}, {1, 0, 3}})), 0u);
    // The same corners; one common corner and an intersection.
    EXPECT_EQ(count(polygons({{0, 0, 0}, {2, 0, 0}, {1, 2, 0}}, {{0, 1, 2}, {2, 1, 0}})), 1u);
    EXPECT_EQ(
        count(polygons({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {3, 3, 1}, {3, 3, -1}}, {{0, 1, 2}, {0, 3, 4}})),
        1u);
}

TEST(CrossingFaces, CountsEveryPairOfFacesOnce) {
    // A disc of twelve corners, ten triangles, and a blade through its centre that intersects many of them.
    PolygonMesh m;
    for (std::uint32_t i = 0; i < 12; ++i)
        m.positions.push_back({std::cos(angle(i, 12)), std::sin(angle(i, 12)), 0});
    m.add_face(std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
    const PolygonMesh crossed =
        both(m, polygons({{-2, 0.1f, -1}, {2, 0.1f, -1}, {2, 0.1f, 1}, {-2, 0.1f, 1}}, {{0, 1, 2, 3}}));
    const FacePairs found = crossing_faces(SurfaceTree(crossed), kMany);
    ASSERT_EQ(found.pairs.size(), 1u);
    EXPECT_EQ(found.pairs[0], (FacePair{0, 1}));
    EXPECT_TRUE(found.complete);
}

TEST(CrossingFaces, IgnoresDegenerateFaces) {
    EXPECT_EQ(
        count(both(cube(), polygons({{-1, 0.5f, 0.5f}, {2, 0.5f, 0.5f}, {0, 0.5f, 0.5f}}, {{0, 1, 2}}))), 0u);
}

PolygonMesh stack(std::uint32_t n) {
    PolygonMesh m;
    for (std::uint32_t i = 0; i < n; ++i)
        m = both(std::move(m), polygons({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
    return m;
}

TEST(CrossingFaces, StopsAtTheLimit) {
    const PolygonMesh m = stack(100);
    EXPECT_EQ(count(m), 100u * 99 / 2);
    const FacePairs few = crossing_faces(SurfaceTree(m), 1000);
    EXPECT_EQ(few.pairs.size(), 1000u);
    EXPECT_FALSE(few.complete);
    EXPECT_TRUE(crossing_faces(SurfaceTree(m), 4950).complete);
}

TEST(CrossingFaces, CanBeCancelled) {
    std::stop_source source;
    source.request_stop();
    const PolygonMesh m = cube();
    EXPECT_THROW(crossing_faces(SurfaceTree(m), kMany, {.stop = source.get_token()}), Cancelled);
}

TEST(CrossingsAmong, MatchesTheWholeMeshByFaceIndices) {
    const PolygonMesh m =
        both(both(cube(), box({9, 9, 9}, {10, 10, 10})), box({0.5f, 0.5f, 0.5f}, {1.5f, 1.5f, 1.5f}));
    const std::vector<FacePair> all = crossing_faces(SurfaceTree(m), kMany).pairs;
    ASSERT_EQ(all.size(), 6u);
    std::vector<std::uint32_t> faces;
    for (std::uint32_t f = 0; f < m.face_count(); ++f) {
        if (f < 6 || f >= 12) faces.push_back(f);
    }
    EXPECT_EQ(crossings_among(m, faces, kMany).pairs, all);
    // Without the faces of one box there are no intersections, nor for a single face.
    EXPECT_TRUE(crossings_among(m, std::span(faces).first(6), kMany).pairs.empty());
    EXPECT_TRUE(crossings_among(m, std::span(faces).first(1), kMany).pairs.empty());
    EXPECT_FALSE(crossings_among(m, faces, 5).complete);
}

TEST(FacesNear, ReturnsTheFacesThatOverlapABox) {
    // A strip of unit quads along x.
    const PolygonMesh m = grid(2, 3000, false, [](std::uint32_t i, std::uint32_t j) {
        return Vec3{static_cast<float>(j), static_cast<float>(i), 0};
    });
    std::vector<std::uint32_t> expected;
    const std::vector<Box3> boxes{{{10.5f, 0.2f, -1}, {12.5f, 0.3f, 1}}, {{2900, 0, 0}, {2900, 0, 0}}};
    for (std::uint32_t f = 0; f < m.face_count(); ++f) {
        const Box3 box = FaceView(m).box(f);
        if (box.overlaps(boxes[0]) || box.overlaps(boxes[1])) expected.push_back(f);
    }
    // Columns 10, 11 and 12, and the two that touch at 2900; each twice, because the strip is folded back.
    EXPECT_EQ(expected.size(), 2u * 5);
    EXPECT_EQ(faces_near(m, boxes), expected);
    EXPECT_TRUE(faces_near(m, {}).empty());
    EXPECT_TRUE(faces_near(PolygonMesh{}, boxes).empty());
}

/// Bars along x and y that intersect in eight pairs of faces: the outer face of each with the two sides of
/// the other, and sides with sides.
PolygonMesh crossing_bars() {
    return both(box({-1, -0.3f, -0.3f}, {5, 0.3f, 0.3f}), box({-0.3f, -1, 0.2f}, {0.3f, 5, 0.8f}));
}

IntersectionReport kinds(const Skeleton& s) {
    const PolygonMesh m = crossing_bars();
    const CapsuleTree capsules(s, m.origin);
    return classify(crossing_faces(SurfaceTree(m), kMany), m, &s, &capsules);
}

/// Two trees of one segment each, along the centre lines of the bars, half a metre apart.
Skeleton two_trees(float radius) {
    return Skeleton({kRoot, NodeId(0), kRoot, NodeId(2)},
                    {{-1, 0, 0}, {5, 0, 0}, {0, -1, 0.5f}, {0, 5, 0.5f}}, {radius, radius, radius, radius});
}

TEST(Classify, ComparesPathLengthsAndCapsules) {
    const IntersectionReport remote = kinds(two_trees(0.2f));
    EXPECT_EQ(remote.total, 8u);
    EXPECT_EQ(remote.remote, 8u);
    const IntersectionReport overlap = kinds(two_trees(0.26f));
    EXPECT_EQ(overlap.total, 8u);
    EXPECT_EQ(overlap.overlap, 8u);
    const IntersectionReport near = kinds(two_trees(0.245f));  // apart, but by less than 5 %
    EXPECT_EQ(near.overlap, 8u);
}

TEST(Classify, CountsStepsAlongTheSkeleton) {
    // From the end of the bar along x over `joints` nodes of a long detour to the bar along y.
    const auto chain = [](std::uint32_t joints) {
        std::vector<NodeId> parent{kRoot, NodeId(0)};
        std::vector<Vec3> x{{-1, 0, 0}, {5, 0, 0}};
        for (std::uint32_t i = 0; i < joints; ++i) {
            parent.emplace_back(static_cast<std::uint32_t>(x.size()) - 1);
            x.push_back({9.f + static_cast<float>(i), 9, 9});
        }
        parent.emplace_back(static_cast<std::uint32_t>(x.size()) - 1);
        x.push_back({0, 5, 0.5f});
        parent.emplace_back(static_cast<std::uint32_t>(x.size()) - 1);
        x.push_back({0, -1, 0.5f});
        return Skeleton(parent, x, std::vector<float>(x.size(), 0.2f));
    };
    EXPECT_EQ(kinds(chain(1)).local, 8u);   // three steps: joint, end, end
    EXPECT_EQ(kinds(chain(2)).remote, 8u);  // four
}

TEST(Classify, ShortPathIsLocalForAnyNumberOfSteps) {
    // Eight steps of a centimetre each, for radii of 0.2.
    std::vector<NodeId> parent{kRoot, NodeId(0)};
    std::vector<Vec3> x{{5, 0, 0}, {-1, 0, 0}};
    for (std::uint32_t i = 0; i < 8; ++i) {
        parent.emplace_back(static_cast<std::uint32_t>(x.size()) - 1);
        x.push_back({-1.01f - 0.01f * static_cast<float>(i), 0, 0});
    }
    parent.emplace_back(static_cast<std::uint32_t>(x.size()) - 1);
    x.push_back({0, -1, 0.5f});
    parent.emplace_back(static_cast<std::uint32_t>(x.size()) - 1);
    x.push_back({0, 5, 0.5f});
    const auto with_radius = [&](float r) {
        return kinds(Skeleton(parent, x, std::vector<float>(x.size(), r)));
    };
    EXPECT_EQ(with_radius(0.2f).remote,
              8u);                       // the path also includes a segment of 1.5 m: 3 radii are 0.6
    x[x.size() - 2] = {-1.1f, 0, 0.5f};  // and now one of half a metre
    x.back() = {0, 5, 0.5f};
    EXPECT_EQ(with_radius(0.2f).local, with_radius(0.2f).total);
}

TEST(Classify, AllPairsAreLocalWithoutASkeleton) {
    const PolygonMesh m = crossing_bars();
    const IntersectionReport r = classify(crossing_faces(SurfaceTree(m), kMany), m, nullptr, nullptr);
    EXPECT_EQ(r.total, 8u);
    EXPECT_EQ(r.local, 8u);
}

/// A bar through a slab at `x`: eight pairs (see CrossingFaces.FindsPairsOfTwoBoxes); if the bar ends in it,
/// four.
PolygonMesh pierced(float x, bool through) {
    return both(box({x, 0, 0}, {x + 9, 9, 1}), box({x + 4, 4, through ? -3 : 0.5f}, {x + 5, 5, 3}));
}

CrossingPlaces find_places(const PolygonMesh& m, const Skeleton* s, std::size_t max_named) {
    std::optional<CapsuleTree> capsules;
    if (s != nullptr) capsules.emplace(*s, m.origin);
    return crossing_places(crossing_faces(SurfaceTree(m), kMany), m, s, capsules ? &*capsules : nullptr,
                           max_named);
}

TEST(CrossingPlaces, AreSortedByTheirNumberOfPairs) {
    PolygonMesh m = both(both(pierced(0, false), pierced(20, true)), pierced(40, false));
    m.origin = {1000, 0, 0};
    const CrossingPlaces all = find_places(m, nullptr, 9);
    ASSERT_EQ(all.total, 3u);
    ASSERT_EQ(all.largest.size(), 3u);
    EXPECT_EQ(all.more(), 0u);
    EXPECT_EQ(all.largest[0].pairs, 8u);
    EXPECT_EQ(all.largest[1].pairs, 4u);
    // The means of four sides of the bar and of the slab's faces, two and one: at (x + 4.5, 4.5).
    EXPECT_EQ(all.largest[0].place, Vec3d(1024.5, 4.5, 0.25));   // sides at 0, slab at 0 and 1
    EXPECT_EQ(all.largest[1].place, Vec3d(1004.5, 4.5, 1.375));  // sides at 1.75, slab at 1
    EXPECT_EQ(all.largest[2].place.x, 1044.5);                   // the same number of pairs, of later faces
    EXPECT_NEAR(all.largest[0].radius, std::sqrt(2 * 4.5 * 4.5 + 0.75 * 0.75), 1e-6);  // the slab's corners
    EXPECT_FALSE(all.largest[0].node);
    const CrossingPlaces few = find_places(m, nullptr, 1);
    ASSERT_EQ(few.largest.size(), 1u);
    EXPECT_EQ(few.largest[0], all.largest[0]);
    EXPECT_EQ(few.more(), 2u);
    EXPECT_EQ(find_places(m, nullptr, 0).more(), 3u);
    EXPECT_EQ(find_places(cube(), nullptr, 5), CrossingPlaces{});
}

TEST(CrossingPlaces, HaveTheNearestNodesOfASkeleton) {
    // The bar follows nodes 0 to 2 along z, the slab nodes 3 and 4 along x; the place is at z = 0.25.
    const Skeleton s(
        {kRoot, NodeId(0), NodeId(1), kRoot, NodeId(3)},
        {{4.5f, 4.5f, -3}, {4.5f, 4.5f, 1.5f}, {4.5f, 4.5f, 3}, {1, 4.5f, 0.5f}, {9, 4.5f, 0.5f}},
        {0.5f, 0.5f, 0.5f, 4, 4});
    const CrossingPlaces found = find_places(pierced(0, true), &s, 5);
    ASSERT_EQ(found.largest.size(), 1u);
    EXPECT_EQ(found.largest[0].node, NodeId(1));
    EXPECT_EQ(found.largest[0].other_node, NodeId(3));
    // All on one segment: the same node twice.
    const Skeleton alone({kRoot, NodeId(0)}, {{4.5f, 4.5f, -3}, {4.5f, 4.5f, 1.5f}}, {0.5f, 0.5f});
    const CrossingPlaces one = find_places(pierced(0, true), &alone, 5);
    EXPECT_EQ(one.largest.at(0).node, NodeId(1));
    EXPECT_EQ(one.largest.at(0).other_node, NodeId(1));
}

}  // namespace
}  // namespace coppice
