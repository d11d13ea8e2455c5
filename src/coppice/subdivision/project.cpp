#include "coppice/subdivision/project.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <type_traits>
#include <vector>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/subdivision/project_internal.h"
#include "coppice/subdivision/relax.h"

namespace coppice {
namespace {

constexpr std::size_t kPointsPerRange = 16384;
constexpr float kGrowth = 1.6f;         // longest step outward: a gap between branches is not jumped over
constexpr float kShortest = 1.0f / 32;  // nothing inside down to here: the anchor does not help
constexpr float kShrink = 0.35f;        // way to the anchor where a gradient step has no gradient
constexpr float kLongestStep = 0.5f;    // of a gradient step, in distances from the start to the anchor
constexpr float kNearest = 0.25f;       // part of the distance to the anchor that a gradient step leaves
constexpr float kSameSpot = 1e-6f;      // anchor and vertex coincide within rounding

// no_surface: nothing inside down to the anchor; no_crossing: nothing outside up to the end of the ray.
enum class Outcome : std::uint8_t { running, converged, clipped, failed, no_surface, no_crossing };

bool is_miss(Outcome outcome) {
    return outcome == Outcome::failed || outcome == Outcome::no_surface || outcome == Outcome::no_crossing;
}

// Limit of t on anchor + t direction set by a plane; infinite when the ray does not cross it outward.
float plane_limit(const ClipPlane& plane, Vec3 anchor, Vec3 direction) {
    const float approach = dot(plane.normal, direction);
    const float room = plane.offset - dot(plane.normal, anchor);
    if (!(approach > 0) || !(room > 0)) return std::numeric_limits<float>::infinity();
    return room / approach;
}

struct Start {
    Vec3 anchor;
    Vec3 direction;  // from the anchor to the vertex; not zero
    const ClipPlane* plane;
};

// A vertex on its ray: anchor + t direction, the surface between `inside` and `outside`.
class RayWalk {
  public:
    RayWalk() = default;
    RayWalk(const Start& start, const ProjectOptions& o)
        : anchor_(start.anchor),
          direction_(start.direction),
          plane_limit_(plane_limit(*start.plane, start.anchor, start.direction)),
          outside_(std::min(o.max_stretch, plane_limit_)),
          t_(std::min(1.0f, outside_)) {}

    Vec3 point() const { return anchor_ + t_ * direction_; }

    Outcome advance(const Reading& here, const ProjectOptions& o, int evaluations) {
        const float error = std::abs(here.ratio - 1);
        if (error < best_error_) {
            best_error_ = error;
            best_t_ = t_;
        }
        const bool is_inside = here.ratio >= 1;
        if (is_inside && t_ >= outside_ && !outside_known_) {
            return t_ >= plane_limit_ ? Outcome::clipped : Outcome::no_crossing;
        }
        if (is_inside) {
            inside_ = t_;
        } else {
            outside_ = t_;
            outside_known_ = true;
            if (inside_ == 0 && t_ < kShortest) return Outcome::no_surface;
        }
        const float next = next_t(here, is_inside, evaluations);
        const float step = (next - t_) / t_;
        t_ = next;
        // Newton's error is squared by each step, so the one after a short step need not be seen.
        if (newton_ && step * step <= o.tolerance) return Outcome::converged;
        if (outside_known_ && outside_ - inside_ <= o.tolerance * outside_) return Outcome::converged;
        return Outcome::running;
    }

    // Where the vertex stays, by outcome.
    Vec3 result(Outcome& outcome) {
        if (outcome == Outcome::running) outcome = inside_ > 0 ? Outcome::failed : Outcome::no_surface;
        if (outcome == Outcome::no_surface || outcome == Outcome::no_crossing) t_ = std::min(1.0f, plane_limit_);
        if (outcome == Outcome::failed) t_ = best_t_;
        return point();
    }

  private:
    float next_t(const Reading& here, bool is_inside, int evaluations) {
        const float slope = dot(here.gradient, direction_);
        newton_ = slope < 0;
        float next = is_inside ? kGrowth * t_ : 0.5f * (inside_ + t_);
        if (newton_) {
            const float squared = t_ * t_ - 2 * t_ * (here.rise / slope);
            if (squared > 0) next = std::sqrt(squared);
        }
        const bool slow = evaluations > 4 && evaluations % 2 == 0;
        if (is_inside) {
            if (next > kGrowth * t_) return give_up_newton(std::min(kGrowth * t_, middle_or_limit()));
            if (next >= outside_ || (slow && outside_known_)) return give_up_newton(middle_or_limit());
            return next;
        }
        return next <= inside_ || slow ? give_up_newton(0.5f * (inside_ + t_)) : next;
    }
    float middle_or_limit() const { return outside_known_ ? 0.5f * (inside_ + outside_) : outside_; }
    float give_up_newton(float t) {
        newton_ = false;
        return t;
    }

