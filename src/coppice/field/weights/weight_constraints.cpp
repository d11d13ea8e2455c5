#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/field/weights/weight_constraints_internal.h"
#include "coppice/skeleton/segment_cone.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {
namespace {

constexpr std::size_t kWeightConstraintsGrain = 256;
constexpr std::uint32_t kAround = 4;  // number of points per circle
constexpr std::uint64_t kMaxConstraints = std::uint64_t{1} << 28;
// A tapering branch is slightly inside the balls at its own nodes, so points of the surface may be, too.
constexpr double kInside = 0.98;

/// Returns all segments, and single nodes as segments without length.
std::vector<NodeId> segment_names(const Skeleton& skeleton) {
    std::vector<NodeId> names;
    for (const NodeId n : nodes(skeleton))
        if (!skeleton.is_root(n) || skeleton.is_tip(n)) names.push_back(n);
    return names;
}

/// Returns the segment of a node; a step of the radius at one place counts with its greater radius, as in the
/// field.
Segment make_segment(const Skeleton& skeleton, NodeId n) {
    const Vec3 p = skeleton.position(n);
    Segment s =
        skeleton.is_root(n) ? Segment{p, p, skeleton.radius(n), skeleton.radius(n)} : skeleton.segment(n);
    if (s.a == s.b) s.radius_a = s.radius_b = std::max(s.radius_a, s.radius_b);
    return s;
}

/// A box tree of the rounded cones of segments.
class Cones {
  public:
    Cones(const Skeleton& skeleton, std::span<const NodeId> names, const Context& ctx)
        : skeleton_(skeleton), names_(names), boxes_(boxes(skeleton, names), ctx) {}

    /// Returns whether another segment's cone contains p within the share `kInside` of its radius.
    bool hold(Vec3 p, NodeId except) const {
        bool held = false;
        boxes_.visit_overlapping(capsule_box(p, p, 0), [&](std::uint32_t i) {
            const RoundCone::ClosestPoint f = closest_point(i, p);
            held = names_[i] != except && f.distance() < kInside * f.radius;
            return !held;
        });
        return held;
    }

    /// Returns the segment with the nearest surface; inside, the one in which p is deepest.
    NodeId nearest(Vec3 p) const {
        double best = std::numeric_limits<double>::infinity();
        std::uint32_t name = 0;
        const auto bound = [&](std::uint32_t level, std::uint32_t i) {
            const double d = distance_squared(boxes_.level(level)[i], Vec3d(p));
            // A box that contains p may contain a segment in which p is deep.
            return d > 0 ? std::sqrt(d) * (1 - 1e-6) : -std::numeric_limits<double>::infinity();
        };
        boxes_.search(bound, best, [&](std::uint32_t i) {
            const double d = closest_point(i, p).signed_distance();
            if (d > best || (d == best && i > name)) return;
            best = d;
            name = i;
        });
        return names_[name];
    }

  private:
    static std::vector<Box3> boxes(const Skeleton& skeleton, std::span<const NodeId> names) {
        std::vector<Box3> boxes(names.size());
        for (std::size_t i = 0; i < names.size(); ++i) {
            const Segment s = make_segment(skeleton, names[i]);
            boxes[i] = capsule_box(s.a, s.b, std::max(s.radius_a, s.radius_b));
        }
        return boxes;
    }

    RoundCone::ClosestPoint closest_point(std::uint32_t i, Vec3 p) const {
        return round_cone(make_segment(skeleton_, names_[i])).closest_point(Vec3d(p));
    }

