#include "coppice/pipeline/knots/draft_internal.h"

#include <algorithm>

#include "coppice/base/number_set.h"
#include "coppice/mesh/face_view.h"
#include "coppice/pipeline/knots/crossings_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::pipeline_internal {
namespace {

// One for each handful of new quads about one vertex.
std::vector<Box3> boxes_of_new(const Pieces& pieces) {
    std::vector<Box3> out;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const KnotQuads& made = pieces[i].quads;
        std::uint32_t center = 0xffffffffu;
        for (std::size_t q = 0; q < made.patch.quads.size(); ++q) {
            if (made.is_new[q] == 0) continue;
            if (made.patch.quads[q][2] != center) out.emplace_back();
            center = made.patch.quads[q][2];
            out.back().extend(box_of(made.patch.quads[q], made.positions));
        }
    }
    return out;
}

// Vertices of the mesh and of the pieces in one row of numbers: those of the mesh come first, and of each
// piece those that are not of the mesh.
class CommonNumbers {
  public:
    CommonNumbers(std::span<const Vec3> kept, const Pieces& pieces) : kept_(kept), pieces_(pieces) {
        std::size_t sum = kept.size();
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            first_.push_back(sum);
            ring_.push_back(ring_vertices(pieces[i].surface.group));
            sum += pieces[i].quads.positions.size() - ring_.back().size();
        }
        first_.push_back(sum);
    }

    std::size_t count() const { return first_.back(); }
    std::uint32_t number(std::size_t piece, std::uint32_t vertex) const {
        const auto& ring = ring_[piece];
        if (vertex < ring.size()) return ring[vertex];
        return static_cast<std::uint32_t>(first_[piece] + vertex - ring.size());
    }
    Vec3 position(std::uint32_t number) const {
        if (number < kept_.size()) return kept_[number];
        const auto piece = static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), number) -
                                                    first_.begin() - 1);
        return pieces_[piece].quads.positions[number - first_[piece] + ring_[piece].size()];
    }

  private:
    std::span<const Vec3> kept_;
    const Pieces& pieces_;
    std::vector<std::size_t> first_;                // per piece: the number of its first own vertex
    std::vector<std::vector<std::uint32_t>> ring_;  // per piece
};

}  // namespace

Draft draft(const TubeQuads& before, const Knots& knots, const Pieces& pieces, const Context& ctx) {
    const BoxTree near(boxes_of_new(pieces), ctx);
    const CommonNumbers common(before.mesh.positions, pieces);
    Draft out;
    std::vector<Quad> quads;
    const auto add = [&](Quad quad, Slice slice, std::uint32_t piece, std::uint32_t number,
                         std::uint32_t seam) {
        quads.push_back(quad);
        out.slice.push_back(slice);
        out.piece.push_back(piece);
        out.number.push_back(number);
        out.seam.push_back(seam);
    };
    for (const std::uint32_t q : quads_near(before, near, ctx)) {
        const Slice slice = before.slices.of_quad(q);
        if (!knots.contains(slice)) add(before.mesh.quads[q], slice, Draft::kNoPiece, q, kNoSeam);
    }
    for (const std::uint8_t is_new : {0, 1}) {
        out.first_new = out.size();
        for (std::uint32_t i = 0; i < pieces.size(); ++i) {
            const KnotSurface& surface = pieces[i].surface;
            const KnotQuads& made = pieces[i].quads;
            for (std::uint32_t q = 0; q < made.patch.quads.size(); ++q) {
                Quad quad = made.patch.quads[q];
                if (made.is_new[q] != is_new) continue;
                if (is_new == 0 && !near.meets(box_of(quad, made.positions))) continue;
                for (std::uint32_t& v : quad) v = common.number(i, v);
                const std::uint32_t t = made.patch.triangle[q];
                add(quad, surface.slice[t], i, q, surface.seam[t]);
            }
        }
    }
    NumberSet used(common.count());
    for (const Quad& q : quads) {
        for (const std::uint32_t v : q) used.add(v);
    }
    used.count();
    for (const std::uint32_t v : used.ascending()) out.quads.positions.push_back(common.position(v));
    for (Quad& q : quads) {
        for (std::uint32_t& v : q) v = used.rank(v);
        out.quads.add_face(q);
    }
    return out;
}

std::vector<FacePair> new_crossings(const Draft& draft, const Context& ctx) {
    if (draft.first_new == draft.size()) return {};
    std::vector<FacePair> pairs = crossing_faces(SurfaceTree(draft.quads, ctx), kMostPairs, ctx).pairs;
    std::erase_if(pairs, [&](const FacePair& p) { return p.second < draft.first_new; });
    return pairs;
}

}  // namespace coppice::pipeline_internal
