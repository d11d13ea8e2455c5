#include "coppice/subdivision/project.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/subdivision/kernel/flat_ends.h"
#include "coppice/subdivision/project_internal.h"
#include "coppice/subdivision/ray_steps_internal.h"
#include "coppice/subdivision/relax_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kPointsPerRange = 16384;
constexpr std::size_t kEndsPerRange = 64;

// Data shared by all ranges of one pass.
struct Task {
    std::span<Vec3> positions;
    std::span<const Vec3> anchors;
    FieldRef field;
    const ProjectOptions& options;

    WalkRule walk_rule() const {
        return {options.damping, options.tolerance, options.max_stretch,
                options.method == ProjectionMethod::newton};
    }
};

// Collects vertices of one region and moves them together along their rays, so that the field evaluates many
// points per call.
class RayBatch {
  public:
    // Vertices without a surface along their rays are appended to `unprojected`.
    RayBatch(const Task& task, ProjectReport& report, std::vector<std::uint32_t>& unprojected)
        : task_(task), report_(report), unprojected_(unprojected) {}

    void add(std::uint32_t vertex, Vec3 anchor) {
        ++report_.vertices;
        const AnchorRay ray(anchor, task_.positions[vertex]);
        if (!ray.is_usable) return;
        const std::size_t k = size_++;
        vertex_[k] = vertex;
        rays_.anchor_x[k] = ray.anchor.x;
        rays_.anchor_y[k] = ray.anchor.y;
        rays_.anchor_z[k] = ray.anchor.z;
        rays_.direction_x[k] = ray.direction.x;
        rays_.direction_y[k] = ray.direction.y;
        rays_.direction_z[k] = ray.direction.z;
        rays_.t[k] = 1;
        rays_.inside[k] = 0;
        rays_.outside[k] = std::numeric_limits<float>::infinity();
        rays_.best_t[k] = 1;
        rays_.best_error[k] = std::numeric_limits<float>::infinity();
        rays_.point[k] = ray.anchor + ray.direction;
    }
    bool full() const { return size_ == kFieldBatch; }

    void move(std::uint32_t region) {
        const ProjectOptions& o = task_.options;
        RayRule rule{1 / task_.field.level(), o.tolerance, o.max_stretch, false};
        for (int evaluation = 1; size_ > 0 && evaluation <= o.max_evaluations; ++evaluation) {
            task_.field.sample(region, std::span(rays_.point).first(size_), std::span(sample_).first(size_));
            rule.slow = evaluation > 4 && evaluation % 2 == 0;
            advance_rays(rays_, size_, sample_, rule);
            report_.evaluations += size_;
            report_.max_evaluations =
                std::max(report_.max_evaluations, static_cast<std::uint32_t>(evaluation));
            release_arrived();
        }
        for (std::size_t k = 0; k < size_; ++k) give_up(k);
        size_ = 0;
    }

  private:
    // Keeps the vertices that are still running.
    void release_arrived() {
        std::size_t left = 0;
        for (std::size_t k = 0; k < size_; ++k) {
            if (rays_.outcome[k] != RayOutcome::running) {
                finish(k, rays_.outcome[k]);
                continue;
            }
            if (left < k) {
                rays_.copy(k, left);
                vertex_[left] = vertex_[k];
            }
            ++left;
        }
        size_ = left;
    }
    void finish(std::size_t k, RayOutcome outcome) {
        task_.positions[vertex_[k]] = rays_.point[k];
        if (outcome == RayOutcome::converged) return;
        ++report_.not_converged;
        report_.anchors_outside += outcome == RayOutcome::no_surface;
        unprojected_.push_back(vertex_[k]);
    }
    // The maximum number of evaluations is reached.
    void give_up(std::size_t k) {
        const bool is_empty = !(rays_.inside[k] > 0);
        const float t = is_empty ? 1.0f : rays_.best_t[k];
        const Vec3 anchor{rays_.anchor_x[k], rays_.anchor_y[k], rays_.anchor_z[k]};
        const Vec3 direction{rays_.direction_x[k], rays_.direction_y[k], rays_.direction_z[k]};
        rays_.point[k] = anchor + t * direction;
        if (is_empty) return finish(k, RayOutcome::no_surface);
        ++report_.not_converged;
        task_.positions[vertex_[k]] = rays_.point[k];
    }

    const Task& task_;
    ProjectReport& report_;
    std::vector<std::uint32_t>& unprojected_;
    std::size_t size_ = 0;
    std::array<std::uint32_t, kFieldBatch> vertex_;
    RayLanes rays_{};
    std::array<FieldSample, kFieldBatch> sample_{};
};

// The same along the gradient.
class GradientBatch {
  public:
    GradientBatch(const Task& task, ProjectReport& report) : task_(task), report_(report) {}

