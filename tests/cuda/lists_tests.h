#pragma once

#include <gtest/gtest.h>

#include "coppice/cuda/lists/lists_stages_internal.h"
#include "coppice/spatial/box_tree.h"
#include "field/crowded_stem.h"
#include "lists_scene.h"
#include "on_executor.h"
#include "zoo.h"

// Tests of the lists of a field on any executor, compared with the CPU.

namespace coppice::cuda {

struct Comparison {
    std::uint32_t own_differ = 0, competitors_differ = 0;
    // competing lists for which the CPU, unlike the device, did not test all segments
    std::uint32_t missed = 0;
    std::size_t lists = 0, own = 0, competitors = 0, longest = 0;
};

// RegionLists on the host.
struct HostLists {
    Buffer<std::uint32_t> first, segments;
    template <class Exec>
    HostLists(Exec& exec, const RegionLists& lists)
        : first(downloaded(exec, lists.first)), segments(downloaded(exec, lists.segments)) {}
};

template <class Exec>
Comparison compare(Exec& exec, const Scene& scene, const ConvolutionField& on_cpu, const DeviceLists& lists) {
    const CandidateLists &own = on_cpu.own_lists(), &competitors = on_cpu.competitor_lists();
    const HostLists own_found(exec, lists.own), competitors_found(exec, lists.competitors);
    const std::vector<FieldRegion> regions = make_regions(scene);
    Comparison out{
        .lists = regions.size(), .own = own.segments.size(), .competitors = competitors.segments.size()};
    EXPECT_EQ(own.first.size(), own_found.first.size());
    EXPECT_EQ(competitors.first.size(), competitors_found.first.size());
    for (std::size_t r = 0; r < out.lists; ++r) {
        out.longest = std::max(out.longest, get_list(own, r).size());
        if (!std::ranges::equal(get_list(own, r), get_list(own_found, r))) ++out.own_differ;
        const List found = get_list(competitors_found, r);
        if (std::ranges::equal(get_list(competitors, r), found)) continue;
        const bool is_missed =
            std::ranges::equal(find_competitors(scene, on_cpu, regions[r], get_list(own, r)), found);
        ++(is_missed ? out.missed : out.competitors_differ);
    }
    return out;
}

// Computes the lists on both sides.
template <class Exec>
Comparison compare(const Scene& scene, const FieldOptions& options = {}) {
    ConvolutionField field(scene.skeleton, options);
    field.set_regions(make_regions(scene), scene.tree());
    Exec exec;
    const ContactsFound found = find_contacts(exec, make_input(scene, field));
    EXPECT_FALSE(found.state.is_cut);
    EXPECT_EQ(found.state.entries.own, downloaded(exec, found.lists.own.first.last(1))[0]);
    EXPECT_EQ(found.state.entries.competitors, downloaded(exec, found.lists.competitors.first.last(1))[0]);
    return compare(exec, scene, field, found.lists);
}

inline void expect_same(const Comparison& c, std::uint32_t missed = 0) {
    EXPECT_EQ(c.own_differ, 0u) << "of " << c.lists;
    EXPECT_EQ(c.competitors_differ, 0u) << "of " << c.lists;
    EXPECT_LE(c.missed, missed) << "of " << c.lists;
}

template <class Exec>
class ListsOn : public OnExecutor<Exec> {
  protected:
    // Segments that barely touch a box may be in only one list if rounding differs.
    static void expect_alike(const Comparison& c) {
        if (OnExecutor<Exec>::kSameBits) return expect_same(c);
        EXPECT_LE(c.own_differ + c.competitors_differ + c.missed, 1 + c.lists / 50) << "of " << c.lists;
    }
};
TYPED_TEST_SUITE_P(ListsOn);

TYPED_TEST_P(ListsOn, MatchTheCpuForTheWholeZoo) {
    std::size_t own = 0, competitors = 0;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        for (const float graft : {0.0f, 0.6f}) {
            SCOPED_TRACE(name + (graft > 0 ? ", grafted" : ""));
            const Comparison c = compare<TypeParam>(wrap(skeleton, graft));
            this->expect_alike(c);
            own += c.own;
            competitors += c.competitors;
        }
    }
    EXPECT_GT(own, 1000u);
    EXPECT_GT(competitors, 100u);
}

