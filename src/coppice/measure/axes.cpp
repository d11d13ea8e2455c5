#include "coppice/measure/axes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/measure/face_runs_internal.h"

namespace coppice {
namespace {

using measure_internal::FaceRuns;
using measure_internal::NearestTriangle;

constexpr std::size_t kAxesGrain = 64;
constexpr double kDeep = 0.5;      // [radii] see AxesFound::is_deep
constexpr double kSpacing = 0.5;   // [radii] distance of the sample points on an axis
constexpr double kEndZone = 1.2;   // [radii] length next to roots and tips that is excluded
constexpr double kMinPlace = 0.2;  // [radii] minimum length of a severed place
// [radii] a tip that is reached farther than this may be inside another branch.
constexpr double kFreeTip = 1.05;
constexpr double kMaxPoints = 256;

enum class Depth : std::uint8_t { inside, thin, outside };

// Consecutive bad sample points of an axis.
struct BadRun {
    int first, end;
    bool is_outside;  // at least one of them
};

// The state of a segment.
struct Axis {
    bool is_near = false;  // the surface is near the axis, so the depth varies along it
    bool is_deep = false;
    int points = 1;
    double outside = 0, thin = 0;  // [m] of the examined length
    std::vector<BadRun> runs;
};

class AxesJudge {
  public:
    // `wanted`: per node whether its segment is examined; empty: all segments are.
    AxesJudge(const FaceRuns& faces, const Skeleton& skeleton, const CapsuleTree& capsules,
              std::span<const std::uint8_t> wanted = {})
        : faces_(faces), skeleton_(skeleton), capsules_(capsules), wanted_(wanted), axis_(capsules_.size()) {}

    AxesFound judge(const Context& ctx) {
        parallel_for(ctx, axis_.size(), kAxesGrain, [&](std::size_t i) {
            if (is_segment(static_cast<std::uint32_t>(i))) look_along(static_cast<std::uint32_t>(i));
        });
        AxesFound out;
        out.is_deep.assign(axis_.size(), 0);
        place_of_.assign(skeleton_.size(), kNoIndex);
        capsule_of_.assign(skeleton_.size(), kNoIndex);
        for (std::uint32_t i = 0; i < axis_.size(); ++i) {
            if (!is_segment(i)) continue;
            capsule_of_[capsules_.node(i).index()] = i;
            finish(i, out);
        }
        name_places(out);
        return out;
    }

    // [radii] Returns how far the surface extends beyond the tip of a segment, at most kFarthest.
    double reach(std::uint32_t i) const {
        constexpr double kNearest = 1e-3, kUsual = 1.1, kFarthest = 4;
        const RoundCone& c = capsules_.cone(i);
        const double r = c.radius_b(), l = length(c.axis);
        const Vec3d d = c.axis / l, from = c.b() - d * (kNearest * r);
        Hit ahead = first_hit(from, d, kUsual * r);
        if (!std::isfinite(ahead.distance)) ahead = first_hit(from, d, kFarthest * r);
        if (ahead.from_inside) return ahead.distance / r - kNearest;
        if (!std::isfinite(ahead.distance) && depth(c, 1) != Depth::outside) return kFarthest;
        return -std::min(first_hit(c.b(), -d, l).distance, l) / r;
    }

    // Returns the portions of the severed places, after judge().
    std::vector<SeveredRange> find_severed_ranges() const {
        std::vector<SeveredRange> out;
        for (const Place& p : places_) {
            if (is_severed(p)) out.insert(out.end(), p.parts.begin(), p.parts.end());
        }
        return out;
    }

    bool is_segment(std::uint32_t i) const {
        const NodeId n = capsules_.node(i);
        return !skeleton_.is_root(n) && (wanted_.empty() || wanted_[n.index()] != 0);
    }
    bool is_tip(std::uint32_t i) const {
        return is_segment(i) && skeleton_.is_tip(capsules_.node(i)) && length(capsules_.cone(i).axis) > 0;
    }
    const CapsuleTree& capsules() const { return capsules_; }

  private:
    // The first intersection of a ray with the surface.
    struct Hit {
        double distance = std::numeric_limits<double>::infinity();  // [m]
        bool from_inside = false;
    };

    // Returns the parameter of the intersection of a line and a triangle, in lengths of its direction; NaN if
    // they do not intersect.
    static double crossing(Vec3d from, Vec3d direction, Vec3d a, Vec3d b, Vec3d c) {
        // Volumes spanned by the line and the edges; on an edge one is 0, and either adjacent face is
        // correct.
        const Vec3d u = a - from, v = b - from, w = c - from;
        const double p = dot(direction, cross(u, v)), q = dot(direction, cross(v, w)),
                     s = dot(direction, cross(w, u));
        const bool forward = p >= 0 && q >= 0 && s >= 0, backward = p <= 0 && q <= 0 && s <= 0;
        if (forward == backward) return std::numeric_limits<double>::quiet_NaN();
        const Vec3d normal = cross(b - a, c - a);
        return dot(u, normal) / dot(direction, normal);
    }