    void add(std::uint32_t vertex, Vec3 anchor) {
        ++report_.vertices;
        const AnchorRay ray(anchor, task_.positions[vertex]);
        if (!ray.is_usable) return;
        vertex_[size_] = vertex;
        std::construct_at(&walk_[size_], ray.anchor, ray.direction);
        ++size_;
    }
    bool full() const { return size_ == kFieldBatch; }

    void move(std::uint32_t region) {
        std::size_t active = size_;
        for (std::size_t k = 0; k < size_; ++k) active_[k] = static_cast<std::uint16_t>(k);
        const float per_level = 1 / task_.field.level();
        const WalkRule rule = task_.walk_rule();
        for (int evaluation = 1; active > 0 && evaluation <= task_.options.max_evaluations; ++evaluation) {
            for (std::size_t k = 0; k < active; ++k) point_[k] = walk_[active_[k]].point();
            task_.field.sample(region, std::span(point_).first(active), std::span(sample_).first(active));
            readings_.interpret(std::span(sample_).first(active), per_level);
            report_.evaluations += active;
            report_.max_evaluations =
                std::max(report_.max_evaluations, static_cast<std::uint32_t>(evaluation));
            std::size_t left = 0;
            for (std::size_t k = 0; k < active; ++k) {
                const std::uint16_t i = active_[k];
                const WalkOutcome outcome = walk_[i].advance(readings_.at(k, sample_[k], per_level), rule);
                if (outcome == WalkOutcome::running) {
                    active_[left++] = i;
                } else {
                    finish(i, outcome);
                }
            }
            active = left;
        }
        for (std::size_t k = 0; k < active; ++k) finish(active_[k], WalkOutcome::running);
        size_ = 0;
    }

  private:
    void finish(std::size_t i, WalkOutcome outcome) {
        task_.positions[vertex_[i]] = walk_[i].result(outcome);
        report_.not_converged += outcome == WalkOutcome::failed || outcome == WalkOutcome::no_surface;
        report_.anchors_outside += outcome == WalkOutcome::no_surface;
    }

    const Task& task_;
    ProjectReport& report_;
    std::size_t size_ = 0;
    std::array<std::uint32_t, kFieldBatch> vertex_;
    std::array<std::uint16_t, kFieldBatch> active_;
    std::array<GradientWalk, kFieldBatch> walk_;
    std::array<Vec3, kFieldBatch> point_;
    std::array<FieldSample, kFieldBatch> sample_;
    Readings readings_;
};

// Moves vertices of one region without a surface along their rays along the gradient, from their initial
// positions.
void follow_gradient(const Task& task, std::uint32_t region, std::vector<std::uint32_t>& unprojected,
                     ProjectReport& report) {
    if (unprojected.empty()) return;
    ProjectReport again;
    const auto batch = std::make_unique<GradientBatch>(task, again);
    for (const std::uint32_t v : unprojected) {
        batch->add(v, task.anchors[v]);
        if (batch->full()) batch->move(region);
    }
    batch->move(region);
    report.evaluations += again.evaluations;
    report.max_evaluations = std::max(report.max_evaluations, again.max_evaluations);
    report.not_converged -= unprojected.size() - again.not_converged;
    unprojected.clear();
}

// The elements of one pass.
struct Surface {
    const PatchRefinement& patches;
    const Regions& regions;
    const FlatVertices& flat;
};

// Fills the batch with the vertices of cage faces, region by region, except for those of flat ends.
template <class Batch, class Finish>
void project_faces(Batch& batch, const Task& task, const Surface& surface, IndexRange faces,
                   const Finish& finish_region) {
    const Regions& regions = surface.regions;
    const std::vector<bool>& is_flat = surface.flat.is_flat;
    Buffer<std::uint32_t> owned(surface.patches.max_owned());
    std::uint32_t region = regions.of_face[faces.begin];
    for (std::size_t f = faces.begin; f < faces.end; ++f) {
        if (regions.of_face[f] != region) {
            finish_region(region);
            region = regions.of_face[f];
        }
        const std::uint32_t count = surface.patches.owned_vertices(static_cast<std::uint32_t>(f), owned);
        for (std::uint32_t k = 0; k < count; ++k) {
            if (!is_flat.empty() && is_flat[owned[k]]) continue;
            batch.add(owned[k], task.anchors[owned[k]]);
            if (batch.full()) batch.move(region);
        }
    }
    finish_region(region);
}

ProjectReport project_faces(const Task& task, const Surface& surface, IndexRange faces) {
    ProjectReport report;
    if (task.options.method != ProjectionMethod::rays) {
        const auto batch = std::make_unique<GradientBatch>(task, report);
        project_faces(*batch, task, surface, faces, [&](std::uint32_t region) { batch->move(region); });
        return report;
    }
    std::vector<std::uint32_t> unprojected;
    const auto batch = std::make_unique<RayBatch>(task, report, unprojected);
    project_faces(*batch, task, surface, faces, [&](std::uint32_t region) {
        batch->move(region);
        follow_gradient(task, region, unprojected, report);
    });
    return report;
}

