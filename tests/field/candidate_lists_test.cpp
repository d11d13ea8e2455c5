#include "coppice/field/candidate_lists.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "coppice/base/random.h"
#include "coppice/field/convolution_field.h"
#include "zoo.h"

namespace coppice {
namespace {

// Lists of the plain sum are sorted, like those of find_candidates.
const FieldOptions kPlainSum{.blend = 1};

/// One region around every segment, and one around every single node.
std::vector<FieldRegion> region_per_segment(const Skeleton& s) {
    std::vector<FieldRegion> regions;
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n) && !s.is_tip(n)) continue;
        const Segment g =
            s.is_root(n) ? Segment{s.position(n), s.position(n), s.radius(n), s.radius(n)} : s.segment(n);
        regions.push_back({capsule_box(g.a, g.b, 1.2f * std::max(g.radius_a, g.radius_b)), n});
    }
    return regions;
}

Vec3 point_in(const Box3& box, const CounterRandom& random, std::uint64_t i) {
    const Vec3 size = box.size();
    return box.low + Vec3{size.x * static_cast<float>(random.uniform(3 * i)),
                          size.y * static_cast<float>(random.uniform(3 * i + 1)),
                          size.z * static_cast<float>(random.uniform(3 * i + 2))};
}

bool contributes(const ConvolutionField& field, NodeId n, Vec3 p) {
    const auto& s = field.segments()[n.index()];
    const kernel::SegmentConstants<double> wide{s.ax,    s.ay,  s.az,     s.ux,     s.uy,    s.uz,
                                                s.begin, s.end, s.length, s.radius, s.slope, s.weight};
    return sample_segment(field.kernel(), wide, {p.x, p.y, p.z}).value > 1e-7;
}

std::vector<NodeId> neighbours(const Skeleton& s, NodeId segment) {
    std::vector<NodeId> all(s.children(segment).begin(), s.children(segment).end());
    if (s.is_root(segment)) return all;
    const NodeId p = s.parent(segment);
    if (!s.is_root(p)) all.push_back(p);
    for (const NodeId c : s.children(p)) {
        if (c != segment) all.push_back(c);
    }
    return all;
}

/// Returns the segments that are connected to the seed through segments that contribute at one of the points.
std::set<std::uint32_t> connected_contributors(const Skeleton& s, const ConvolutionField& field, NodeId seed,
                                               const std::vector<Vec3>& points) {
    std::set<std::uint32_t> found{seed.index()};
    std::vector<NodeId> queue{seed};
    while (!queue.empty()) {
        const NodeId n = queue.back();
        queue.pop_back();
        for (const NodeId m : neighbours(s, n)) {
            if (found.contains(m.index())) continue;
            if (std::none_of(points.begin(), points.end(), [&](Vec3 p) { return contributes(field, m, p); }))
                continue;
            found.insert(m.index());
            queue.push_back(m);
        }
    }
    return found;
}

bool hangs_together(const Skeleton& s, std::span<const std::uint32_t> list) {
    std::set<std::uint32_t> left(list.begin() + 1, list.end());
    std::vector<NodeId> queue{NodeId(list[0])};
    while (!queue.empty()) {
        const NodeId n = queue.back();
        queue.pop_back();
        for (const NodeId m : neighbours(s, n)) {
            if (left.erase(m.index()) > 0) queue.push_back(m);
        }
    }
    return left.empty();
}

TEST(CandidateLists, ContainAllConnectedContributorsOnTheZoo) {
    std::size_t contributors = 0;
    for (const auto& [name, s] : skeleton_zoo()) {
        if (s.size() > 300) continue;
        SCOPED_TRACE(name);
        ConvolutionField field(s, kPlainSum);
        const auto regions = region_per_segment(s);
        field.set_regions(regions);
        ASSERT_EQ(field.region_count(), regions.size());
        for (std::uint32_t r = 0; r < regions.size(); ++r) {
            const auto list = field.candidates(r);
            ASSERT_TRUE(std::is_sorted(list.begin(), list.end()));
            ASSERT_TRUE(hangs_together(s, list));
            std::vector<Vec3> points;
            for (std::uint64_t i = 0; i < 20; ++i)
                points.push_back(point_in(regions[r].box, CounterRandom(5, r), i));
            for (const std::uint32_t n : connected_contributors(s, field, regions[r].seed, points)) {
                EXPECT_TRUE(std::binary_search(list.begin(), list.end(), n))
                    << "region " << r << ", segment " << n;
                ++contributors;
            }
        }
    }
    EXPECT_GT(contributors, 1000u);  // the zoo has more segments than that, and most reach their own region
}

