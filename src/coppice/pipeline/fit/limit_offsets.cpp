#include <algorithm>
#include <iterator>
#include <numeric>
#include <vector>

#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"
#include "coppice/measure/intersections.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/mesh/shape.h"
#include "coppice/pipeline/fit/limit_offsets_internal.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::size_t kLimitOffsetsGrain = 4096;
constexpr double kFlatCorner = 0.05;  // scaled Jacobian below which a face must not get worse
constexpr std::uint32_t kMaxCrossings = 1'000'000;
constexpr std::uint32_t kMaxRounds = 40;

using Faces = std::vector<std::uint32_t>;  // ascending, unique

Faces where_set(std::span<const std::uint8_t> set) {
    Faces faces;
    for (std::uint32_t f = 0; f < set.size(); ++f) {
        if (set[f]) faces.push_back(f);
    }
    return faces;
}

/// Finds the faces that moving makes worse.
class Limiter {
  public:
    Limiter(const MovingSurface& surface, std::span<float> offsets, std::uint32_t halvings,
            const Context& ctx)
        : surface_(surface), start_(surface.start), offsets_(offsets), halvings_(halvings), ctx_(ctx) {
        moved_.corners = start_.corners;
        moved_.first = start_.first;
        apply_offsets(surface_, offsets_, moved_.positions, ctx_);
        changed_.assign(start_.face_count(), 1);
        moved_last_.resize(start_.face_count());
        std::iota(moved_last_.begin(), moved_last_.end(), 0u);
    }

    LimitResult run() {
        LimitResult result;
        for (; result.rounds < kMaxRounds; ++result.rounds) {
            ctx_.throw_if_cancelled();
            Faces bad = new_folds();
            if (bad.empty()) {
                FacePairs found = crossings_of_changed();
                result.complete = result.complete && found.complete;
                if (!result.complete) break;
                std::fill(changed_.begin(), changed_.end(), std::uint8_t{0});
                bad = newly_crossing(std::move(found));
                if (bad.empty()) return result;
            }
            take_back(bad, result.rounds);
        }
        std::fill(offsets_.begin(), offsets_.end(), 0.0f);
        return result;
    }

  private:
    /// Checks only the faces that moved last: no others can have folded since.
    Faces new_folds() const {
        std::vector<std::uint8_t> folded(moved_last_.size(), 0);
        parallel_for(ctx_, folded.size(), kLimitOffsetsGrain, [&](std::size_t i) {
            const auto face = start_.face(moved_last_[i]);
            if (std::ranges::all_of(face, [&](auto v) { return offsets_[v] == 0; })) return;
            const bool turned =
                dot(area_vector(face, start_.positions), area_vector(face, moved_.positions)) <= 0;
            folded[i] = turned || scaled_jacobian(face, moved_.positions) <
                                      std::min(kFlatCorner, scaled_jacobian(face, start_.positions));
        });
        Faces faces;
        for (const std::uint32_t i : where_set(folded)) faces.push_back(moved_last_[i]);
        return faces;
    }

    /// Pairs of changed faces with any face: all in the first call, later those with boxes that overlap a
    /// changed one.
    FacePairs crossings_of_changed() {
        if (!looked_) {
            looked_ = true;
            return surface_.search(moved_, kMaxCrossings, ctx_);
        }
        const FaceView moved(moved_);
        std::vector<Box3> boxes;
        for (const std::uint32_t f : where_set(changed_)) boxes.push_back(moved.box(f));
        return crossings_among(moved, faces_near(moved, boxes, ctx_), kMaxCrossings, ctx_);
    }

    /// Returns the faces of the pairs that did not cross before.
    Faces newly_crossing(FacePairs found) const {
        if (found.pairs.empty()) return {};
        Faces faces;
        for (const FacePair& p : found.pairs) faces.insert(faces.end(), {p.first, p.second});
        sort_unique(faces);
        const FacePairs before = crossings_among(start_, faces, kMaxCrossings, ctx_);
        std::vector<FacePair> fresh;
        std::ranges::set_difference(found.pairs, before.pairs, std::back_inserter(fresh));
        faces.clear();
        for (const FacePair& p : fresh) faces.insert(faces.end(), {p.first, p.second});
        sort_unique(faces);
        return faces;
    }

    std::vector<std::uint32_t> collect_corners(const Faces& faces) const {
        std::vector<std::uint32_t> corners;
        for (const std::uint32_t f : faces) {
            const auto face = start_.face(f);
            corners.insert(corners.end(), face.begin(), face.end());
        }
        sort_unique(corners);
        return corners;
    }

    Faces faces_at(std::span<const std::uint32_t> vertices) const {
        Faces faces;
        for (const std::uint32_t v : vertices) {
            const auto about = surface_.faces_of[v];
            faces.insert(faces.end(), about.begin(), about.end());
        }
        sort_unique(faces);
        return faces;
    }

    void take_back(const Faces& bad, std::uint32_t round) {
        const bool wholly = round >= halvings_;
        std::vector<std::uint32_t> at = collect_corners(bad);
        if (wholly) at = collect_corners(faces_at(at));
        for (const std::uint32_t v : at) {
            offsets_[v] *= wholly ? 0.0f : 0.5f;
            moved_.positions[v] = start_.positions[v] + offsets_[v] * surface_.direction[v];
        }
        moved_last_ = faces_at(at);
        for (const std::uint32_t f : moved_last_) changed_[f] = 1;
    }

    const MovingSurface& surface_;
    const PolygonMesh& start_;
    std::span<float> offsets_;
    std::uint32_t halvings_;
    const Context& ctx_;
    PolygonMesh moved_;
    Faces moved_last_;
    std::vector<std::uint8_t> changed_;  // per face, since the last search for crossings
    bool looked_ = false;
};

}  // namespace

FacePairs all_crossings(const PolygonMesh& moved, std::uint32_t limit, const Context& ctx) {
    return crossing_faces(SurfaceTree(moved, ctx), limit, ctx);
}

CompressedRows<std::uint32_t> faces_by_vertex(const PolygonMesh& mesh) {
    return compress_rows<std::uint32_t>(mesh.positions.size(), [&](const auto& put) {
        for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
            for (const std::uint32_t v : mesh.face(f)) put(v, f);
        }
    });
}

Vec3d area_vector(std::span<const std::uint32_t> face, std::span<const Vec3> positions) {
    const Vec3d a(positions[face[0]]);
    Vec3d sum, from = Vec3d(positions[face[1]]) - a;
    for (std::size_t k = 2; k < face.size(); ++k) {
        const Vec3d to = Vec3d(positions[face[k]]) - a;
        sum += cross(from, to);
        from = to;
    }
    return sum / 2;
}

void apply_offsets(const MovingSurface& surface, std::span<const float> offsets, Buffer<Vec3>& positions,
                   const Context& ctx) {
    positions = surface.start.positions;
    parallel_for(ctx, positions.size(), kLimitOffsetsGrain, [&](std::size_t v) {
        if (offsets[v] != 0) positions[v] = positions[v] + offsets[v] * surface.direction[v];
    });
}

LimitResult limit_offsets(const MovingSurface& surface, std::span<float> offsets, std::uint32_t halvings,
                          const Context& ctx) {
    return Limiter(surface, offsets, halvings, ctx).run();
}

}  // namespace coppice::pipeline_internal