    Vec3 anchor_, direction_;
    float plane_limit_ = 0;
    float inside_ = 0;   // the anchor's own value is taken on trust until a vertex gets near it
    float outside_ = 0;  // the ray's limit until a point outside is known
    float t_ = 0;
    float best_t_ = 1;
    float best_error_ = std::numeric_limits<float>::infinity();
    bool outside_known_ = false;
    bool newton_ = false;
};

// A vertex that follows the gradient.
class GradientWalk {
  public:
    GradientWalk() = default;
    GradientWalk(const Start& start, const ProjectOptions&)
        : anchor_(start.anchor),
          start_(start.anchor + start.direction),
          point_(start_),
          best_(start_),
          reach_(length(start.direction)),
          plane_(start.plane) {}

    Vec3 point() const { return point_; }

    Outcome advance(const Reading& here, const ProjectOptions& o, int /*evaluations*/) {
        const float error = std::abs(here.ratio - 1);
        if (error < best_error_) {
            best_error_ = error;
            best_ = point_;
        }
        const float slope_squared = length_squared(here.gradient);
        const Vec3 from_anchor = point_ - anchor_;
        if (!(slope_squared > 0)) {
            if (length(from_anchor) < kShortest * reach_) return Outcome::no_surface;
            point_ += from_anchor * (here.ratio >= 1 ? kShrink : -kShrink);
            return Outcome::running;
        }
        Vec3 step = newton_step(here, slope_squared, o.damping);
        const float size = length(step);
        if (!std::isfinite(size)) return Outcome::failed;
        float longest = kLongestStep * reach_;
        if (dot(step, from_anchor) < 0) longest = std::min(longest, (1 - kNearest) * length(from_anchor));
        if (size > longest) step *= longest / size;
        point_ += step;
        if (length(point_ - anchor_) > o.max_stretch * reach_) return Outcome::failed;
        const float left = (1 - o.damping) * size + size * size / reach_;
        return left <= o.tolerance * reach_ ? Outcome::converged : Outcome::running;
    }

    Vec3 result(Outcome& outcome) {
        if (outcome == Outcome::running) outcome = Outcome::failed;
        if (outcome == Outcome::failed) point_ = best_;
        if (outcome == Outcome::no_surface) point_ = start_;
        const float limit = plane_limit(*plane_, anchor_, point_ - anchor_);
        if (limit < 1) {
            point_ = lerp(anchor_, point_, limit);
            if (outcome == Outcome::converged) outcome = Outcome::clipped;
        }
        return point_;
    }

  private:
    Vec3 anchor_, start_, point_, best_;
    float best_error_ = std::numeric_limits<float>::infinity();
    float reach_ = 0;
    const ClipPlane* plane_ = nullptr;
};

// What all ranges of one pass share.
struct Task {
    std::span<Vec3> positions;
    std::span<const Vec3> anchors;
    FieldRef field;
    const ProjectOptions& options;
};

// Collects vertices of one region and moves them together, so that the field sees many points at a time.
template <class Walk>
class Batch {
  public:
    // Vertices that no surface was found for are appended to `strays`, when there is such a list.
    Batch(const Task& task, ProjectReport& report, std::vector<std::uint32_t>* strays)
        : task_(task), report_(report), strays_(strays) {}

    void add(std::uint32_t vertex, const ClipPlane& plane) {
        ++report_.vertices;
        const Vec3 anchor = task_.anchors[vertex];
        const Vec3 direction = task_.positions[vertex] - anchor;
        const float size = length_squared(direction);
        if (!(size > kSameSpot * kSameSpot * length_squared(anchor)) || !std::isfinite(size)) return;
        vertex_[size_] = vertex;
        std::construct_at(&walk_[size_], Start{anchor, direction, &plane}, task_.options);
        ++size_;
    }
    bool full() const { return size_ == kFieldBatch; }

    void move(std::uint32_t region) {
        std::size_t active = size_;
        for (std::size_t k = 0; k < size_; ++k) active_[k] = static_cast<std::uint16_t>(k);
        const float per_level = 1 / task_.field.level();
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
                const Outcome outcome =
                    walk_[i].advance(readings_.at(k, sample_[k], per_level), task_.options, evaluation);
                if (outcome == Outcome::running) {
                    active_[left++] = i;
                } else {
                    finish(i, outcome);
                }
            }
            active = left;
        }
        for (std::size_t k = 0; k < active; ++k) finish(active_[k], Outcome::running);
        size_ = 0;
    }

  private:
    void finish(std::size_t i, Outcome outcome) {
        task_.positions[vertex_[i]] = walk_[i].result(outcome);
        const bool is_stray = outcome == Outcome::no_surface || outcome == Outcome::no_crossing;
        if (is_stray && strays_ != nullptr) strays_->push_back(vertex_[i]);
        report_.not_converged += is_miss(outcome);
        report_.anchors_outside += outcome == Outcome::no_surface;
        report_.clipped += outcome == Outcome::clipped;
    }

    const Task& task_;
    ProjectReport& report_;
    std::vector<std::uint32_t>* strays_;
    std::size_t size_ = 0;
    std::array<std::uint32_t, kFieldBatch> vertex_;
    std::array<std::uint16_t, kFieldBatch> active_;
    std::array<Walk, kFieldBatch> walk_;
    std::array<Vec3, kFieldBatch> point_;
    std::array<FieldSample, kFieldBatch> sample_;
    Readings readings_;
};

