#include "coppice/pipeline/repair/candidate_internal.h"

#include <algorithm>

#include "coppice/base/id.h"
#include "coppice/base/number_set.h"
#include "coppice/mesh/face_view.h"
#include "coppice/pipeline/repair/crossings_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::pipeline_internal {
namespace {

// One box for each group of new quads around one vertex.
std::vector<Box3> boxes_of_new(const RepairPatches& repair_patches) {
    std::vector<Box3> out;
    for (std::size_t i = 0; i < repair_patches.size(); ++i) {
        const PatchQuads& made = repair_patches[i].quads;
        std::uint32_t center = 0xffffffffu;
        for (std::size_t q = 0; q < made.patch.quads.size(); ++q) {
            if (made.is_new[q] == 0) continue;
            if (made.patch.quads[q][2] != center) out.emplace_back();
            center = made.patch.quads[q][2];
            out.back().extend(compute_box(made.patch.quads[q], made.positions));
        }
    }
    return out;
}

// Common indices of the vertices of the mesh and of the patches: those of the mesh first, then for each patch
// those that are not in the mesh.
class CommonNumbers {
  public:
    CommonNumbers(std::span<const Vec3> kept, const RepairPatches& repair_patches)
        : kept_(kept), repair_patches_(repair_patches) {
        std::size_t sum = kept.size();
        for (std::size_t i = 0; i < repair_patches.size(); ++i) {
            first_.push_back(sum);
            ring_.push_back(ring_vertices(repair_patches[i].surface.group));
            sum += repair_patches[i].quads.positions.size() - ring_.back().size();
        }
        first_.push_back(sum);
    }

    std::size_t count() const { return first_.back(); }
    std::uint32_t number(std::size_t repair_patch, std::uint32_t vertex) const {
        const auto& ring = ring_[repair_patch];
        if (vertex < ring.size()) return ring[vertex];
        return static_cast<std::uint32_t>(first_[repair_patch] + vertex - ring.size());
    }
    Vec3 position(std::uint32_t number) const {
        if (number < kept_.size()) return kept_[number];
        const auto repair_patch = static_cast<std::size_t>(
            std::upper_bound(first_.begin(), first_.end(), number) - first_.begin() - 1);
        return repair_patches_[repair_patch]
            .quads.positions[number - first_[repair_patch] + ring_[repair_patch].size()];
    }

  private:
    std::span<const Vec3> kept_;
    const RepairPatches& repair_patches_;
    std::vector<std::size_t> first_;                // per patch: the index of its first own vertex
    std::vector<std::vector<std::uint32_t>> ring_;  // per patch
};

}  // namespace

CandidateQuads candidate(const TubeQuads& before, const RemovedRows& removed,
                         const RepairPatches& repair_patches, const Context& ctx) {
    const BoxTree near(boxes_of_new(repair_patches), ctx);
    const CommonNumbers common(before.mesh.positions, repair_patches);
    CandidateQuads out;
    std::vector<Quad> quads;
    const auto add = [&](Quad quad, TubeRow tube_row, std::uint32_t repair_patch, std::uint32_t number,
                         std::uint32_t cut_ring) {
        quads.push_back(quad);
        out.tube_row.push_back(tube_row);
        out.repair_patch.push_back(repair_patch);
        out.number.push_back(number);
        out.cut_ring.push_back(cut_ring);
    };
    for (const std::uint32_t q : quads_near(before, near, ctx)) {
        const TubeRow tube_row = before.tube_rows.of_quad(q);
        if (!removed.contains(tube_row)) add(before.mesh.quads[q], tube_row, kNoIndex, q, kNoIndex);
    }
    for (const std::uint8_t is_new : {0, 1}) {
        out.first_new = out.size();
        for (std::uint32_t i = 0; i < repair_patches.size(); ++i) {
            const PatchSurface& surface = repair_patches[i].surface;
            const PatchQuads& made = repair_patches[i].quads;
            for (std::uint32_t q = 0; q < made.patch.quads.size(); ++q) {
                Quad quad = made.patch.quads[q];
                if (made.is_new[q] != is_new) continue;
                if (is_new == 0 && !near.meets(compute_box(quad, made.positions))) continue;
                for (std::uint32_t& v : quad) v = common.number(i, v);
                const std::uint32_t t = made.patch.triangle[q];
                add(quad, surface.tube_row[t], i, q, surface.cut_ring[t]);
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

std::vector<FacePair> new_crossings(const CandidateQuads& candidate, const Context& ctx) {
    if (candidate.first_new == candidate.size()) return {};
    std::vector<FacePair> pairs = crossing_faces(SurfaceTree(candidate.quads, ctx), kMaxPairs, ctx).pairs;
    std::erase_if(pairs, [&](const FacePair& p) { return p.second < candidate.first_new; });
    return pairs;
}

}  // namespace coppice::pipeline_internal
