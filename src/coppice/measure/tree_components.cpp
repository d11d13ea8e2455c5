#include "coppice/measure/tree_components.h"

#include <algorithm>
#include <utility>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/id.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/skeleton/measure.h"

namespace coppice {
namespace {

/// Returns all segments, and trees of one node, in the frame of the mesh.
CapsuleTree compute_capsules(const Skeleton& skeleton, Vec3d origin, const Context& ctx) {
    std::vector<NodeId> names;
    std::vector<RoundCone> cones;
    const Vec3d shift = skeleton.origin() - origin;
    for (const NodeId n : nodes(skeleton)) {
        const bool alone = skeleton.is_root(n) && skeleton.is_tip(n);
        if (skeleton.is_root(n) && !alone) continue;
        const Vec3 p = skeleton.position(n);
        const float r = skeleton.radius(n);
        const Segment s = alone ? Segment{p, p, r, r} : skeleton.segment(n);
        names.push_back(n);
        cones.push_back(round_cone<double>(Vec3d(s.a) + shift, Vec3d(s.b) + shift, s.radius_a, s.radius_b));
    }
    return {std::move(names), std::move(cones), ctx};
}

/// Returns for every vertex the node of the nearest segment; an invalid id if no segment is near.
std::vector<NodeId> nearest_nodes(const PolygonMesh& mesh, const CapsuleTree& capsules, const Context& ctx) {
    std::vector<NodeId> out(mesh.positions.size());
    for_each_nearest(
        capsules, ctx, out.size(), [&](std::size_t v) { return Vec3d(mesh.positions[v]); },
        [&](std::size_t v, CapsuleTree::Nearest nearest) {
            if (nearest.capsule != kNoIndex) out[v] = capsules.node(nearest.capsule);
        });
    return out;
}

/// Returns the component with most vertices of each tree that has any.
std::vector<std::uint32_t> main_parts(std::vector<std::pair<std::uint32_t, std::uint32_t>> tree_and_part) {
    std::ranges::sort(tree_and_part);
    std::vector<std::uint32_t> out;
    for (std::size_t i = 0; i < tree_and_part.size();) {
        const std::uint32_t tree = tree_and_part[i].first;
        std::uint32_t best = 0;
        std::size_t most = 0;
        while (i < tree_and_part.size() && tree_and_part[i].first == tree) {
            const std::size_t begin = i;
            while (i < tree_and_part.size() && tree_and_part[i] == tree_and_part[begin]) ++i;
            if (i - begin <= most) continue;
            most = i - begin;
            best = tree_and_part[begin].second;
        }
        out.push_back(best);
    }
    return out;
}

}  // namespace

TreeComponentsReport compute_tree_components(const PolygonMesh& mesh, const Skeleton& skeleton,
                                             const Context& ctx) {
    TreeComponentsReport out;
    for (const NodeId n : nodes(skeleton)) out.trees += skeleton.is_root(n) ? 1 : 0;
    DisjointSets sets(mesh.positions.size());
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        for (const std::uint32_t v : mesh.face(f)) sets.join(mesh.face(f)[0], v);
    }
    std::vector<LooseComponent> part(
        mesh.positions.size());  // indexed by the representative vertex of each component
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        LooseComponent& p = part[sets.find(mesh.face(f)[0])];
        out.parts += p.faces++ == 0 ? 1 : 0;
    }
    if (out.parts <= 1) return out;

    const std::vector<NodeId> root = tree_roots(skeleton);
    const std::vector<NodeId> nearest =
        nearest_nodes(mesh, compute_capsules(skeleton, mesh.origin, ctx), ctx);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> tree_and_part;
    for (std::uint32_t v = 0; v < nearest.size(); ++v) {
        const std::uint32_t p = sets.find(v);
        if (part[p].faces == 0 || !nearest[v]) continue;
        tree_and_part.emplace_back(root[nearest[v].index()].index(), p);
        if (!part[p].node || nearest[v] < part[p].node) part[p].node = nearest[v];
    }
    for (const std::uint32_t p : main_parts(std::move(tree_and_part))) part[p].faces = 0;
    std::erase_if(part, [](const LooseComponent& p) { return p.faces == 0; });
    out.loose = part.size();
    std::ranges::stable_sort(part, std::ranges::greater(), &LooseComponent::faces);
    part.resize(std::min(part.size(), TreeComponentsReport::kMaxNamed));
    for (LooseComponent& p : part) {
        if (p.node) p.place = skeleton.origin() + Vec3d(skeleton.position(p.node));
    }
    out.largest = std::move(part);
    return out;
}

}  // namespace coppice
