#include <algorithm>

#include "coppice/base/sort.h"
#include "coppice/pipeline/live/patches_internal.h"
#include "coppice/pipeline/repair/tube_rows_internal.h"

namespace coppice::pipeline_internal {
namespace {

// Returns per node of the prepared skeleton one of the given skeleton: the first that it corresponds to, or
// for an inserted node, that of the next node towards the tip.
std::vector<NodeId> given_nodes(std::span<const NodeId> new_of_old, const Skeleton& prepared) {
    std::vector<NodeId> out(prepared.size());
    for (std::size_t i = new_of_old.size(); i-- > 0;)
        out[new_of_old[i].index()] = NodeId(static_cast<std::uint32_t>(i));
    for (std::uint32_t n = prepared.size(); n-- > 0;) {
        if (!out[n]) out[n] = out[prepared.children(NodeId(n))[0].index()];
    }
    return out;
}

// Numbers the vertices and quads of the mesh, and sets the patches that own them.
void number(SurfacePatches& out, std::vector<std::uint32_t>& owner_of_quad, const QuadMesh& mesh,
            const QuadBuild& build, const TubeRows& tube_rows) {
    const RemeshTrace& remeshed = build.remeshed;
    const Buffer<std::uint32_t> cage_quad = build.refinement.owners();
    out.positions.assign(build.refined.begin(), build.refined.end());
    for (const std::uint32_t f : cage_quad) out.owner.push_back(tube_rows.get_tube(f).index());
    // Per vertex of the mesh.
    std::vector<std::uint32_t> place = remeshed.kept_vertices(build.refinement.vertex_count());
    for (std::size_t v = place.size(); v < mesh.positions.size(); ++v) {
        place.push_back(static_cast<std::uint32_t>(out.positions.size()));
        out.positions.push_back(mesh.positions[v]);
    }
    out.quads.assign(mesh.quads.begin(), mesh.quads.end());
    for (Quad& q : out.quads) {
        for (std::uint32_t& v : q) v = place[v];
    }
    for (std::uint32_t q = 0; q < build.refinement.quad_count(); ++q) {
        const TubeRow s = tube_rows.of_quad(q);
        if (remeshed.stays(s)) owner_of_quad.push_back(tube_rows.tube(s).index());
    }
    // The vertices of a repair patch follow those of the previous one.
    std::uint32_t patch = tube_rows.tubes().size();
    for (const RemeshTrace::RepairPatch& repair_patch : remeshed.repair_patches) {
        auto end = static_cast<std::uint32_t>(out.owner.size());
        for (std::uint32_t k = 0; k < repair_patch.quads; ++k) {
            for (const std::uint32_t v : out.quads[owner_of_quad.size()]) end = std::max(end, v + 1);
            owner_of_quad.push_back(patch);
        }
        out.owner.resize(end, patch++);
    }
}

// Determines the nodes that repair patches cover, and those from which they are made: the field of some
// segments, and the rings at which they end.
void find_pieces(SurfacePatches& out, const QuadBuild& build, const TubeRows& tube_rows,
                 std::span<const NodeId> given, const CompressedRows<std::uint32_t>& given_all) {
    std::uint32_t patch = out.tube_count();
    const auto get_node = [&](TubeRow s) { return out.node[tube_rows.tube(s).index()]; };
    for (const RemeshTrace::RepairPatch& repair_patch : build.remeshed.repair_patches) {
        std::vector<NodeId>& all = out.piece_nodes.emplace_back();
        for (const TubeRow s : repair_patch.tube_rows) all.push_back(get_node(s));
        sort_unique(all);
        std::vector<NodeId>& needs = out.piece_needs.emplace_back(all);
        for (const TubeRow s : repair_patch.adjacent) needs.push_back(get_node(s));
        for (const NodeId s : repair_patch.segments) {
            const NodeId n = build.prepared_node[s.index()];
            needs.push_back(given[n.index()]);
            for (const std::uint32_t i : given_all[n.index()]) needs.push_back(NodeId(i));
        }
        for (const std::uint32_t q : out.quads_of[patch++]) {
            for (const std::uint32_t v : out.quads[q]) {
                if (out.owner[v] < out.tube_count()) needs.push_back(out.node[out.owner[v]]);
            }
        }
        sort_unique(needs);
    }
}

}  // namespace

SurfacePatches take_apart(const QuadMesh& mesh, const QuadBuild& build, std::span<const NodeId> new_of_old,
                          const Skeleton& prepared) {
    const Skeleton& tubes = build.tubes;
    const TubeRows tube_rows(build.cage, tubes, build.refinement.levels());
    const std::vector<NodeId> given = given_nodes(new_of_old, prepared);
    SurfacePatches out;
    std::vector<std::uint32_t> count(new_of_old.size(), 0), node;
    for (const NodeId t : nodes(tubes)) {
        const NodeId n = given[build.prepared_node[build.cage.region_node[t.index()].index()].index()];
        out.node.push_back(n);
        node.push_back(n.index());
        out.place.push_back(count[n.index()]++);
    }
    std::vector<std::uint32_t> stands_for;
    for (const NodeId n : new_of_old) stands_for.push_back(n.index());
    out.tubes_of = group_by(node, new_of_old.size());
    std::vector<std::uint32_t> owner_of_quad;
    number(out, owner_of_quad, mesh, build, tube_rows);
    const std::size_t patches = tubes.size() + build.remeshed.repair_patches.size();
    out.quads_of = group_by(owner_of_quad, patches);
    out.vertices = group_by(out.owner, patches);
    out.local.resize(out.owner.size());
    for (std::size_t p = 0; p < patches; ++p) {
        const auto row = out.vertices[p];
        for (std::uint32_t i = 0; i < row.size(); ++i) out.local[row[i]] = i;
    }
    find_pieces(out, build, tube_rows, given, group_by(stands_for, prepared.size()));
    return out;
}

}  // namespace coppice::pipeline_internal
