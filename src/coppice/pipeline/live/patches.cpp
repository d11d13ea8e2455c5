#include <algorithm>

#include "coppice/base/sort.h"
#include "coppice/pipeline/live/patches_internal.h"

namespace coppice::pipeline_internal {
namespace {

// Per node of the prepared skeleton, one of the given skeleton: the first that it stands for, or where it was
// put in between, that of the next node towards the tip.
std::vector<NodeId> given_nodes(std::span<const NodeId> new_of_old, const Skeleton& prepared) {
    std::vector<NodeId> out(prepared.size());
    for (std::size_t i = new_of_old.size(); i-- > 0;)
        out[new_of_old[i].index()] = NodeId(static_cast<std::uint32_t>(i));
    for (std::uint32_t n = prepared.size(); n-- > 0;) {
        if (!out[n]) out[n] = out[prepared.children(NodeId(n))[0].index()];
    }
    return out;
}

// The vertices and quads of the mesh, and the patches that own them.
void number(SurfacePatches& out, std::vector<std::uint32_t>& owner_of_quad, const QuadMesh& mesh,
            const QuadTrace& trace, const Slices& slices) {
    const RemeshTrace& remeshed = trace.remeshed;
    const Buffer<std::uint32_t> cage_quad = trace.patches->owners();
    out.positions.assign(trace.refined.begin(), trace.refined.end());
    for (const std::uint32_t f : cage_quad) out.owner.push_back(slices.tube_of(f).index());
    std::vector<std::uint32_t> place;  // per vertex of the mesh
    auto gone = remeshed.gone.begin();
    for (std::uint32_t v = 0; v < trace.refined.size(); ++v) {
        if (gone != remeshed.gone.end() && *gone == v) {
            ++gone;
        } else {
            place.push_back(v);
        }
    }
    for (std::size_t v = place.size(); v < mesh.positions.size(); ++v) {
        place.push_back(static_cast<std::uint32_t>(out.positions.size()));
        out.positions.push_back(mesh.positions[v]);
    }
    out.quads.assign(mesh.quads.begin(), mesh.quads.end());
    for (Quad& q : out.quads) {
        for (std::uint32_t& v : q) v = place[v];
    }
    for (std::uint32_t q = 0; q < trace.patches->quad_count(); ++q) {
        const Slice s = slices.of_quad(q);
        if (remeshed.stays(s)) owner_of_quad.push_back(slices.tube(s).index());
    }
    // The vertices of a piece follow those of the one before it.
    std::uint32_t patch = slices.tubes().size();
    for (const RemeshTrace::Piece& piece : remeshed.pieces) {
        auto end = static_cast<std::uint32_t>(out.owner.size());
        for (std::uint32_t k = 0; k < piece.quads; ++k) {
            for (const std::uint32_t v : out.quads[owner_of_quad.size()]) end = std::max(end, v + 1);
            owner_of_quad.push_back(patch);
        }
        out.owner.resize(end, patch++);
    }
}

// What pieces cover, and what they are made of: the field of some segments, and the rings at which they end.
void find_pieces(SurfacePatches& out, const QuadTrace& trace, const Slices& slices,
                 std::span<const NodeId> given, const CompressedRows<std::uint32_t>& given_all) {
    std::uint32_t patch = out.tube_count();
    const auto node_of = [&](Slice s) { return out.node[slices.tube(s).index()]; };
    for (const RemeshTrace::Piece& piece : trace.remeshed.pieces) {
        std::vector<NodeId>& all = out.piece_nodes.emplace_back();
        for (const Slice s : piece.slices) all.push_back(node_of(s));
        sort_unique(all);
        std::vector<NodeId>& needs = out.piece_needs.emplace_back(all);
        for (const Slice s : piece.beside) needs.push_back(node_of(s));
        for (const NodeId s : piece.segments) {
            const NodeId n = trace.field_segment[s.index()];
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

SurfacePatches take_apart(const QuadSurface& surface, const QuadTrace& trace,
                          std::span<const NodeId> new_of_old, const Skeleton& prepared) {
    const Skeleton& tubes = *trace.tubes;
    const Slices slices(surface.cage, tubes, trace.patches->levels());
    const std::vector<NodeId> given = given_nodes(new_of_old, prepared);
    SurfacePatches out;
    std::vector<std::uint32_t> count(new_of_old.size(), 0), node;
    for (const NodeId t : nodes(tubes)) {
        const NodeId n = given[trace.segment[t.index()].index()];
        out.node.push_back(n);
        node.push_back(n.index());
        out.place.push_back(count[n.index()]++);
    }
    std::vector<std::uint32_t> stands_for;
    for (const NodeId n : new_of_old) stands_for.push_back(n.index());
    out.tubes_of = group_by(node, new_of_old.size());
    std::vector<std::uint32_t> owner_of_quad;
    number(out, owner_of_quad, surface.mesh, trace, slices);
    const std::size_t patches = tubes.size() + trace.remeshed.pieces.size();
    out.quads_of = group_by(owner_of_quad, patches);
    out.vertices = group_by(out.owner, patches);
    out.local.resize(out.owner.size());
    for (std::size_t p = 0; p < patches; ++p) {
        const auto row = out.vertices[p];
        for (std::uint32_t i = 0; i < row.size(); ++i) out.local[row[i]] = i;
    }
    find_pieces(out, trace, slices, given, group_by(stands_for, prepared.size()));
    return out;
}

}  // namespace coppice::pipeline_internal