// Vertices of one region whose rays found no surface: along the gradient, from where they were.
void follow_gradient(const Task& task, std::uint32_t region, const ClipPlane& plane,
                     std::vector<std::uint32_t>& strays, ProjectReport& report) {
    if (strays.empty()) return;
    ProjectReport again;
    const auto batch = std::make_unique<Batch<GradientWalk>>(task, again, nullptr);
    for (const std::uint32_t v : strays) {
        batch->add(v, plane);
        if (batch->full()) batch->move(region);
    }
    batch->move(region);
    report.evaluations += again.evaluations;
    report.max_evaluations = std::max(report.max_evaluations, again.max_evaluations);
    report.not_converged -= strays.size() - again.not_converged;
    report.clipped += again.clipped;
    strays.clear();
}

template <class Walk>
ProjectReport project_faces(const Task& task, const PatchRefinement& patches, const Regions& regions,
                            IndexRange faces) {
    ProjectReport report;
    std::vector<std::uint32_t> strays;
    Batch<Walk> batch(task, report, std::is_same_v<Walk, RayWalk> ? &strays : nullptr);
    Buffer<std::uint32_t> owned(patches.max_owned());
    std::uint32_t region = regions.of_face[faces.begin];
    const auto finish_region = [&] {
        batch.move(region);
        follow_gradient(task, region, regions.plane(region), strays, report);
    };
    for (std::size_t f = faces.begin; f < faces.end; ++f) {
        if (regions.of_face[f] != region) {
            finish_region();
            region = regions.of_face[f];
        }
        const std::uint32_t count = patches.owned_vertices(static_cast<std::uint32_t>(f), owned);
        for (std::uint32_t k = 0; k < count; ++k) {
            batch.add(owned[k], regions.plane(region));
            if (batch.full()) batch.move(region);
        }
    }
    finish_region();
    return report;
}

ProjectReport sum(ProjectReport a, const ProjectReport& b) {
    a.vertices += b.vertices;
    a.evaluations += b.evaluations;
    a.max_evaluations = std::max(a.max_evaluations, b.max_evaluations);
    a.not_converged += b.not_converged;
    a.anchors_outside += b.anchors_outside;
    a.clipped += b.clipped;
    return a;
}

ProjectReport project_once(const Task& task, const PatchRefinement& patches, const Regions& regions,
                           const Context& ctx) {
    const std::size_t grain = std::max<std::size_t>(1, kPointsPerRange >> (2 * patches.levels()));
    const bool rays = task.options.method == ProjectionMethod::rays;
    return parallel_reduce(
        ctx, patches.cage().face_count(), grain, ProjectReport{},
        [&](IndexRange faces) {
            return rays ? project_faces<RayWalk>(task, patches, regions, faces)
                        : project_faces<GradientWalk>(task, patches, regions, faces);
        },
        sum);
}

}  // namespace

void check_projection(std::string_view stage, std::size_t positions, std::size_t anchors,
                      const PatchRefinement& patches, const Regions& regions, FieldRef field) {
    const auto refuse = [&](const char* what) { throw InvalidInput(fmt::format("{}: {}", stage, what)); };
    if (positions != patches.vertex_count() || anchors != patches.vertex_count()) {
        refuse("give one position and one anchor per refined vertex");
    }
    if (regions.of_face.size() != patches.cage().face_count()) refuse("give one region per cage quad");
    const bool known = std::all_of(regions.of_face.begin(), regions.of_face.end(),
                                   [&](std::uint32_t r) { return r < regions.clip.size(); });
    if (!regions.clip.empty() && !known) refuse("give one clip plane per region, or none at all");
    if (!(field.level() > 0)) refuse("the level of the field must be greater than 0");
}

ProjectReport project(Buffer<Vec3>& positions, std::span<const Vec3> anchors, const PatchRefinement& patches,
                      std::span<const std::uint32_t> region_of_cage_face,
                      std::span<const ClipPlane> clip_of_region, FieldRef field,
                      const ProjectOptions& options, const Context& ctx) {
    const Regions regions{region_of_cage_face, clip_of_region};
    check_fields(options, "project");
    check_projection("project", positions.size(), anchors.size(), patches, regions, field);
    if (options.method == ProjectionMethod::none) return {};
    ProjectReport report = project_once({positions, anchors, field, options}, patches, regions, ctx);
    if (options.relax_passes == 0) return report;
    const Buffer<Quad> quads = patches.quads(ctx);
    const TangentialRelaxation relaxation(quads, patches.vertex_count());
    for (int pass = 0; pass < options.relax_passes; ++pass) {
        ctx.throw_if_cancelled();
        positions = relaxation.step(positions, options.relax_weight, ctx);
        const ProjectReport again = project_once({positions, anchors, field, options}, patches, regions, ctx);
        const std::uint64_t evaluations = report.evaluations + again.evaluations;
        const std::uint32_t most = std::max(report.max_evaluations, again.max_evaluations);
        report = again;
        report.evaluations = evaluations;
        report.max_evaluations = most;
    }
    return report;
}

}  // namespace coppice