TYPED_TEST_P(ListsOn, OfAHubMatchTheCpuUntilOneIsTruncated) {
    for (const std::uint32_t twigs : {64u, 65u, 200u, 511u}) {
        SCOPED_TRACE(twigs);
        const Skeleton skeleton = hub(twigs);
        std::vector<Box3> boxes;
        for (const NodeId n : nodes(skeleton)) {
            boxes.push_back(skeleton.is_root(n) ? Box3{} : capsule_box({0, 0, 1}, skeleton.position(n), 0));
        }
        const Comparison c = compare<TypeParam>(in_boxes(skeleton, boxes));
        this->expect_alike(c);
        EXPECT_GE(c.longest, twigs);
    }
    const Skeleton skeleton = hub(512);
    const Scene scene = in_boxes(skeleton, std::vector<Box3>(skeleton.size(), Box3{{-1, -1, 0}, {1, 1, 2}}));
    const ConvolutionField field(skeleton, {});
    TypeParam executor;
    EXPECT_TRUE(find_contacts(executor, make_input(scene, field)).state.is_cut);
}

// Only the region of the root, to which all segments are related, would be truncated: it has no box.
TYPED_TEST_P(ListsOn, ContainAllRelatedSegmentsInACrowd) {
    const Skeleton stem = crowded_stem();
    std::vector<Box3> boxes(stem.size());
    boxes.back() = {{-1, -1, -1}, {1, 1, 2}};
    const Comparison c = compare<TypeParam>(in_boxes(stem, boxes));
    this->expect_alike(c);
    EXPECT_EQ(c.longest, 1u + 9u + 99u);
}

TYPED_TEST_P(ListsOn, ContainTheNearestSegmentsOfACrowd) {
    const Skeleton skeleton = stems(100, 0.01f, 2);
    // The boxes differ, so that each region has different neighbours.
    std::vector<Box3> boxes;
    for (const NodeId n : nodes(skeleton)) {
        const float x = skeleton.position(n).x;
        boxes.push_back({{x - 1, -1, 0}, {x + 1, 1, 1}});
    }
    const Comparison c = compare<TypeParam>(in_boxes(skeleton, boxes));
    // Rounding decides which of two equally distant neighbours is closer.
    if (TestFixture::kSameBits) expect_same(c);
    EXPECT_EQ(c.competitors, 200u * kMaxCompetitors);
    // Equal distances: the first are kept.
    this->expect_alike(compare<TypeParam>(
        in_boxes(stems(60, 0, 0.1f), std::vector<Box3>(120, Box3{{-1, -1, 0}, {1, 1, 1}}))));
}

TYPED_TEST_P(ListsOn, OfMoreCandidatesThanTestedMatchTheOrderOfTheCpu) {
    const Skeleton skeleton = stems(1100, 0.001f, 2);
    std::vector<Box3> boxes(skeleton.size());
    boxes[1] = {{1, -1, 0}, {1.2f, 1, 1}};  // the closest are tested last, or not at all
    const Comparison c = compare<TypeParam>(in_boxes(skeleton, boxes));
    this->expect_alike(c);
    EXPECT_EQ(c.competitors, kMaxCompetitors);
}

TYPED_TEST_P(ListsOn, FollowAMovingBranchWithTheSameTables) {
    Scene scene = wrap(zoo_skeleton("random_large_hard"));
    ConvolutionField field(scene.skeleton, {});
    TypeParam executor;
    const ContactTables tables = upload_contacts(executor, contact_topology(make_input(scene, field)));
    const ContactGeometry before = upload_geometry(executor, make_input(scene, field));
    const auto order = competitor_order(executor, tables, before);

    const auto moved = [](Vec3 p) { return Vec3{p.x + 0.3f * p.z, p.y * 0.2f, p.z}; };
    const auto all_moved = [&](auto positions) {
        for (Vec3& p : positions) p = moved(p);
        return positions;
    };
    const auto of = [](std::span<const Vec3> p) { return std::vector<Vec3>(p.begin(), p.end()); };
    scene.skeleton = with_positions(scene.skeleton, all_moved(of(scene.skeleton.positions())));
    scene.tubes = with_positions(scene.tubes, all_moved(of(scene.tubes.positions())));
    scene.control.cage.positions = all_moved(scene.control.cage.positions);
    scene.control.anchors = all_moved(scene.control.anchors);
    ConvolutionField now(scene.skeleton, {});
    now.set_regions(make_regions(scene), scene.tree());
    const ContactGeometry geometry = upload_geometry(executor, make_input(scene, now));
    const ListRoom room = usual_room(tables.tubes.size());
    const ContactsFound found = find_contacts(executor, tables, geometry, order, room);
    EXPECT_FALSE(found.state.is_cut);
    this->expect_alike(compare(executor, scene, now, found.lists));
    const DeviceLists of_before = find_contacts(executor, tables, before, order, room).lists;
    const Comparison c = compare(executor, scene, now, of_before);
    EXPECT_GT(c.own_differ, c.lists / 20) << "no list has changed";
}

