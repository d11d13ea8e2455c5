#include "coppice/subdivision/untangle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/number_set.h"
#include "coppice/base/parallel.h"
#include "coppice/subdivision/flat_ends_internal.h"
#include "coppice/subdivision/fold_clusters_internal.h"
#include "coppice/subdivision/folded_faces_internal.h"
#include "coppice/subdivision/patch_index_internal.h"
#include "coppice/subdivision/project_internal.h"

namespace coppice {
namespace {

constexpr int kRings = 2;                // of faces around the bad ones that move too, at most
constexpr int kPassesPerRing = 3;        // before free passes take another ring
constexpr float kWeight = 0.6f;          // part of the way to the neighbours' mean
constexpr int kSteps = 3;                // along the gradient, at most, while passes project
constexpr float kDamping = 0.95f;        // of each
constexpr float kLongestStep = 0.3f;     // in distances to the anchor
constexpr float kTolerance = 1e-4f;      // of the distance to the anchor
constexpr std::uint32_t kPatience = 10;  // passes without gain
constexpr std::size_t kMostMoves = 25;  // of each vertex of a cluster, on average: a tangle is not worth more
constexpr std::size_t kFacesPerRange = 1024;
constexpr std::size_t kLarge = 8192;  // vertices of a cluster that is worth all threads
constexpr std::size_t kClustersPerRange = 8;

// A vertex that has moved, where it was at first, and where it was when the fewest faces were bad.
struct Touched {
    std::uint32_t vertex;
    Vec3 first, best;
};

// What stays the same from pass to pass.
struct Task {
    std::span<Vec3> positions;
    std::span<const Vec3> anchors;
    std::span<const Quad> quads;
    Regions regions;
    FieldRef field;
};

// A vertex on its way back to the surface; on a flat end it keeps to the plane.
class Mover {
  public:
    Mover() = default;
    Mover(std::uint32_t slot, Vec3 smoothed, Vec3 anchor, const ClipPlane* plane, bool is_inside_end)
        : slot_(slot),
          plane_(plane),
          point_(on_plane(smoothed)),
          reach_(distance(smoothed, anchor)),
          is_inside_end_(is_inside_end) {}

    std::uint32_t slot() const { return slot_; }
    Vec3 point() const { return point_; }

    // False when the vertex has arrived.
    bool advance(Reading here) {
        if (is_inside_end_) return false;
        if (plane_ != nullptr) {
            const Vec3 n = plane_->normal;
            here.gradient -= n * (dot(n, here.gradient) / length_squared(n));
        }
        const float slope_squared = length_squared(here.gradient);
        if (!(slope_squared > 0)) return false;
        Vec3 step = newton_step(here, slope_squared, kDamping);
        const float size = length(step);
        if (!std::isfinite(size)) return false;
        if (size > kLongestStep * reach_) step *= kLongestStep * reach_ / size;
        point_ = on_plane(point_ + step);
        const float left = (1 - kDamping) * size * reach_ + size * size;
        return left > kTolerance * reach_ * reach_;
    }

  private:
    Vec3 on_plane(Vec3 p) const { return plane_ == nullptr ? p : dropped(p, *plane_); }

    std::uint32_t slot_ = 0;
    const ClipPlane* plane_ = nullptr;
    Vec3 point_;
    float reach_ = 0;
    bool is_inside_end_ = false;
};

// Collects movers of one region and writes where they end.
class MoverBatch {
  public:
    MoverBatch(FieldRef field, std::span<Vec3> out) : field_(field), out_(out) {}

    void add(const Mover& mover) { movers_[size_++] = mover; }

    void move(std::uint32_t region, int steps) {
        const float per_level = 1 / field_.level();
        for (int step = 0; step < steps && size_ > 0; ++step) {
            for (std::size_t k = 0; k < size_; ++k) points_[k] = movers_[k].point();
            field_.sample(region, std::span(points_).first(size_), std::span(samples_).first(size_));
            readings_.interpret(std::span(samples_).first(size_), per_level);
            std::size_t left = 0;
            for (std::size_t k = 0; k < size_; ++k) {
                Mover& mover = movers_[k];
                if (mover.advance(readings_.at(k, samples_[k], per_level))) {
                    movers_[left++] = mover;
                } else {
                    out_[mover.slot()] = mover.point();
                }
            }
            size_ = left;
        }
        for (std::size_t k = 0; k < size_; ++k) out_[movers_[k].slot()] = movers_[k].point();
        size_ = 0;
    }