std::vector<Box3> compute_boxes(const std::vector<FieldRegion>& regions) {
    std::vector<Box3> boxes;
    for (const FieldRegion& r : regions) boxes.push_back(r.box);
    return boxes;
}

TEST(TouchingLists, MatchTheFieldOfAllSegmentsOnTheZoo) {
    for (const auto& [name, s] : skeleton_zoo()) {
        if (s.size() > 300) continue;
        SCOPED_TRACE(name);
        ConvolutionField field(s, {});
        const auto boxes = compute_boxes(region_per_segment(s));
        field.set_regions(boxes);
        ASSERT_EQ(field.region_count(), boxes.size());
        for (std::uint32_t r = 0; r < boxes.size(); ++r) {
            std::vector<Vec3> points;
            for (std::uint64_t i = 0; i < 20; ++i)
                points.push_back(point_in(boxes[r], CounterRandom(8, r), i));
            std::vector<FieldSample> by_list(points.size()), all(points.size());
            field.sample(r, points, by_list);
            field.sample_everywhere(points, all);
            for (std::size_t i = 0; i < points.size(); ++i) {
                EXPECT_NEAR(by_list[i].value, all[i].value, 2e-5f * (1 + all[i].value)) << "region " << r;
            }
        }
    }
}

TEST(TouchingLists, ContainAPassingBranchButNoFarSegments) {
    const Skeleton s({NodeId{}, NodeId(0), NodeId{}, NodeId(2), NodeId{}, NodeId(4)},
                     {{0, 0, 0}, {0, 0, 10}, {2.2f, 0, 0}, {2.2f, 0, 10}, {4.5f, 0, 0}, {4.5f, 0, 10}},
                     {1, 1, 1, 1, 1, 1});
    ConvolutionField field(s, {});
    const Box3 boxes[] = {capsule_box({0, 0, 4}, {0, 0, 6}, 1.2f), Box3{{100, 0, 0}, {101, 1, 1}}};
    field.set_regions(boxes);
    const auto list = field.candidates(0);
    EXPECT_EQ(std::vector(list.begin(), list.end()), (std::vector<std::uint32_t>{1, 3}));
    EXPECT_TRUE(field.candidates(1).empty());
    const Vec3 p[] = {{100.5f, 0.5f, 0.5f}};
    FieldSample nothing[1];
    field.sample(1, p, nothing);
    EXPECT_EQ(nothing[0].value, 0.0f);
}

TEST(TouchingLists, ContainTheNearestIfThereAreTooMany) {
    // Balls of radius 1 in a row; the box is around the first of them, but all supports reach it.
    constexpr std::uint32_t kCount = 600;
    std::vector<SegmentSupport> supports;
    for (std::uint32_t i = 0; i < kCount; ++i) {
        const Vec3 c{0.001f * static_cast<float>(i), 0, 0};
        supports.push_back({capsule_box(c, c, 1), c, c, 1});
    }
    supports[3].radius = 0;
    std::vector<Box3> boxes(8192, Box3{{-1, -1, -1}, {1, 1, 1}});
    const CandidateLists lists = find_touching(supports, boxes);
    for (std::size_t r = 0; r < boxes.size(); ++r) {
        ASSERT_EQ(lists.first[r + 1] - lists.first[r], longest_list(boxes.size()));
        ASSERT_EQ(lists.segments[lists.first[r] + 2], 2u);
        ASSERT_EQ(lists.segments[lists.first[r] + 3], 4u);
        ASSERT_EQ(lists.segments[lists.first[r + 1] - 1], 256u);
    }
}

TEST(CandidateLists, ExcludeAPassingBranch) {
    // A hairpin: up, over, and down again at a distance of 2.2 radii; its legs are in each other's support.
    const Skeleton s({NodeId{}, NodeId(0), NodeId(1), NodeId(2), NodeId(3), NodeId(4)},
                     {{0, 0, 0}, {0, 0, 10}, {0, 0, 20}, {2.2f, 0, 20}, {2.2f, 0, 10}, {2.2f, 0, 0}},
                     {1, 1, 1, 1, 1, 1});
    ConvolutionField field(s, {});
    const FieldRegion regions[] = {{capsule_box({0, 0, 0}, {0, 0, 10}, 1.2f), NodeId(1)},
                                   {capsule_box({0, 0, 10}, {0, 0, 20}, 1.2f), NodeId(2)}};
    field.set_regions(regions);
    const auto low = field.candidates(0), high = field.candidates(1);
    EXPECT_EQ(std::vector(low.begin(), low.end()), (std::vector<std::uint32_t>{1, 2}));
    EXPECT_EQ(std::vector(high.begin(), high.end()), (std::vector<std::uint32_t>{1, 2, 3, 4, 5}));
    const Vec3 p[] = {{1.1f, 0, 5}};
    FieldSample by_list[1], all[1];
    field.sample(0, p, by_list);
    field.sample_everywhere(p, all);
    EXPECT_GT(all[0].value, 1.5f * by_list[0].value);
}

