#include <algorithm>
#include <iterator>
#include <utility>

#include "coppice/base/id.h"
#include "coppice/pipeline/fit/kept_quads_internal.h"
#include "coppice/pipeline/repair/crossings_internal.h"

namespace coppice::pipeline_internal {

KeptQuads::KeptQuads(QuadRows before, const ControlMesh& cage, const QuadMesh& after)
    : rows_(std::move(before)),
      cage_(&cage),
      old_vertex_(after.positions.size(), kNoIndex),
      new_vertex_(rows_.mesh.positions.size(), kNoIndex) {
    find_in(after);
}

bool KeptQuads::is_same(const Quad& old, const Quad& now, std::span<const Vec3> positions) const {
    for (std::size_t k = 0; k < now.size(); ++k) {
        if (old_vertex_[now[k]] == old[k]) continue;
        if (old_vertex_[now[k]] != kNoIndex || new_vertex_[old[k]] != kNoIndex ||
            !(positions[now[k]] == rows_.mesh.positions[old[k]]))
            return false;
    }
    return true;
}

void KeptQuads::find_in(const QuadMesh& after) {
    std::uint32_t q = 0;
    for (const Quad& now : after.quads) {
        while (q < rows_.mesh.quads.size() && !is_same(rows_.mesh.quads[q], now, after.positions)) ++q;
        if (q == rows_.mesh.quads.size()) break;
        for (std::size_t k = 0; k < now.size(); ++k) {
            old_vertex_[now[k]] = rows_.mesh.quads[q][k];
            new_vertex_[rows_.mesh.quads[q][k]] = now[k];
        }
        old_quad_.push_back(q++);
    }
}

FacePairs KeptQuads::crossings(const PolygonMesh& moved, std::uint32_t limit, const Context& ctx) {
    for (std::size_t v = 0; v < new_vertex_.size(); ++v) {
        if (new_vertex_[v] != kNoIndex) rows_.mesh.positions[v] = moved.positions[new_vertex_[v]];
    }
    // Removed rows keep their positions: they invalidate no proof that the others need.
    const TubeRows tube_rows(*cage_, rows_.tubes, rows_.levels);
    std::vector<std::uint32_t> kept;
    auto at = old_quad_.begin();
    for (const std::uint32_t q : unproved_quads(rows_.mesh, tube_rows, ctx)) {
        at = std::lower_bound(at, old_quad_.end(), q);
        if (at == old_quad_.end()) break;
        if (*at == q) kept.push_back(static_cast<std::uint32_t>(at - old_quad_.begin()));
    }
    const FaceView all(moved);
    const auto first_new = static_cast<std::uint32_t>(old_quad_.size());
    std::vector<Box3> boxes;
    for (std::uint32_t f = first_new; f < all.size(); ++f) boxes.push_back(all.box(f));
    std::vector<std::uint32_t> faces;
    std::ranges::set_union(kept, faces_near(all.first(first_new), boxes, ctx), std::back_inserter(faces));
    for (std::uint32_t f = first_new; f < all.size(); ++f) faces.push_back(f);
    return crossings_among(all, faces, limit, ctx);
}

}  // namespace coppice::pipeline_internal