  private:
    FieldRef field_;
    std::span<Vec3> out_;
    std::size_t size_ = 0;
    std::array<Mover, kFieldBatch> movers_;
    std::array<Vec3, kFieldBatch> points_;
    std::array<FieldSample, kFieldBatch> samples_;
    Readings readings_;
};

// What holds for all clusters.
struct Surface {
    const Task& task;
    int levels;
    PatchStars stars;
    FlatEnds ends;
    FoldedFaces folds;
};

// What came of one cluster.
struct Outcome {
    std::uint32_t passes = 0;
    std::uint64_t moved = 0;
    std::vector<std::uint32_t> still_bad;  // ascending
};

// The work around the bad faces of one cluster, pass by pass.
class Untangling {
  public:
    Untangling(const Surface& surface, const FoldClusters& clusters, std::size_t cluster)
        : task_(surface.task),
          surface_(surface),
          clusters_(clusters),
          vertex_count_(clusters.vertices[cluster].size()),
          bad_(clusters.bad[cluster].begin(), clusters.bad[cluster].end()),
          vertex_set_(vertex_count_),
          touched_set_(vertex_count_),
          face_set_(clusters.faces[cluster].size()),
          least_bad_(bad_) {}

    Outcome run(const UntangleOptions& options, const Context& ctx) {
        Outcome out;
        const auto projected = static_cast<std::uint32_t>(options.projected_passes);
        std::uint32_t best_pass = 0;
        std::size_t moves = 0;
        while (!bad_.empty() && out.passes < static_cast<std::uint32_t>(options.passes) &&
               out.passes < std::max(best_pass, projected) + kPatience &&
               moves < kMostMoves * vertex_count_) {
            ctx.throw_if_cancelled();
            ++out.passes;
            collect_active(rings(static_cast<int>(out.passes) - options.projected_passes));
            moves += active_.size();
            move_active(out.passes <= projected ? kSteps : 0, ctx);
            find_bad(ctx);
            if (bad_.size() < least_bad_.size()) {
                least_bad_ = bad_;
                best_pass = out.passes;
                for (Touched& t : touched_) t.best = task_.positions[t.vertex];
            }
        }
        for (const Touched& t : touched_) {
            task_.positions[t.vertex] = t.best;
            out.moved += t.best != t.first;
        }
        out.still_bad = std::move(least_bad_);
        return out;
    }

  private:
    // Free passes begin with the bad faces alone and reach farther where that does not help.
    static int rings(int free_passes) {
        return free_passes <= 0 ? kRings : std::min(kRings, (free_passes - 1) / kPassesPerRing);
    }

    // The corners of the bad faces and of so many rings around them, as far as the cluster reaches; and all
    // faces that have such a corner: no others change, and every bad face is one of them.
    void collect_active(int rings) {
        active_.clear();
        faces_.clear();
        vertex_places_.clear();
        face_places_.clear();
        const auto add_face = [&](std::uint32_t face) {
            const std::uint32_t place = clusters_.face_place(face);
            if (!face_set_.add(place)) return false;
            faces_.push_back(face);
            face_places_.push_back(place);
            return true;
        };
        const auto add_corners = [&](std::uint32_t face) {
            if (!add_face(face)) return;
            for (const std::uint32_t v : task_.quads[face]) {
                if (!clusters_.may_move(v) || !vertex_set_.add(clusters_.vertex_place(v))) continue;
                active_.push_back(v);
                vertex_places_.push_back(clusters_.vertex_place(v));
            }
        };
        for (const std::uint32_t face : bad_) add_corners(face);
        std::size_t begin = 0;
        for (int ring = 0; ring < rings; ++ring) {
            const std::size_t end = active_.size();
            for (; begin < end; ++begin) {
                surface_.stars.for_each_corner(active_[begin], [&](QuadCorner c) { add_corners(c.quad); });
            }
        }
        for (; begin < active_.size(); ++begin) {
            surface_.stars.for_each_corner(active_[begin], [&](QuadCorner c) { add_face(c.quad); });
        }
        for (const std::uint32_t v : vertex_places_) vertex_set_.remove(v);
        for (const std::uint32_t f : face_places_) face_set_.remove(f);
    }

    Vec3 smoothed(std::uint32_t vertex) const {
        const Vec3 p = task_.positions[vertex];
        Vec3 way;
        float count = 0;
        surface_.stars.for_each_corner(vertex, [&](QuadCorner c) {
            way += task_.positions[task_.quads[c.quad][(c.corner + 1) & 3]] - p;
            count += 1;
        });
        return p + way * (kWeight / count);
    }

    void move_active(int steps, const Context& ctx) {
        moved_.resize(active_.size());
        parallel_for_ranges(ctx, active_.size(), kFieldBatch,
                            [&](IndexRange range) { move_range(range, steps); });
        for (std::size_t k = 0; k < active_.size(); ++k) {
            Vec3& p = task_.positions[active_[k]];
            if (touched_set_.add(vertex_places_[k])) touched_.push_back({active_[k], p, p});
            if (is_finite(moved_[k])) p = moved_[k];
        }
    }