    // Returns whether the distance between the axis and a triangle is below `limit`.
    static bool comes_near(const RoundCone& c, double limit, Vec3d p, Vec3d q, Vec3d r) {
        const double t = crossing(c.a, c.axis, p, q, r), squared = limit * limit;
        if (t >= 0 && t <= 1) return true;
        const auto is_near_edge = [&](Vec3d from, Vec3d to) {
            return gap(c, round_cone(from, to, 0.0, 0.0)).distance < limit;
        };
        return distance_squared(c.a, p, q, r) < squared || distance_squared(c.b(), p, q, r) < squared ||
               is_near_edge(p, q) || is_near_edge(q, r) || is_near_edge(r, p);
    }

    bool comes_near(const RoundCone& c, double limit, const FaceRuns::Run& run) const {
        const double far = limit + run.longest;
        bool near = false;
        for (std::size_t f = run.faces.begin; f < run.faces.end && !near; ++f) {
            const Vec3d corner = faces_.at(faces_.corners(f)[0]);
            if (length_squared(c.closest_point(corner).offset) > far * far || keeps_clear(c, limit, f))
                continue;
            faces_.visit_triangles(
                f, [&](Vec3d p, Vec3d q, Vec3d r) { near = near || comes_near(c, limit, p, q, r); });
        }
        return near;
    }

    // Returns whether the planes that bound a run prove that it is farther from the axis than `limit`.
    static bool is_adjacent(const RoundCone& c, double limit, const FaceRuns::Run& run) {
        const double a = dot(c.a, run.normal), b = dot(c.b(), run.normal);
        return std::max(a, b) + limit < run.low || std::min(a, b) - limit > run.high;
    }

    // Returns whether a plane between a face and the axis proves that they are farther apart than `limit`.
    bool keeps_clear(const RoundCone& c, double limit, std::size_t face) const {
        const auto corners = faces_.corners(face);
        const Vec3d middle = (faces_.at(corners[0]) + faces_.at(corners[2])) * 0.5;
        const RoundCone::ClosestPoint closest = c.closest_point(middle);
        const Vec3d outward = normalized(closest.offset);
        const double beyond = dot(middle - closest.offset, outward) + limit;
        return std::ranges::all_of(corners,
                                   [&](std::uint32_t v) { return dot(faces_.at(v), outward) > beyond; });
    }

    // Returns whether the axis is nearer to the surface than kDeep.
    bool is_near(const RoundCone& c) const {
        constexpr double kLongest = 6,
                         kMaxPieces = 64;  // [radii] maximum length of a section with its own box
        const double r = std::max(c.radius_a, c.radius_b()), limit = kDeep * r;
        const double pieces = std::clamp(std::ceil(length(c.axis) / (kLongest * r)), 1.0, kMaxPieces);
        for (int k = 0; k < static_cast<int>(pieces); ++k) {
            Box3 box;
            extend_outward(box, c.point(k / pieces));
            extend_outward(box, c.point((k + 1) / pieces));
            const bool is_clear =
                faces_.visit_runs(box.inflated(static_cast<float>(limit)), [&](const FaceRuns::Run& run) {
                    return is_adjacent(c, limit, run) || !comes_near(c, limit, run);
                });
            if (!is_clear) return true;
        }
        return false;
    }

    Hit first_hit(Vec3d from, Vec3d direction, double farthest) const {
        Box3 box;
        extend_outward(box, from);
        extend_outward(box, from + direction * farthest);
        Hit hit;
        faces_.visit_runs(box, [&](const FaceRuns::Run& run) {
            for (std::size_t f = run.faces.begin; f < run.faces.end; ++f) {
                if (!faces_.box(f).overlaps(box)) continue;
                faces_.visit_triangles(f, [&](Vec3d a, Vec3d b, Vec3d c) {
                    const Vec3d normal = cross(b - a, c - a);
                    const double t = crossing(from, direction, a, b, c);
                    if (t >= 0 && t < hit.distance) hit = {t, dot(direction, normal) > 0};
                });
            }
            return true;
        });
        return hit;
    }

    double at(const Axis& a, int k) const { return (k + 0.5) / a.points; }

