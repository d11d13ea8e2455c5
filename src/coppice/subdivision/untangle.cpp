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
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/subdivision/fold_clusters_internal.h"
#include "coppice/subdivision/folded_faces_internal.h"
#include "coppice/subdivision/kernel/unfold_kernel.h"
#include "coppice/subdivision/project_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kFacesPerRange = 1024;
constexpr std::size_t kLarge = 8192;  // vertices of a cluster that is processed by all threads
constexpr std::size_t kClustersPerRange = 8;

// A vertex that has moved, its initial position, and its position at the minimum number of bad faces.
struct Touched {
    std::uint32_t vertex;
    Vec3 first, best;
};

// Data that do not change between passes.
struct Task {
    std::span<Vec3> positions;
    std::span<const Vec3> anchors;
    std::span<const Quad> quads;
    Regions regions;
    FieldRef field;
};

// Collects movers of one region and writes their final positions.
class MoverBatch {
  public:
    MoverBatch(FieldRef field, std::span<Vec3> out) : field_(field), out_(out) {}

    void add(std::uint32_t slot, const Mover& mover) {
        slot_[size_] = slot;
        movers_[size_++] = mover;
    }

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
                    slot_[left] = slot_[k];
                    movers_[left++] = mover;
                } else {
                    out_[slot_[k]] = mover.point();
                }
            }
            size_ = left;
        }
        for (std::size_t k = 0; k < size_; ++k) out_[slot_[k]] = movers_[k].point();
        size_ = 0;
    }

  private:
    FieldRef field_;
    std::span<Vec3> out_;
    std::size_t size_ = 0;
    std::array<std::uint32_t, kFieldBatch> slot_;  // index of the output
    std::array<Mover, kFieldBatch> movers_;
    std::array<Vec3, kFieldBatch> points_;
    std::array<FieldSample, kFieldBatch> samples_;
    Readings readings_;
};

// Data shared by all clusters.
struct Surface {
    const Task& task;
    int levels;
    PatchStars stars;
    FlatEnds ends;
    FoldedFaces folds;
};

// Result of one cluster.
struct Outcome {
    std::uint32_t passes = 0;
    std::uint64_t moved = 0;
    std::vector<std::uint32_t> still_bad;  // ascending
};

// Unfolds the bad faces of one cluster, pass by pass.
class Untangling {
  public:
    Untangling(const Surface& surface, const FoldClusters& clusters, std::size_t cluster)
        : task_(surface.task),
          surface_(surface),
          clusters_(clusters),
          vertex_count_(static_cast<std::uint32_t>(clusters.vertices[cluster].size())),
          bad_(clusters.bad[cluster].begin(), clusters.bad[cluster].end()),
          vertex_set_(vertex_count_),
          touched_set_(vertex_count_),
          face_set_(clusters.faces[cluster].size()),
          min_bad_(bad_) {}

    Outcome run(const UntangleOptions& options, const Context& ctx) {
        UnfoldSchedule schedule(options.passes, options.projected_passes,
                                static_cast<std::uint32_t>(bad_.size()), vertex_count_);
        while (schedule.begin_pass()) {
            ctx.throw_if_cancelled();
            collect_active(schedule.rings());
            move_active(schedule.steps(), ctx);
            find_bad(ctx);
            if (schedule.end_pass(static_cast<std::uint32_t>(active_.size()),
                                  static_cast<std::uint32_t>(bad_.size()))) {
                min_bad_ = bad_;
                for (Touched& t : touched_) t.best = task_.positions[t.vertex];
            }
        }
        Outcome out{.passes = schedule.pass()};
        for (const Touched& t : touched_) {
            task_.positions[t.vertex] = t.best;
            out.moved += t.best != t.first;
        }
        out.still_bad = std::move(min_bad_);
        return out;
    }

  private:
    // Collects the corners of the bad faces and of the given number of rings around them, within the cluster;
    // and all faces that have such a corner: no others change, and every bad face is one of them.
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

    Mover mover(std::uint32_t vertex) const {
        const Vec3 start = smoothed(vertex, task_.positions, surface_.stars,
                                    [&](std::uint32_t quad) -> const Quad& { return task_.quads[quad]; });
        return {start, task_.anchors[vertex],
                surface_.ends.of_vertex(surface_.stars, surface_.levels, vertex), task_.regions.clips};
    }

    // Moves at most a batch of vertices, by region.
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
            batch.add(order[k].second, mover(active_[order[k].second]));
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
    std::uint32_t vertex_count_;
    std::vector<std::uint32_t> bad_, active_, faces_;
    std::vector<std::uint32_t> vertex_places_, face_places_;  // by active_ and faces_, in the cluster
    std::vector<std::uint8_t> verdicts_;
    std::vector<Vec3> moved_;
    std::vector<Touched> touched_;
    NumberSet vertex_set_, touched_set_, face_set_;
    std::vector<std::uint32_t> min_bad_;
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
    const FoldClusters clusters(bad, positions.size(), at.stars);
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

void list_fields(UntangleOptions& o, FieldList& list) {
    list.add(Field{"untangle_passes",
                   "Maximum number of smoothing passes around folded faces; 0 disables the unfolding.",
                   Unit::none, 0, 1000},
             o.passes);
    list.add(Field{"projected_passes",
                   "Number of the first smoothing passes, which return to the surface after each smoothing.",
                   Unit::none, 0, 1000},
             o.projected_passes);
    list.add(
        Field{"untangle_quality", "Scaled Jacobian below which a face counts as folded.", Unit::none, 0, 0.9},
        o.quality);
}

}  // namespace coppice