    const Skeleton& skeleton_;
    std::span<const NodeId> names_;
    BoxTree boxes_;
};

/// Returns the number of circles of every segment: at least one, in proportion to length over radius.
std::vector<std::uint64_t> circle_counts(const Skeleton& skeleton, std::span<const NodeId> names,
                                         int density) {
    std::vector<double> slenderness(names.size());
    double sum = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const Segment s = make_segment(skeleton, names[i]);
        slenderness[i] = distance(Vec3d(s.a), Vec3d(s.b)) / (0.5 * (double{s.radius_a} + double{s.radius_b}));
        sum += slenderness[i];
    }
    const double circles = static_cast<double>(names.size()) * density / kAround;
    std::vector<std::uint64_t> counts(names.size() + 1, 0);
    for (std::size_t i = 0; i < names.size(); ++i) {
        const double share = sum > 0 ? circles * (slenderness[i] / sum) : 0;
        counts[i] = static_cast<std::uint64_t>(std::max(1.0, std::round(share)));
    }
    return counts;
}

/// Places the points of one segment, each circle rotated relative to the previous one by half the angle
/// between points.
void place_circles(const Segment& s, NodeId name, std::span<WeightConstraint> out) {
    const RoundCone cone = round_cone(s);
    const Vec3d u = normalized(cone.axis);
    const Vec3d right = perpendicular(u), up = cross(u, right);
    const std::size_t circles = out.size() / kAround;
    for (std::size_t c = 0; c < circles; ++c) {
        const double t = (static_cast<double>(c) + 0.5) / static_cast<double>(circles);
        const double radius = cone.radius(t);
        for (std::uint32_t k = 0; k < kAround; ++k) {
            const double angle = 2 * std::numbers::pi * (k + (c % 2 == 0 ? 0.0 : 0.5)) / kAround;
            const Vec3d p =
                cone.point(t) + right * (radius * std::cos(angle)) + up * (radius * std::sin(angle));
            out[c * kAround + k] = {Vec3(p), name};
        }
    }
}

}  // namespace

std::vector<WeightConstraint> surface_constraints(const Skeleton& skeleton, const FieldOptions& options,
                                                  const Context& ctx) {
    check_fields(options, "field");
    const std::vector<NodeId> names = segment_names(skeleton);
    std::vector<std::uint64_t> first = circle_counts(skeleton, names, options.constraint_density);
    const std::uint64_t total = kAround * exclusive_scan(std::span(first));
    if (total > kMaxConstraints)
        throw InvalidInput(fmt::format(
            "field: {} constraints are too many; reduce constraint_density, or use local weights", total));
    std::vector<WeightConstraint> all(total);
    std::vector<std::uint8_t> hidden(total);
    const Cones cones(skeleton, names, ctx);
    parallel_for(ctx, names.size(), kWeightConstraintsGrain, [&](std::size_t i) {
        const std::size_t begin = kAround * first[i], end = kAround * first[i + 1];
        place_circles(make_segment(skeleton, names[i]), names[i], std::span(all).subspan(begin, end - begin));
        for (std::size_t j = begin; j < end; ++j) hidden[j] = cones.hold(all[j].position, names[i]);
    });
    std::size_t kept = 0;
    for (std::size_t j = 0; j < total; ++j)
        if (!hidden[j]) all[kept++] = all[j];
    all.resize(kept);
    return all;
}

std::vector<WeightConstraint> attached_constraints(const Skeleton& skeleton, std::span<const Vec3> points,
                                                   const Context& ctx) {
    for (std::size_t j = 0; j < points.size(); ++j)
        if (!is_finite(points[j]))
            throw InvalidInput(fmt::format("weights: constraint {} is not finite; remove it", j + 1));
    const std::vector<NodeId> names = segment_names(skeleton);
    const Cones cones(skeleton, names, ctx);
    std::vector<WeightConstraint> all(points.size());
    parallel_for(ctx, points.size(), kWeightConstraintsGrain, [&](std::size_t j) {
        all[j] = {points[j], cones.nearest(points[j])};
    });
    std::stable_sort(all.begin(), all.end(), [](const WeightConstraint& x, const WeightConstraint& y) {
        return x.segment.index() < y.segment.index();
    });
    return all;
}

}  // namespace coppice