    void look_along(std::uint32_t i) {
        const RoundCone& c = capsules_.cone(i);
        Axis& a = axis_[i];
        const double wanted = length(c.axis) / (kSpacing * std::min(c.radius_a, c.radius_b()));
        a.points = static_cast<int>(std::clamp(std::ceil(wanted), 1.0, kMaxPoints));
        a.is_near = is_near(c);
        for (int k = 0; a.is_near && k < a.points; ++k) add(i, k, depth(c, at(a, k)));
    }

    Depth depth(const RoundCone& c, double t) const {
        const Vec3d p = c.point(t);
        NearestTriangle nearest(p);
        faces_.find_nearest(p, nearest);
        const double d = nearest.signed_distance();  // infinite if there are no faces
        if (d > 0) return Depth::outside;
        return -d < AxesReport::kThin * c.radius(t) ? Depth::thin : Depth::inside;
    }

    // Returns whether a point of an axis is outside the excluded end zones.
    bool is_judged(std::uint32_t i, double t) const {
        const RoundCone& c = capsules_.cone(i);
        const NodeId n = capsules_.node(i);
        const double l = length(c.axis);
        return !(skeleton_.is_root(skeleton_.parent(n)) && t * l < kEndZone * c.radius_a) &&
               !(skeleton_.is_tip(n) && (1 - t) * l < kEndZone * c.radius_b());
    }

    void add(std::uint32_t i, int k, Depth d) {
        Axis& a = axis_[i];
        if (d == Depth::inside || !is_judged(i, at(a, k))) return;
        (d == Depth::outside ? a.outside : a.thin) += length(capsules_.cone(i).axis) / a.points;
        if (!a.runs.empty() && a.runs.back().end == k) {
            a.runs.back().end = k + 1;
            a.runs.back().is_outside = a.runs.back().is_outside || d == Depth::outside;
        } else {
            a.runs.push_back({k, k + 1, d == Depth::outside});
        }
    }

    // Determines the side of axes that are not near the surface, and adds the segment to the totals.
    void finish(std::uint32_t i, AxesFound& out) {
        Axis& a = axis_[i];
        const RoundCone& c = capsules_.cone(i);
        const NodeId n = capsules_.node(i), parent = skeleton_.parent(n);
        if (!a.is_near) {
            // A segment that continues a deep one without meeting the surface is deep too.
            const std::uint32_t before = capsule_of_[parent.index()];
            a.is_deep = (before != kNoIndex && axis_[before].is_deep) || depth(c, 0.5) != Depth::outside;
            for (int k = 0; !a.is_deep && k < a.points; ++k) add(i, k, Depth::outside);
        }
        out.is_deep[i] = a.is_deep ? 1 : 0;
        int judged = 0;
        for (int k = 0; k < a.points; ++k) judged += is_judged(i, at(a, k)) ? 1 : 0;
        const double step = length(c.axis) / a.points;
        AxesReport& r = out.report;
        r.length += judged * step;
        r.segments += judged > 0 ? 1 : 0;
        r.missing += judged > 0 && a.outside > 0.5 * judged * step ? 1 : 0;
        r.outside += a.outside;
        r.thin += a.thin;
        for (const BadRun& run : a.runs) add_run(run, i);
    }

    // A run at the beginning of a segment continues the run at the end of the previous segment.
    void add_run(const BadRun& run, std::uint32_t i) {
        const Axis& a = axis_[i];
        const RoundCone& c = capsules_.cone(i);
        const NodeId n = capsules_.node(i);
        const std::uint32_t before = run.first == 0 ? place_of_[skeleton_.parent(n).index()] : kNoIndex;
        const auto number = before != kNoIndex ? before : static_cast<std::uint32_t>(places_.size());
        if (before == kNoIndex) {
            const double t = static_cast<double>(run.first) / a.points;
            const Vec3d of_node = Vec3d(skeleton_.position(n)) + skeleton_.origin();
            places_.push_back({{n, of_node - c.axis * (1 - t), 0}});
        }
        Place& place = places_[number];
        place.severed.length += length(c.axis) * (run.end - run.first) / a.points;
        place.radius = std::max({place.radius, c.radius_a, c.radius_b()});
        place.is_outside = place.is_outside || run.is_outside;
        const double points = a.points;
        place.parts.push_back({n, run.first / points, run.end / points});
        if (run.end == a.points) place_of_[n.index()] = number;
    }