    Mover mover(std::uint32_t slot) const {
        const std::uint32_t vertex = active_[slot];
        const FlatEnds::Place place = surface_.ends.of_vertex(surface_.stars, surface_.levels, vertex);
        const ClipPlane* plane = place.end == FlatEnds::kNone ? nullptr : &task_.regions.clips[place.end];
        return {slot, smoothed(vertex), task_.anchors[vertex], plane, plane != nullptr && !place.on_rim};
    }

    // As many vertices as a batch holds, by region.
    void move_range(IndexRange range, int steps) {
        std::array<std::pair<std::uint32_t, std::uint32_t>, kFieldBatch> order;  // region, index in active_
        for (std::size_t k = range.begin; k < range.end; ++k) {
            const std::uint32_t region = task_.regions.of_face[surface_.stars.owner(active_[k])];
            order[k - range.begin] = {region, static_cast<std::uint32_t>(k)};
        }
        std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(range.size()));
        MoverBatch batch(task_.field, moved_);
        std::uint32_t region = order[0].first;
        for (std::size_t k = 0; k < range.size(); ++k) {
            if (order[k].first != region) {
                batch.move(region, steps);
                region = order[k].first;
            }
            batch.add(mover(order[k].second));
        }
        batch.move(region, steps);
    }

    void find_bad(const Context& ctx) {
        verdicts_.resize(faces_.size());
        parallel_for(ctx, faces_.size(), kFacesPerRange, [&](std::size_t k) {
            verdicts_[k] = surface_.folds.is_bad(task_.quads[faces_[k]]) ? 1 : 0;
        });
        bad_.clear();
        for (std::size_t k = 0; k < faces_.size(); ++k) {
            if (verdicts_[k] != 0) bad_.push_back(faces_[k]);
        }
        std::sort(bad_.begin(), bad_.end());
    }

    const Task& task_;
    const Surface& surface_;
    const FoldClusters& clusters_;
    std::size_t vertex_count_;
    std::vector<std::uint32_t> bad_, active_, faces_;
    std::vector<std::uint32_t> vertex_places_, face_places_;  // of active_ and faces_ in their cluster
    std::vector<std::uint8_t> verdicts_;
    std::vector<Vec3> moved_;
    std::vector<Touched> touched_;
    NumberSet vertex_set_, touched_set_, face_set_;
    std::vector<std::uint32_t> least_bad_;
};

std::vector<Outcome> untangle_each(const Surface& surface, const FoldClusters& clusters,
                                   const UntangleOptions& options, const Context& ctx) {
    std::vector<Outcome> out(clusters.size());
    const auto is_large = [&](std::size_t i) { return clusters.vertices[i].size() >= kLarge; };
    parallel_for_uneven(ctx, out.size(), kClustersPerRange, is_large, [&](std::size_t i, const Context& c) {
        out[i] = Untangling(surface, clusters, i).run(options, c);
    });
    return out;
}

}  // namespace

UntangleReport untangle(const RefinedQuads& surface, const PatchRefinement& patches,
                        const ProjectionTarget& target, const UntangleOptions& options, const Context& ctx) {
    const auto& [positions, anchors, quads] = surface;
    const Regions regions{target.region, target.clips};
    check_fields(options, "untangle");
    check_projection("untangle", positions.size(), anchors.size(), patches, regions, target.field);
    if (quads.size() != patches.quad_count()) throw InvalidInput("untangle: give the refined quads");
    if (options.passes == 0) return {};
    const Task task{positions, anchors, quads, regions, target.field};
    const Surface at{task, patches.levels(), PatchStars(patches.cage(), patches.levels()),
                     FlatEnds(regions.clips), FoldedFaces{positions, anchors, options.quality}};
    const std::vector<std::uint32_t> bad = at.folds.all(patches, ctx);
    if (bad.empty()) return {};
    const FoldClusters clusters(bad, quads, positions.size(), at.stars);
    UntangleReport report{.bad_before = bad.size(), .still_bad = clusters.fixed};
    for (const Outcome& outcome : untangle_each(at, clusters, options, ctx)) {
        report.passes = std::max(report.passes, outcome.passes);
        report.moved += outcome.moved;
        report.still_bad.insert(report.still_bad.end(), outcome.still_bad.begin(), outcome.still_bad.end());
    }
    std::sort(report.still_bad.begin(), report.still_bad.end());
    report.bad_after = report.still_bad.size();
    return report;
}

}  // namespace coppice
