#include "coppice/cuda/lists/lists_stages.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "coppice/cage/cage.h"
#include "coppice/cage/graft.h"
#include "coppice/cage/part.h"
#include "coppice/cuda/exec/host_executor.h"
#include "coppice/skeleton/prepare.h"
#include "coppice/spatial/box_tree.h"
#include "field/crowded_stem.h"
#include "paths.h"
#include "zoo.h"

namespace coppice::cuda {
namespace {

std::vector<NodeId> composed(std::span<const NodeId> first, std::span<const NodeId> second) {
    std::vector<NodeId> both(first.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
        if (first[i]) both[i] = second[first[i].index()];
    }
    return both;
}

// A skeleton with its tubes and their cage, as the pipeline makes them.
struct Scene {
    Skeleton skeleton, tubes;
    std::vector<NodeId> tube;
    ControlMesh control;
    TubeTree tree() const { return {tubes, tube}; }
};

Scene wrap(const Skeleton& given, float graft = 0.6f) {
    const GraftResult grafted = graft_branches(prepare(given).skeleton, graft, {});
    PartResult parted = part_branches(grafted.tubes, {});
    const std::vector<NodeId> source = composed(parted.source, grafted.source);
    ControlMesh control = build_control_mesh(parted.skeleton, source, {}, {});
    return {grafted.skeleton, std::move(parted.skeleton), composed(grafted.tube, parted.tube),
            std::move(control)};
}

std::vector<FieldRegion> regions_of(const Scene& scene) {
    const ControlMesh& control = scene.control;
    std::vector<FieldRegion> regions(control.region_node.size());
    for (std::size_t q = 0; q < control.region.size(); ++q) {
        for (const std::uint32_t v : control.cage.quads[q]) {
            regions[control.region[q]].box.extend(control.cage.positions[v]);
            regions[control.region[q]].box.extend(control.anchors[v]);
        }
    }
    for (std::size_t r = 0; r < regions.size(); ++r) {
        regions[r].seed = control.region_node[r];
        regions[r].box = region_box(regions[r].box, scene.skeleton.radius(regions[r].seed));
    }
    return regions;
}

using List = std::span<const std::uint32_t>;

template <class Lists>
List list_of(const Lists& lists, std::size_t r) {
    return std::span(lists.segments).subspan(lists.first[r], lists.first[r + 1] - lists.first[r]);
}

// The rivals of a region by looking at all segments.
std::vector<std::uint32_t> rivals_of(const Scene& scene, const ConvolutionField& field,
                                     const FieldRegion& region, List own) {
    const Skeleton& s = scene.skeleton;
    const Vec3 center = region.box.center();
    std::vector<std::pair<float, std::uint32_t>> found;
    for (const NodeId n : nodes(s)) {
        if (!scene.tube[n.index()] || (s.is_root(n) && !s.is_tip(n))) continue;
        const SegmentSupport capsule = rival_capsule(
            s.is_root(n) ? Segment{s.position(n), s.position(n), s.radius(n), s.radius(n)} : s.segment(n));
        if (!may_touch(capsule, region.box, center, 0.5f * region.box.diagonal())) continue;
        if (std::ranges::find(own, n.index()) != own.end()) continue;
        found.emplace_back(clearance(capsule, center), n.index());
    }
    std::ranges::sort(found);
    if (found.size() > kMostRivals) found.resize(kMostRivals);
    std::vector<std::uint32_t> out;
    for (const auto& [away, segment] : found) out.push_back(segment);
    std::ranges::sort(out, {}, [&](std::uint32_t i) { return std::pair(field.axes()[i], i); });
    return out;
}

struct Comparison {
    std::uint32_t own_differ = 0, rivals_differ = 0;
    std::uint32_t missed = 0;  // lists of rivals of which the CPU, unlike the device, did not see all
    std::size_t lists = 0, own = 0, rivals = 0, longest = 0;
};

Comparison compare(const Scene& scene, const ConvolutionField& on_cpu, const DeviceLists& lists) {
    const CandidateLists &own = on_cpu.own_lists(), &rivals = on_cpu.rival_lists();
    const std::vector<FieldRegion> regions = regions_of(scene);
    Comparison out{.lists = regions.size(), .own = own.segments.size(), .rivals = rivals.segments.size()};
    EXPECT_EQ(own.first.size(), lists.own.first.size());
    EXPECT_EQ(rivals.first.size(), lists.rivals.first.size());
    for (std::size_t r = 0; r < out.lists; ++r) {
        out.longest = std::max(out.longest, list_of(own, r).size());
        if (!std::ranges::equal(list_of(own, r), list_of(lists.own, r))) ++out.own_differ;
        const List found = list_of(lists.rivals, r);
        if (std::ranges::equal(list_of(rivals, r), found)) continue;
        const bool is_missed =
            std::ranges::equal(rivals_of(scene, on_cpu, regions[r], list_of(own, r)), found);
        ++(is_missed ? out.missed : out.rivals_differ);
    }
    return out;
}

ContactInput input_of(const Scene& scene, const ConvolutionField& field) {
    return {scene.skeleton, scene.tree(), field, scene.control};
}

// Makes the lists on both sides.
Comparison compare(const Scene& scene, const FieldOptions& options = {}) {
    ConvolutionField field(scene.skeleton, options);
    field.set_regions(regions_of(scene), scene.tree());
    HostExecutor executor;
    const ContactsFound found = find_contacts(executor, input_of(scene, field));
    EXPECT_FALSE(found.state.is_cut);
    EXPECT_EQ(found.state.entries.own, found.lists.own.first.back());
    EXPECT_EQ(found.state.entries.rivals, found.lists.rivals.first.back());
    return compare(scene, field, found.lists);
}

void expect_same(const Comparison& c, std::uint32_t missed = 0) {
    EXPECT_EQ(c.own_differ, 0u) << "of " << c.lists;
    EXPECT_EQ(c.rivals_differ, 0u) << "of " << c.lists;
    EXPECT_LE(c.missed, missed) << "of " << c.lists;
}

TEST(FindContactsOnDevice, FindsTheListsOfTheCpuForTheWholeZoo) {
    std::size_t own = 0, rivals = 0;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        for (const float graft : {0.0f, 0.6f}) {
            SCOPED_TRACE(name + (graft > 0 ? ", grafted" : ""));
            const Scene scene = wrap(skeleton, graft);
            const Comparison c = compare(scene);
            expect_same(c);
            own += c.own;
            rivals += c.rivals;
        }
    }
    EXPECT_GT(own, 1000u);
    EXPECT_GT(rivals, 100u);
}

TEST(FindContactsOnDevice, FindsThemForEveryKernelAndBlend) {
    const Scene scene = wrap(zoo_skeleton("random_large_hard"));
    for (const Kernel kernel : {Kernel::quartic, Kernel::cauchy, Kernel::scalis, Kernel::balls}) {
        for (const int blend : {1, 2, 8}) {
            SCOPED_TRACE(static_cast<int>(kernel) * 10 + blend);
            expect_same(compare(scene, {.kernel = kernel, .blend = blend}));
        }
    }
    expect_same(compare(scene, {.weights = Weights::global}));
}

// Lines of "id type x y z radius parent".
Skeleton read_swc(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::vector<NodeId> parent, id_of{NodeId::none()};
    std::vector<Vec3> position;
    std::vector<float> radius;
    for (std::string line; std::getline(file, line);) {
        std::istringstream in(line);
        std::int64_t id = 0, type = 0, up = 0;
        Vec3 p;
        float r = 0;
        if (!(in >> id >> type >> p.x >> p.y >> p.z >> r >> up)) continue;
        id_of.resize(std::max<std::size_t>(id_of.size(), static_cast<std::size_t>(id) + 1));
        id_of[static_cast<std::size_t>(id)] = NodeId(static_cast<std::uint32_t>(parent.size()));
        parent.push_back(up > 0 ? id_of[static_cast<std::size_t>(up)] : NodeId::none());
        position.push_back(p);
        radius.push_back(r);
    }
    return {std::move(parent), std::move(position), std::move(radius)};
}

class Workload : public testing::TestWithParam<const char*> {};

TEST_P(Workload, HasTheListsOfTheCpu) {
    const auto path = std::filesystem::path(COPPICE_SOURCE_DIR) / ".." / "shared" / "workloads" / GetParam();
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no workloads beside the checkout";
    const Skeleton tree = read_swc(path);
    for (const float graft : {0.0f, 0.6f}) {
        SCOPED_TRACE(graft);
        const Comparison c = compare(wrap(tree, graft));
        // The CPU looks at kMostNear segments for several regions together, which is too few for some.
        expect_same(c, static_cast<std::uint32_t>(c.lists / 10000));
        EXPECT_GT(c.rivals, 0u);
        const ListRoom room = usual_room(c.lists);
        EXPECT_LE(c.own, room.own) << "on the device the work would be done twice";
        EXPECT_LE(c.rivals, room.rivals) << "on the device the work would be done twice";
        RecordProperty(graft > 0 ? "grafted" : "plain",
                       fmt::format("{} lists, {} own, {} rivals, longest {}, missed {}", c.lists, c.own,
                                   c.rivals, c.longest, c.missed));
    }
}
INSTANTIATE_TEST_SUITE_P(Shared, Workload,
                         testing::Values("tree300.swc", "tree300hard.swc", "tree3k.swc", "tree3khard.swc",
                                         "tree30k.swc"),
                         [](const auto& test) {
                             const std::string name = test.param;
                             return name.substr(0, name.find('.'));
                         });

// Every segment is a tube; each region has one quad that spans a box.
Scene in_boxes(const Skeleton& skeleton, std::span<const Box3> boxes) {
    Scene scene{skeleton, skeleton, {}, {}};
    for (const NodeId n : nodes(skeleton)) {
        scene.tube.push_back(n);
        scene.control.region_node.push_back(n);
        const Box3& box = boxes[n.index()];
        if (box.empty()) continue;
        const auto v = static_cast<std::uint32_t>(scene.control.anchors.size());
        for (const Vec3 p : {box.low, box.high, box.low, box.high}) {
            scene.control.cage.positions.push_back(p);
            scene.control.anchors.push_back(box.center());
        }
        scene.control.cage.quads.push_back({v, v + 1, v + 2, v + 3});
        scene.control.region.push_back(n.index());
    }
    return scene;
}

// A stem with many twigs at its end, in all directions; twig i is node i + 2.
Skeleton hub(std::uint32_t twigs) {
    std::vector<NodeId> parent{NodeId::none(), NodeId(0)};
    std::vector<Vec3> position{{0, 0, 0}, {0, 0, 1}};
    std::vector<float> radius{0.05f, 0.05f};
    std::mt19937 random(7);
    std::uniform_real_distribution<float> any(-1, 1);
    for (std::uint32_t i = 0; i < twigs; ++i) {
        parent.emplace_back(1);
        position.push_back(position[1] + normalized(Vec3{any(random), any(random), any(random)}));
        radius.push_back(0.02f);
    }
    return {std::move(parent), std::move(position), std::move(radius)};
}

TEST(FindContactsOnDevice, AHubHasTheListsOfTheCpuUntilOneIsCut) {
    for (const std::uint32_t twigs : {64u, 65u, 200u, 511u}) {
        SCOPED_TRACE(twigs);
        const Skeleton skeleton = hub(twigs);
        std::vector<Box3> boxes;
        for (const NodeId n : nodes(skeleton)) {
            boxes.push_back(skeleton.is_root(n) ? Box3{} : capsule_box({0, 0, 1}, skeleton.position(n), 0));
        }
        const Comparison c = compare(in_boxes(skeleton, boxes));
        expect_same(c);
        EXPECT_GE(c.longest, twigs);
    }
    const Skeleton skeleton = hub(512);
    const Scene scene = in_boxes(skeleton, std::vector<Box3>(skeleton.size(), Box3{{-1, -1, 0}, {1, 1, 2}}));
    const ConvolutionField field(skeleton, {});
    HostExecutor executor;
    EXPECT_TRUE(find_contacts(executor, input_of(scene, field)).state.is_cut);
}

// Only the root's region, which all segments are relatives of, would be cut: it is left without a box.
TEST(FindContactsOnDevice, OthersTakeNoPlaceOfRelatives) {
    const Skeleton stem = crowded_stem();
    std::vector<Box3> boxes(stem.size());
    boxes.back() = {{-1, -1, -1}, {1, 1, 2}};
    const Comparison c = compare(in_boxes(stem, boxes));
    expect_same(c);
    EXPECT_EQ(c.longest, 1u + 9u + 99u);
}

// Stems beside each other along x; nodes 2 i and 2 i + 1 are those of stem i.
Skeleton stems(std::uint32_t count, float apart, float radius) {
    std::vector<NodeId> parent;
    std::vector<Vec3> position;
    for (std::uint32_t i = 0; i < count; ++i) {
        const float x = apart * static_cast<float>(i);
        parent.insert(parent.end(), {NodeId::none(), NodeId(2 * i)});
        position.insert(position.end(), {{x, 0, 0}, {x, 0, 1}});
    }
    return {std::move(parent), std::move(position), std::vector<float>(2 * count, radius)};
}

TEST(FindContactsOnDevice, OfACrowdTheNearestArePicked) {
    const Skeleton skeleton = stems(100, 0.01f, 2);
    // The boxes differ, so that each region has other neighbours.
    std::vector<Box3> boxes;
    for (const NodeId n : nodes(skeleton)) {
        const float x = skeleton.position(n).x;
        boxes.push_back({{x - 1, -1, 0}, {x + 1, 1, 1}});
    }
    const Comparison c = compare(in_boxes(skeleton, boxes));
    expect_same(c);
    EXPECT_EQ(c.rivals, 200u * kMostRivals);
    // Equally far away: the first are kept.
    expect_same(compare(in_boxes(stems(60, 0, 0.1f), std::vector<Box3>(120, Box3{{-1, -1, 0}, {1, 1, 1}}))));
}

TEST(FindContactsOnDevice, OnlySoManyAreLookedAtInTheOrderOfTheCpu) {
    const Skeleton skeleton = stems(1100, 0.001f, 2);
    std::vector<Box3> boxes(skeleton.size());
    boxes[1] = {{1, -1, 0}, {1.2f, 1, 1}};  // the nearest are the last that are seen, or are not
    const Comparison c = compare(in_boxes(skeleton, boxes));
    expect_same(c);
    EXPECT_EQ(c.rivals, kMostRivals);
}

Skeleton with_positions(const Skeleton& s, std::vector<Vec3> positions) {
    return {
        {s.parents().begin(), s.parents().end()}, std::move(positions), {s.radii().begin(), s.radii().end()}};
}

TEST(FindContactsOnDevice, FollowsABranchThatMovesWithTheTablesOfBefore) {
    Scene scene = wrap(zoo_skeleton("random_large_hard"));
    ConvolutionField field(scene.skeleton, {});
    HostExecutor executor;
    const ContactTables tables = upload_contacts(executor, contact_topology(input_of(scene, field)));
    const ContactGeometry before = upload_geometry(executor, input_of(scene, field));
    const auto order = rival_order(executor, tables, before);

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
    now.set_regions(regions_of(scene), scene.tree());
    const ContactGeometry geometry = upload_geometry(executor, input_of(scene, now));
    const ListRoom room = usual_room(tables.tubes.size());
    const ContactsFound found = find_contacts(executor, tables, geometry, order, room);
    EXPECT_FALSE(found.state.is_cut);
    expect_same(compare(scene, now, found.lists));
    const DeviceLists of_before = find_contacts(executor, tables, before, order, room).lists;
    EXPECT_GT(compare(scene, now, of_before).own_differ, 0u) << "nothing has moved";
}

TEST(FindContactsOnDevice, ListsWithoutRoomAreEmptyAndThenMadeAgain) {
    const Scene scene = wrap(zoo_skeleton("random_large_hard"));
    ConvolutionField field(scene.skeleton, {});
    field.set_regions(regions_of(scene), scene.tree());
    HostExecutor executor;
    const ContactTables tables = upload_contacts(executor, contact_topology(input_of(scene, field)));
    const ContactGeometry geometry = upload_geometry(executor, input_of(scene, field));
    const auto order = rival_order(executor, tables, geometry);
    const ListRoom none{10, 0};
    const DeviceLists little = begin_contacts(executor, tables, geometry, order, none);
    EXPECT_FALSE(state_of(executor, little).fits(none));
    EXPECT_EQ(little.own.segments.size(), 10u);
    for (const RegionLists& lists : {little.own, little.rivals})
        EXPECT_EQ(std::ranges::count(lists.first, 0u), static_cast<std::ptrdiff_t>(lists.first.size()));
    expect_same(compare(scene, field, find_contacts(executor, tables, geometry, order, none).lists));
}

TEST(ContactTopology, NeedsTubesInDepthFirstOrderAndContact) {
    // The second child of the root comes before the first one's child.
    const Skeleton skeleton({NodeId::none(), NodeId(0), NodeId(0), NodeId(1)},
                            {{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 0, 2}}, {0.1f, 0.1f, 0.1f, 0.1f});
    const Scene broad = in_boxes(skeleton, std::vector<Box3>(4));
    EXPECT_THROW(contact_topology(input_of(broad, ConvolutionField(skeleton, {}))), PreconditionBroken);
    const Scene scene = in_boxes(stems(2, 1, 0.1f), std::vector<Box3>(4));
    EXPECT_THROW(contact_topology(input_of(scene, ConvolutionField(scene.skeleton, {.contact = 0}))),
                 PreconditionBroken);
}

TEST(RegionBoxes, AreThoseOfTheCpu) {
    const Scene scene = wrap(zoo_skeleton("random_large_hard"));
    const ConvolutionField field(scene.skeleton, {});
    HostExecutor executor;
    const ContactTables tables = upload_contacts(executor, contact_topology(input_of(scene, field)));
    const auto boxes = region_boxes(executor, tables, upload_geometry(executor, input_of(scene, field)));
    const std::vector<FieldRegion> regions = regions_of(scene);
    ASSERT_EQ(boxes.size(), regions.size());
    for (std::size_t r = 0; r < boxes.size(); ++r) {
        EXPECT_EQ(boxes[r].low, regions[r].box.low);
        EXPECT_EQ(boxes[r].high, regions[r].box.high);
    }
}

std::vector<Box3> random_boxes(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> at(-10, 10), size(0, 0.5f);
    std::vector<Box3> boxes(count);
    for (Box3& b : boxes) {
        b.low = {at(random), at(random), at(random)};
        b.high = b.low + Vec3{size(random), size(random), size(random)};
    }
    return boxes;
}

class TreeOfBoxes : public testing::TestWithParam<std::size_t> {};

TEST_P(TreeOfBoxes, HasTheOrderTheBoxesAndTheVisitsOfTheCpu) {
    const std::vector<Box3> boxes = random_boxes(GetParam(), 3);
    const BoxTree on_cpu(boxes, {});
    HostExecutor executor;
    const auto order = box_order(executor, std::span<const Box3>(boxes));
    const DeviceBoxTree tree = box_tree(executor, std::span<const Box3>(boxes), order);
    for (std::uint32_t place = 0; place < on_cpu.size(); ++place) {
        ASSERT_EQ(tree.items()[place], on_cpu.item(place));
    }
    // The CPU's last level is one box if there are at most eight items.
    ASSERT_EQ(tree.level_count(), std::max(1u, on_cpu.level_count() - (GetParam() <= 8)));
    for (std::uint32_t l = 0; l < tree.level_count(); ++l) {
        for (std::uint32_t i = 0; i < on_cpu.level(l).size(); ++i) {
            const Box3 box = tree.level(l)[i / 8].box(i % 8);
            ASSERT_EQ(box.low, on_cpu.level(l)[i].low);
            ASSERT_EQ(box.high, on_cpu.level(l)[i].high);
        }
    }
    for (Box3& query : random_boxes(20, 4)) {
        query = query.inflated(1);
        std::vector<std::uint32_t> expected, found;
        on_cpu.visit_overlapping(query, [&](std::uint32_t i) { expected.push_back(i); });
        tree.visit_overlapping(query, [&](std::uint32_t i) {
            found.push_back(i);
            return true;
        });
        EXPECT_EQ(found, expected);
        found.clear();
        tree.visit_overlapping(query, [&](std::uint32_t i) {
            found.push_back(i);
            return found.size() < 3;
        });
        expected.resize(std::min<std::size_t>(3, expected.size()));
        EXPECT_EQ(found, expected);
    }
}
INSTANTIATE_TEST_SUITE_P(Sizes, TreeOfBoxes,
                         testing::Values(1, 2, 7, 8, 9, 63, 64, 65, 511, 512, 513, 5000, 70000));

TEST(DeviceBoxTree, FindsBoxesThatHaveMovedSinceTheyWereSorted) {
    const std::vector<Box3> boxes = random_boxes(3000, 5), moved = random_boxes(3000, 6);
    HostExecutor executor;
    const auto order = box_order(executor, std::span<const Box3>(boxes));
    const DeviceBoxTree tree = box_tree(executor, std::span<const Box3>(moved), order);
    const Box3 query{{-2, -2, -2}, {3, 1, 2}};
    std::vector<std::uint32_t> expected, found;
    for (std::uint32_t i = 0; i < moved.size(); ++i) {
        if (moved[i].overlaps(query)) expected.push_back(i);
    }
    tree.visit_overlapping(query, [&](std::uint32_t i) {
        found.push_back(i);
        return true;
    });
    std::ranges::sort(found);
    EXPECT_EQ(found, expected);
    EXPECT_GT(found.size(), 10u);
}

TEST(SortRanks, SortsListsOfAnyLength) {
    std::mt19937 random(1);
    for (std::uint32_t count = 0; count < 600; count += 1 + count / 10) {
        std::vector<std::uint32_t> list(count);
        for (std::uint32_t& rank : list) rank = static_cast<std::uint32_t>(random() % 1000);
        std::vector<std::uint32_t> sorted = list;
        std::ranges::sort(sorted);
        sort_ranks(list.data(), count);
        EXPECT_EQ(list, sorted);
    }
}

}  // namespace
}  // namespace coppice::cuda