    void name_places(AxesFound& found) {
        AxesReport& out = found.report;
        std::vector<std::uint8_t> is_cut(skeleton_.size(), 0);
        for (const Place& p : places_) {
            if (!is_severed(p)) continue;
            out.longest.push_back(p.severed);
            if (p.is_outside) is_cut[p.severed.node.index()] = 1;
        }
        for (const NodeId n : nodes(skeleton_)) {
            if (skeleton_.is_root(n)) continue;
            std::uint8_t& cut = is_cut[n.index()];
            cut = cut | is_cut[skeleton_.parent(n).index()];
            const std::uint32_t i = capsule_of_[n.index()];
            if (cut != 0 && i != kNoIndex) out.beyond += length(capsules_.cone(i).axis);
        }
        out.severed = out.longest.size();
        for (const SeveredPlace& p : out.longest) found.faulty.push_back(p.node);
        std::ranges::stable_sort(out.longest, std::ranges::greater(), &SeveredPlace::length);
        out.longest.resize(std::min(out.longest.size(), AxesReport::kNamed));
    }

    struct Place {
        SeveredPlace severed;
        std::vector<SeveredRange> parts;
        double radius = 0;
        bool is_outside = false;  // at least one point of it
    };
    static bool is_severed(const Place& p) { return p.severed.length > kMinPlace * p.radius; }

    const FaceRuns& faces_;
    const Skeleton& skeleton_;
    const CapsuleTree& capsules_;
    std::span<const std::uint8_t> wanted_;
    std::vector<Axis> axis_;                 // by capsule
    std::vector<std::uint32_t> place_of_;    // by node: the place that continues there
    std::vector<std::uint32_t> capsule_of_;  // by node: its segment, if that is finished
    std::vector<Place> places_;
};

// [radii] Returns the distance from a tip at which a surface should end.
double required_reach(EndShape tips) { return tips == EndShape::round ? 1 : 0; }

std::vector<std::uint32_t> find_tips(const AxesJudge& judge) {
    std::vector<std::uint32_t> out;
    for (std::uint32_t i = 0; i < judge.capsules().size(); ++i) {
        if (judge.is_tip(i)) out.push_back(i);
    }
    return out;
}

void judge_tips(const AxesJudge& judge, const Skeleton& skeleton, EndShape tips, const Context& ctx,
                AxesFound& found) {
    AxesReport& out = found.report;
    const double required = required_reach(tips);
    const std::vector<std::uint32_t> tip = find_tips(judge);
    std::vector<double> reach(tip.size());
    std::vector<std::uint8_t> is_free(tip.size(), 1);
    parallel_for(ctx, tip.size(), kAxesGrain, [&](std::size_t k) {
        reach[k] = judge.reach(tip[k]);
        if (reach[k] <= kFreeTip) return;
        const RoundCone& c = judge.capsules().cone(tip[k]);
        const Vec3d end = c.b() + normalized(c.axis) * (required * c.radius_b());
        is_free[k] = judge.capsules().any_within(end, 1, tip[k]) ? 0 : 1;
    });
    out.tips = tip.size();
    std::vector<double> free_reach;
    for (std::size_t k = 0; k < tip.size(); ++k) {
        if (is_free[k] != 0) free_reach.push_back(reach[k]);
        const double missing = required - reach[k];
        if (missing <= AxesReport::kShort) continue;
        const NodeId n = judge.capsules().node(tip[k]);
        out.shortest.push_back({n, Vec3d(skeleton.position(n)) + skeleton.origin(), missing});
    }
    out.tip_reach = statistics(std::move(free_reach));
    out.short_tips = out.shortest.size();
    for (const ShortTip& t : out.shortest) found.faulty.push_back(t.node);
    std::ranges::stable_sort(out.shortest, std::ranges::greater(), &ShortTip::missing);
    out.shortest.resize(std::min(out.shortest.size(), AxesReport::kNamed));
}

}  // namespace

AxesFound judge_axes(const FaceView& mesh, const Skeleton& skeleton, const ConeUnion& solid, EndShape tips,
                     const Context& ctx) {
    const FaceRuns faces(mesh, ctx);
    AxesJudge judge(faces, skeleton, solid.capsules());
    AxesFound out = judge.judge(ctx);
    judge_tips(judge, skeleton, tips, ctx, out);
    return out;
}

std::vector<SeveredRange> find_severed_ranges(const FaceView& mesh, const Skeleton& skeleton,
                                              const CapsuleTree& segments, EndShape tips,
                                              std::span<const std::uint8_t> wanted, const Context& ctx) {
    const FaceRuns faces(mesh, ctx);
    AxesJudge judge(faces, skeleton, segments, wanted);
    judge.judge(ctx);
    std::vector<SeveredRange> out = judge.find_severed_ranges();
    for (const std::uint32_t i : find_tips(judge)) {
        if (required_reach(tips) - judge.reach(i) <= AxesReport::kShort) continue;
        const RoundCone& c = segments.cone(i);
        out.push_back({segments.node(i), std::max(0.0, 1 - c.radius_b() / length(c.axis)), 1});
    }
    return out;
}

}  // namespace coppice