TYPED_TEST_P(ListsOn, AreEmptyWithoutRoomAndThenRecomputed) {
    const Scene scene = wrap(zoo_skeleton("random_large_hard"));
    ConvolutionField field(scene.skeleton, {});
    field.set_regions(make_regions(scene), scene.tree());
    TypeParam executor;
    const ContactTables tables = upload_contacts(executor, contact_topology(make_input(scene, field)));
    const ContactGeometry geometry = upload_geometry(executor, make_input(scene, field));
    const auto order = competitor_order(executor, tables, geometry);
    const ListRoom none{10, 0};
    const DeviceLists little = begin_contacts(executor, tables, geometry, order, none);
    EXPECT_FALSE(read_state(executor, little).fits(none));
    EXPECT_EQ(little.own.segments.size(), 10u);
    for (const RegionLists& lists : {little.own, little.competitors}) {
        const auto first = downloaded(executor, lists.first);
        EXPECT_EQ(std::ranges::count(first, 0u), static_cast<std::ptrdiff_t>(first.size()));
    }
    const DeviceLists lists = find_contacts(executor, tables, geometry, order, none).lists;
    this->expect_alike(compare(executor, scene, field, lists));
}

TYPED_TEST_P(ListsOn, RegionBoxesMatchTheCpu) {
    const Scene scene = wrap(zoo_skeleton("random_large_hard"));
    const ConvolutionField field(scene.skeleton, {});
    TypeParam executor;
    const ContactTables tables = upload_contacts(executor, contact_topology(make_input(scene, field)));
    const auto boxes = downloaded(
        executor, region_boxes(executor, tables, upload_geometry(executor, make_input(scene, field))));
    const std::vector<FieldRegion> regions = make_regions(scene);
    ASSERT_EQ(boxes.size(), regions.size());
    for (std::size_t r = 0; r < boxes.size(); ++r) {
        if (TestFixture::kSameBits) {
            EXPECT_EQ(boxes[r].low, regions[r].box.low);
            EXPECT_EQ(boxes[r].high, regions[r].box.high);
        }
        ASSERT_EQ(boxes[r].empty(), regions[r].box.empty());
        if (boxes[r].empty()) continue;
        EXPECT_LE(distance(boxes[r].low, regions[r].box.low), 1e-5f);
        EXPECT_LE(distance(boxes[r].high, regions[r].box.high), 1e-5f);
    }
}

// Lists the boxes that overlap each query, in a separate row; `most` ends a search.
struct VisitBoxes {
    DeviceBoxTree tree;
    std::span<const Box3> queries;
    std::uint32_t most;
    std::span<std::uint32_t> rows, counts;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t q) const {
        std::uint32_t count = 0;
        const std::size_t row = rows.size() / queries.size() * q;
        tree.visit_overlapping(queries[q], [&](std::uint32_t i) {
            rows[row + count++] = i;
            return count < most;
        });
        counts[q] = count;
    }
};

template <class Exec>
class BoxesOn : public OnExecutor<Exec> {
  protected:
    static std::vector<std::vector<std::uint32_t>> visited(Exec& exec, const DeviceBoxTree& tree,
                                                           std::span<const Box3> queries,
                                                           std::uint32_t most) {
        const std::size_t row = tree.items().size();
        const auto rows = exec.template array<std::uint32_t>(row * queries.size());
        const auto counts = exec.template array<std::uint32_t>(queries.size());
        exec.clear(rows);  // not all of it is written
        exec.each("visit", queries.size(), VisitBoxes{tree, exec.upload(queries), most, rows, counts});
        const auto found = downloaded(exec, rows), count = downloaded(exec, counts);
        std::vector<std::vector<std::uint32_t>> out;
        for (std::size_t q = 0; q < queries.size(); ++q) {
            const auto begin = found.begin() + static_cast<std::ptrdiff_t>(row * q);
            out.emplace_back(begin, begin + count[q]);
        }
        return out;
    }
};
TYPED_TEST_SUITE_P(BoxesOn);