TEST(CandidateLists, RootHasTheSegmentOfItsLeader) {
    const Skeleton s = zoo_skeleton("one_segment");
    ConvolutionField field(s, {});
    const FieldRegion regions[] = {{s.bounds(), NodeId(0)}};
    field.set_regions(regions);
    ASSERT_EQ(field.candidates(0).size(), 1u);
    EXPECT_EQ(field.candidates(0)[0], 1u);
}

/// Spokes of length 100 and radius 1 in directions distributed over the sphere.
Skeleton star(std::uint32_t spokes) {
    std::vector<NodeId> parent{NodeId{}};
    std::vector<Vec3> position{{0, 0, 0}};
    for (std::uint32_t i = 0; i < spokes; ++i) {
        const float z = 1 - (2 * static_cast<float>(i) + 1) / static_cast<float>(spokes);
        const float turn = 2.39996f * static_cast<float>(i), r = std::sqrt(1 - z * z);
        parent.push_back(NodeId(0));
        position.push_back(100.0f * Vec3{r * std::cos(turn), r * std::sin(turn), z});
    }
    return Skeleton(parent, position, std::vector<float>(spokes + 1, 1.0f));
}

TEST(CandidateLists, ContainManyChildrenOfANode) {
    const Skeleton s = star(500);
    const ConvolutionField field(s, kPlainSum);
    std::vector<FieldRegion> regions;
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const Vec3 middle = 0.2f * s.position(n), end = s.position(n);
        regions.push_back({capsule_box(middle, end, 1), n});
    }
    ConvolutionField with_lists(s, kPlainSum);
    with_lists.set_regions(regions);
    for (std::uint32_t r = 0; r < regions.size(); r += 17) {
        std::vector<Vec3> points;
        for (std::uint64_t i = 0; i < 20; ++i)
            points.push_back(point_in(regions[r].box, CounterRandom(6, r), i));
        const auto list = with_lists.candidates(r);
        for (const std::uint32_t n : connected_contributors(s, field, regions[r].seed, points)) {
            EXPECT_TRUE(std::binary_search(list.begin(), list.end(), n));
        }
    }
}

TEST(CandidateLists, OfManyChildrenAreLimited) {
    const Skeleton s = star(20000);
    ConvolutionField field(s, kPlainSum);
    std::vector<FieldRegion> regions;
    for (const NodeId n : nodes(s)) {
        if (!s.is_root(n)) regions.push_back({capsule_box(0.5f * s.position(n), s.position(n), 1), n});
    }
    regions.push_back({s.bounds(), NodeId(1)});
    field.set_regions(regions);
    for (std::uint32_t r = 0; r < field.region_count(); ++r) {
        ASSERT_LE(field.candidates(r).size(), (1u << 24) / regions.size());
        const std::uint32_t seed = regions[r].seed.index();
        ASSERT_TRUE(std::binary_search(field.candidates(r).begin(), field.candidates(r).end(), seed));
    }
}

TEST(CandidateLists, AreBitIdenticalForAnyNumberOfThreads) {
    const Skeleton s = zoo_skeleton("random_large_hard");
    const auto regions = region_per_segment(s);
    std::vector<std::vector<std::uint32_t>> all;
    for (const unsigned threads : {1u, 2u, 7u}) {
        const Context ctx{.threads = threads, .stop = {}, .progress = {}};
        ConvolutionField field(s, {}, ctx);
        field.set_regions(regions, ctx);
        all.emplace_back();
        for (std::uint32_t r = 0; r < field.region_count(); ++r) {
            const auto list = field.candidates(r);
            all.back().push_back(static_cast<std::uint32_t>(list.size()));
            all.back().insert(all.back().end(), list.begin(), list.end());
        }
    }
    EXPECT_EQ(all[0], all[1]);
    EXPECT_EQ(all[0], all[2]);
}

}  // namespace
}  // namespace coppice