// Processes flat ends: all vertices are projected on the plane, the rim moves along rays within it, and the
// inside shrinks or grows by the minimum scale of the rim, so that it stays within.
class FlatEndPass {
  public:
    FlatEndPass(const Task& task, const Surface& surface)
        : task_(task), surface_(surface), rays_(std::make_unique<RayBatch>(task, report_, unprojected_)) {}

    void project(std::size_t end) {
        const ClipPlane& plane = surface_.regions.clips[end];
        const FlatVertices& flat = surface_.flat;
        const std::uint32_t begin = flat.first[end], stop = flat.first[end + 1];
        rim_.clear();
        for (std::uint32_t k = begin; k < stop; ++k) {
            const std::uint32_t v = flat.vertex[k];
            task_.positions[v] = dropped(task_.positions[v], plane);
            if (flat.on_rim[k] == 0) continue;
            const Vec3 anchor = dropped(task_.anchors[v], plane);
            rim_.push_back({v, anchor, distance(task_.positions[v], anchor)});
        }
        report_.vertices += stop - begin - rim_.size();
        report_.clipped += stop - begin;
        if (rim_.empty()) return;
        project_rim(surface_.regions.of_face[plane.first_quad], plane);
        const auto [center, scale] = rim_change();
        for (std::uint32_t k = begin; k < stop; ++k) {
            if (flat.on_rim[k] != 0) continue;
            Vec3& p = task_.positions[flat.vertex[k]];
            p = dropped(lerp(center, p, scale), plane);
        }
    }
    const ProjectReport& report() const { return report_; }

  private:
    struct RimVertex {
        std::uint32_t vertex;
        Vec3 anchor;
        float radius;
    };
    struct Change {
        Vec3 center;
        float scale;
    };

    void project_rim(std::uint32_t region, const ClipPlane& plane) {
        for (const RimVertex& r : rim_) {
            rays_->add(r.vertex, r.anchor);
            if (rays_->full()) rays_->move(region);
        }
        rays_->move(region);
        unprojected_.clear();  // they have kept their positions, so that the rim has no gaps
        for (const RimVertex& r : rim_) task_.positions[r.vertex] = dropped(task_.positions[r.vertex], plane);
    }

    Change rim_change() const {
        Change change{{}, std::numeric_limits<float>::infinity()};
        for (const RimVertex& r : rim_) {
            change.center += r.anchor / static_cast<float>(rim_.size());
            if (!(r.radius > 0)) continue;
            change.scale = std::min(change.scale, distance(task_.positions[r.vertex], r.anchor) / r.radius);
        }
        if (!std::isfinite(change.scale)) change.scale = 1;
        return change;
    }

    const Task& task_;
    const Surface& surface_;
    ProjectReport report_;
    std::vector<std::uint32_t> unprojected_;
    std::unique_ptr<RayBatch> rays_;
    std::vector<RimVertex> rim_;
};

ProjectReport project_ends(const Task& task, const Surface& surface, IndexRange ends) {
    FlatEndPass pass(task, surface);
    for (std::size_t end = ends.begin; end < ends.end; ++end) pass.project(end);
    return pass.report();
}

ProjectReport sum(ProjectReport a, const ProjectReport& b) { return a += b; }

ProjectReport project_once(const Task& task, const Surface& surface, const Context& ctx) {
    const int levels = surface.patches.levels();
    const std::size_t grain = std::max<std::size_t>(1, kPointsPerRange >> (2 * levels));
    const ProjectReport faces = parallel_reduce(
        ctx, surface.patches.cage().face_count(), grain, ProjectReport{},
        [&](IndexRange range) { return project_faces(task, surface, range); }, sum);
    const ProjectReport ends = parallel_reduce(
        ctx, surface.regions.clips.size(), kEndsPerRange, ProjectReport{},
        [&](IndexRange range) { return project_ends(task, surface, range); }, sum);
    return sum(faces, ends);
}

bool is_in_order(std::span<const ClipPlane> clips, std::size_t faces) {
    std::uint64_t taken = 0;
    return std::all_of(clips.begin(), clips.end(), [&](const ClipPlane& c) {
        const bool follows = c.quad_count > 0 && c.first_quad >= taken;
        taken = std::uint64_t{c.first_quad} + c.quad_count;
        const float size = length_squared(c.normal);
        return follows && taken <= faces && size > 0 && std::isfinite(size) && std::isfinite(c.offset);
    });
}

}  // namespace

