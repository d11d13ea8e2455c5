#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "coppice/cage/cage.h"
#include "coppice/cage/graft.h"
#include "coppice/cage/separate_branches.h"
#include "coppice/cuda/lists/contact_topology.h"
#include "coppice/field/contact_lists.h"
#include "coppice/field/convolution_field.h"
#include "coppice/field/list_kernel.h"
#include "coppice/skeleton/prepare.h"

namespace coppice::cuda {

inline std::vector<NodeId> composed(std::span<const NodeId> first, std::span<const NodeId> second) {
    std::vector<NodeId> both(first.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
        if (first[i]) both[i] = second[first[i].index()];
    }
    return both;
}

// A skeleton with its tubes and their cage, as created by the pipeline.
struct Scene {
    Skeleton skeleton, tubes;
    std::vector<NodeId> tube;
    ControlMesh control;
    TubeTree tree() const { return {tubes, tube}; }
};

inline Scene wrap(const Skeleton& given, float graft = 0.6f) {
    const GraftResult grafted = graft_branches(prepare(given).skeleton, graft, SectionEnd::closed, {});
    SeparatedSkeleton parted = separate_branches(grafted.tubes, {}, {});
    const std::vector<NodeId> source = composed(parted.source, grafted.source);
    ControlMesh control = build_control_mesh(parted.skeleton, source, {}, {});
    return {grafted.skeleton, std::move(parted.skeleton), composed(grafted.tube, parted.tube),
            std::move(control)};
}

inline std::vector<FieldRegion> make_regions(const Scene& scene) {
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

inline ContactInput make_input(const Scene& scene, const ConvolutionField& field) {
    return {scene.skeleton, scene.tree(), field, scene.control};
}

using List = std::span<const std::uint32_t>;

template <class Lists>
List get_list(const Lists& lists, std::size_t r) {
    return std::span(lists.segments).subspan(lists.first[r], lists.first[r + 1] - lists.first[r]);
}

// Returns the competing segments of a region by testing all segments.
inline std::vector<std::uint32_t> find_competitors(const Scene& scene, const ConvolutionField& field,
                                                   const FieldRegion& region, List own) {
    const Skeleton& s = scene.skeleton;
    const Vec3 center = region.box.center();
    std::vector<std::pair<float, std::uint32_t>> found;
    for (const NodeId n : nodes(s)) {
        if (!scene.tube[n.index()] || (s.is_root(n) && !s.is_tip(n))) continue;
        const SegmentSupport capsule = competitor_capsule(
            s.is_root(n) ? Segment{s.position(n), s.position(n), s.radius(n), s.radius(n)} : s.segment(n));
        if (!may_touch(capsule, region.box, center, 0.5f * region.box.diagonal())) continue;
        if (std::ranges::find(own, n.index()) != own.end()) continue;
        found.emplace_back(clearance(capsule, center), n.index());
    }
    std::ranges::sort(found);
    if (found.size() > kMaxCompetitors) found.resize(kMaxCompetitors);
    std::vector<std::uint32_t> out;
    for (const auto& [away, segment] : found) out.push_back(segment);
    std::ranges::sort(out, {}, [&](std::uint32_t i) { return std::pair(field.axes()[i], i); });
    return out;
}

// Creates a scene in which every segment is a tube and each region has one quad that spans a box.
inline Scene in_boxes(const Skeleton& skeleton, std::span<const Box3> boxes) {
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

// Creates a stem with many twigs at its end, in all directions; twig i is node i + 2.
inline Skeleton hub(std::uint32_t twigs) {
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

// Creates adjacent stems along x; nodes 2 i and 2 i + 1 belong to stem i.
inline Skeleton stems(std::uint32_t count, float apart, float radius) {
    std::vector<NodeId> parent;
    std::vector<Vec3> position;
    for (std::uint32_t i = 0; i < count; ++i) {
        const float x = apart * static_cast<float>(i);
        parent.insert(parent.end(), {NodeId::none(), NodeId(2 * i)});
        position.insert(position.end(), {{x, 0, 0}, {x, 0, 1}});
    }
    return {std::move(parent), std::move(position), std::vector<float>(2 * count, radius)};
}

inline Skeleton with_positions(const Skeleton& s, std::vector<Vec3> positions) {
    return {
        {s.parents().begin(), s.parents().end()}, std::move(positions), {s.radii().begin(), s.radii().end()}};
}

inline std::vector<Box3> random_boxes(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> at(-10, 10), size(0, 0.5f);
    std::vector<Box3> boxes(count);
    for (Box3& b : boxes) {
        b.low = {at(random), at(random), at(random)};
        b.high = b.low + Vec3{size(random), size(random), size(random)};
    }
    return boxes;
}

}  // namespace coppice::cuda