TYPED_TEST_P(BoxesOn, MatchTheOrderTheTreeAndTheVisitsOfTheCpu) {
    for (const std::size_t count : {1, 2, 7, 8, 9, 63, 64, 65, 511, 512, 513, 5000, 70000}) {
        SCOPED_TRACE(count);
        const std::vector<Box3> boxes = random_boxes(count, 3);
        const BoxTree on_cpu(boxes, {});
        TypeParam executor;
        const auto there = executor.upload(std::span<const Box3>(boxes));
        const auto order = box_order(executor, there);
        const DeviceBoxTree tree = box_tree(executor, there, order);
        const auto items = downloaded(executor, tree.items());
        for (std::uint32_t place = 0; place < on_cpu.size(); ++place)
            ASSERT_EQ(items[place], on_cpu.item(place));
        // The CPU's last level is one box if there are at most eight items.
        ASSERT_EQ(tree.level_count(), std::max(1u, on_cpu.level_count() - (count <= 8)));
        for (std::uint32_t l = 0; l < tree.level_count(); ++l) {
            const auto groups = downloaded(executor, tree.level(l));
            for (std::uint32_t i = 0; i < on_cpu.level(l).size(); ++i) {
                const Box3 box = groups[i / 8].box(i % 8);
                ASSERT_EQ(box.low, on_cpu.level(l)[i].low);
                ASSERT_EQ(box.high, on_cpu.level(l)[i].high);
            }
        }
        std::vector<Box3> queries = random_boxes(20, 4);
        for (Box3& query : queries) query = query.inflated(1);
        const auto all = this->visited(executor, tree, queries, 0xffffffffu);
        const auto three = this->visited(executor, tree, queries, 3);
        for (std::size_t q = 0; q < queries.size(); ++q) {
            std::vector<std::uint32_t> expected;
            on_cpu.visit_overlapping(queries[q], [&](std::uint32_t i) { expected.push_back(i); });
            EXPECT_EQ(all[q], expected);
            expected.resize(std::min<std::size_t>(3, expected.size()));
            EXPECT_EQ(three[q], expected);
        }
    }
}

TYPED_TEST_P(BoxesOn, AreFoundAfterTheyHaveMovedWithTheOldOrder) {
    const std::vector<Box3> boxes = random_boxes(3000, 5), moved = random_boxes(3000, 6);
    TypeParam executor;
    const auto order = box_order(executor, executor.upload(std::span<const Box3>(boxes)));
    const DeviceBoxTree tree = box_tree(executor, executor.upload(std::span<const Box3>(moved)), order);
    const Box3 query{{-2, -2, -2}, {3, 1, 2}};
    std::vector<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < moved.size(); ++i) {
        if (moved[i].overlaps(query)) expected.push_back(i);
    }
    auto found = this->visited(executor, tree, std::span(&query, 1), 0xffffffffu)[0];
    std::ranges::sort(found);
    EXPECT_EQ(found, expected);
    EXPECT_GT(found.size(), 10u);
}

REGISTER_TYPED_TEST_SUITE_P(ListsOn, MatchTheCpuForTheWholeZoo, OfAHubMatchTheCpuUntilOneIsTruncated,
                            ContainAllRelatedSegmentsInACrowd, ContainTheNearestSegmentsOfACrowd,
                            OfMoreCandidatesThanTestedMatchTheOrderOfTheCpu,
                            FollowAMovingBranchWithTheSameTables, AreEmptyWithoutRoomAndThenRecomputed,
                            RegionBoxesMatchTheCpu);
REGISTER_TYPED_TEST_SUITE_P(BoxesOn, MatchTheOrderTheTreeAndTheVisitsOfTheCpu,
                            AreFoundAfterTheyHaveMovedWithTheOldOrder);

}  // namespace coppice::cuda