ProjectReport& ProjectReport::operator+=(const ProjectReport& more) {
    vertices += more.vertices;
    evaluations += more.evaluations;
    max_evaluations = std::max(max_evaluations, more.max_evaluations);
    not_converged += more.not_converged;
    anchors_outside += more.anchors_outside;
    clipped += more.clipped;
    return *this;
}

void check_projection(std::string_view stage, std::size_t positions, std::size_t anchors,
                      const PatchRefinement& patches, const Regions& regions, FieldRef field) {
    const auto refuse = [&](const char* subject) {
        throw InvalidInput(fmt::format("{}: {}", stage, subject));
    };
    if (positions != patches.vertex_count() || anchors != patches.vertex_count()) {
        refuse("give one position and one anchor per refined vertex");
    }
    if (regions.of_face.size() != patches.cage().face_count()) refuse("give one region per cage quad");
    if (!is_in_order(regions.clips, patches.cage().face_count())) {
        refuse("give clip planes with a normal and with quads of the cage, in the order of these quads");
    }
    if (!(field.level() > 0)) refuse("the level of the field must be greater than 0");
}

ProjectReport project(Buffer<Vec3>& positions, std::span<const Vec3> anchors, const PatchRefinement& patches,
                      const ProjectionTarget& target, const ProjectOptions& options, const Context& ctx) {
    const auto& [field, region, clips] = target;
    const Regions regions{region, clips};
    check_fields(options, "project");
    check_projection("project", positions.size(), anchors.size(), patches, regions, field);
    if (options.method == ProjectionMethod::none) return {};
    const FlatVertices flat(PatchStars(patches.cage(), patches.levels()), patches.levels(), clips);
    const Surface surface{patches, regions, flat};
    ProjectReport report = project_once({positions, anchors, field, options}, surface, ctx);
    if (options.relax_passes == 0) return report;
    const Buffer<Quad> quads = patches.quads(ctx);
    const TangentialRelaxation relaxation(quads, patches.vertex_count());
    for (int pass = 0; pass < options.relax_passes; ++pass) {
        ctx.throw_if_cancelled();
        positions = relaxation.step(positions, options.relax_weight, ctx);
        const ProjectReport again = project_once({positions, anchors, field, options}, surface, ctx);
        const std::uint64_t evaluations = report.evaluations + again.evaluations;
        const std::uint32_t most = std::max(report.max_evaluations, again.max_evaluations);
        report = again;
        report.evaluations = evaluations;
        report.max_evaluations = most;
    }
    return report;
}

ProjectReport project(std::span<Vec3> positions, std::span<const Vec3> anchors,
                      const CompressedRows<std::uint32_t>& vertices, FieldRef field,
                      const ProjectOptions& options, const Context& ctx) {
    constexpr std::size_t kRowsPerRange = 64;
    check_fields(options, "project");
    if (positions.size() != anchors.size()) throw InvalidInput("project: give one anchor per vertex");
    if (!(field.level() > 0)) throw InvalidInput("project: the level of the field must be greater than 0");
    const Task task{positions, anchors, field, options};
    return parallel_reduce(
        ctx, vertices.size(), kRowsPerRange, ProjectReport{},
        [&](IndexRange rows) {
            ProjectReport report;
            std::vector<std::uint32_t> unprojected;
            const auto batch = std::make_unique<RayBatch>(task, report, unprojected);
            for (std::size_t row = rows.begin; row < rows.end; ++row) {
                const auto region = static_cast<std::uint32_t>(row);
                for (const std::uint32_t v : vertices[row]) {
                    batch->add(v, anchors[v]);
                    if (batch->full()) batch->move(region);
                }
                batch->move(region);
                follow_gradient(task, region, unprojected, report);
            }
            return report;
        },
        sum);
}

void list_fields(ProjectOptions& o, FieldList& list) {
    list.add(
        Field{"method",
              "Method that moves refined vertices to the surface: along rays from the skeleton, along the "
              "gradient, or by the plain Newton step of Zhu et al. 2015."},
        o.method);
    list.add(Field{"tolerance", "Accepted error of the projection as a fraction of the local radius.",
                   Unit::radius, 1e-6, 0.1},
             o.tolerance);
    list.add(Field{"max_stretch", "Maximum length of a ray, in multiples of its initial length.", Unit::none,
                   1.01, 100},
             o.max_stretch);
    list.add(Field{"max_evaluations", "Maximum number of field evaluations per vertex.", Unit::none, 1, 100},
             o.max_evaluations);
    list.add(Field{"damping", "Factor on each step along the gradient.", Unit::none, 0.1, 1}, o.damping);
    list.add(Field{"relax_passes", "Number of tangential relaxations, each followed by a projection.",
                   Unit::none, 0, 100},
             o.relax_passes);
    list.add(Field{"relax_weight",
                   "Share of the distance to the neighbours' mean by which a relaxation moves a vertex.",
                   Unit::none, 0, 1},
             o.relax_weight);
}

}  // namespace coppice
