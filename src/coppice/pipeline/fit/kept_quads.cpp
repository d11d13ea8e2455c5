#include <algorithm>
#include <iterator>

#include "coppice/pipeline/fit/kept_quads_internal.h"
#include "coppice/pipeline/repair/crossings_internal.h"

namespace coppice::pipeline_internal {

KeptQuads::KeptQuads(const QuadBuild& build, const Context& ctx)
    : build_(&build), vertices_(build.remeshed.kept_vertices(build.refinement.vertex_count())) {
    rows_.positions = build.refined;
    rows_.quads = build.refinement.quads(ctx);
    const TubeRows tube_rows(build.cage, build.tubes, build.refinement.levels());
    for (std::uint32_t q = 0; q < rows_.quads.size(); ++q) {
        if (build.remeshed.stays(tube_rows.of_quad(q))) quads_.push_back(q);
    }
}

FacePairs KeptQuads::crossings(const PolygonMesh& moved, const Skeleton& tubes, std::uint32_t limit,
                               const Context& ctx) {
    // Removed rows keep their positions: they invalidate no proof that the others need.
    for (std::size_t v = 0; v < vertices_.size(); ++v) rows_.positions[vertices_[v]] = moved.positions[v];
    const TubeRows tube_rows(build_->cage, tubes, build_->refinement.levels());
    std::vector<std::uint32_t> kept;
    auto at = quads_.begin();
    for (const std::uint32_t q : unproved_quads(rows_, tube_rows, ctx)) {
        at = std::lower_bound(at, quads_.end(), q);
        if (at == quads_.end()) break;
        if (*at == q) kept.push_back(static_cast<std::uint32_t>(at - quads_.begin()));
    }
    const FaceView all(moved);
    const auto first_new = static_cast<std::uint32_t>(quads_.size());
    std::vector<Box3> boxes;
    for (std::uint32_t f = first_new; f < all.size(); ++f) boxes.push_back(all.box(f));
    std::vector<std::uint32_t> faces;
    std::ranges::set_union(kept, faces_near(all.first(first_new), boxes, ctx), std::back_inserter(faces));
    for (std::uint32_t f = first_new; f < all.size(); ++f) faces.push_back(f);
    return crossings_among(all, faces, limit, ctx);
}

}  // namespace coppice::pipeline_internal
