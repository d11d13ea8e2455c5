#include "coppice/measure/capsule_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice {
namespace {

std::vector<NodeId> nodes_with_parents(const Skeleton& skeleton) {
    std::vector<NodeId> out;
    out.reserve(skeleton.size() - skeleton.tree_count());
    for (const NodeId n : nodes(skeleton)) {
        if (!skeleton.is_root(n)) out.push_back(n);
    }
    return out;
}

std::vector<RoundCone> compute_cones(const Skeleton& skeleton, std::span<const NodeId> children,
                                     Vec3d origin) {
    const Vec3d shift = skeleton.origin() - origin;
    std::vector<RoundCone> cones;
    cones.reserve(children.size());
    for (const NodeId n : children) {
        cones.push_back(round_cone(skeleton.segment(n)));
        cones.back().a += shift;
    }
    return cones;
}

/// Returns the parameters at which the sections of an axis end: sections are shorter towards both ends, where
/// axes are crowded.
std::vector<double> piece_ends(std::uint32_t halvings) {
    constexpr int kOfHalving = 4;
    std::vector<double> to_middle;  // from 0 to the middle, both excluded
    for (std::uint32_t h = halvings; h > 0; --h) {
        const double least = std::ldexp(0.5, -static_cast<int>(h));
        for (int k = 0; k < kOfHalving; ++k) to_middle.push_back(least * (1 + 1.0 * k / kOfHalving));
    }
    std::vector<double> ends = to_middle;
    ends.push_back(0.5);
    for (std::size_t k = to_middle.size(); k-- > 0;) ends.push_back(1 - to_middle[k]);
    ends.push_back(1);
    return ends;
}

std::vector<Box3> axis_boxes(std::span<const RoundCone> cones, std::span<const double> ends) {
    std::vector<Box3> boxes(cones.size() * ends.size());
    for (std::size_t i = 0; i < cones.size(); ++i) {
        const RoundCone& c = cones[i];
        Vec3d from = c.a;
        for (std::size_t k = 0; k < ends.size(); ++k) {
            const Vec3d to = k + 1 == ends.size() ? c.b() : c.point(ends[k]);
            Box3& box = boxes[i * ends.size() + k];
            extend_outward(box, from);
            extend_outward(box, to);
            from = to;
        }
    }
    return boxes;
}

/// Returns whether the boxes of many axes overlap, as in stars and dense clusters, so that a query would
/// visit a large share of all axes.
bool is_crowded(const BoxTree& boxes, std::span<const RoundCone> cones) {
    constexpr std::size_t kLookedAt = 256;
    constexpr std::size_t kMany = 32, kEnough = 4 * kMany;
    const std::size_t count = std::min(cones.size(), kLookedAt);
    std::size_t seen = 0;
    for (std::size_t k = 0; k < count; ++k) {
        Box3 middle;
        extend_outward(middle, cones[k * cones.size() / count].point(0.5));
        std::size_t here = 0;
        boxes.visit_overlapping(middle, [&](std::uint32_t) { return ++here < kEnough; });
        seen += here;
    }
    return seen > kMany * count;
}

/// Returns the ends of the sections into which crowded axes are divided: as many as are useful, limited by
/// memory.
std::vector<double> crowd_pieces(std::size_t capsules) {
    constexpr std::size_t kMax = std::size_t{1} << 23;
    constexpr std::uint32_t kHalvings = 8;
    std::vector<double> ends;
    for (std::uint32_t h = kHalvings; h > 0; --h) {
        ends = piece_ends(h);
        if (capsules * ends.size() <= kMax) return ends;
    }
    return {1};
}

/// Keeps the candidate capsule with the smallest rho, the first of equal ones.
class Closest {
  public:
    Closest(std::span<const RoundCone> cones, Vec3d p) : cones_(cones), p_(p) {}

    void offer(std::uint32_t i) {
        const double rho_squared = cones_[i].closest_point(p_).relative_squared();
        if (rho_squared > least_ || (rho_squared == least_ && i >= best_)) return;
        least_ = rho_squared;
        best_ = i;
    }
    const double& rho_squared() const { return least_; }
    CapsuleTree::Nearest found() const { return {best_, std::sqrt(least_)}; }

  private:
    std::span<const RoundCone> cones_;
    Vec3d p_;
    std::uint32_t best_ = kNoIndex;
    double least_ = CapsuleTree::kFarthest * CapsuleTree::kFarthest;
};

}  // namespace

CapsuleTree::CapsuleTree(const Skeleton& skeleton, Vec3d origin, const Context& ctx)
    : CapsuleTree(nodes_with_parents(skeleton), compute_cones(skeleton, nodes_with_parents(skeleton), origin),
                  ctx) {}

CapsuleTree::CapsuleTree(std::vector<NodeId> nodes, std::vector<RoundCone> cones, const Context& ctx)
    : nodes_(std::move(nodes)), cones_(std::move(cones)), boxes_(axis_boxes(cones_, std::array{1.0}), ctx) {
    if (is_crowded(boxes_, cones_)) {
        const std::vector<double> ends = crowd_pieces(cones_.size());
        sections_ = static_cast<std::uint32_t>(ends.size());
        boxes_ = BoxTree(axis_boxes(cones_, ends), ctx);
    }
    auto& levels = inverse_radius_squared_;
    levels.resize(boxes_.level_count());
    for (std::uint32_t l = 0; l < levels.size(); ++l) {
        levels[l].assign(boxes_.level(l).size(), std::numeric_limits<double>::infinity());
    }
    for (std::uint32_t place = 0; place < boxes_.size(); ++place) {
        const RoundCone& c = cones_[compute_capsule(boxes_.item(place))];
        const double r = std::max(c.radius_a, c.radius_b());
        levels[0][place] = 1 / (r * r);
    }
    for (std::uint32_t l = 1; l < levels.size(); ++l) {
        for (std::size_t i = 0; i < levels[l - 1].size(); ++i) {
            double& least = levels[l][i / BoxTree::kWidth];
            least = std::min(least, levels[l - 1][i]);
        }
    }
}

CapsuleTree::Nearest CapsuleTree::nearest(Vec3d p, std::uint32_t hint) const {
    Closest closest(cones_, p);
    if (hint != kNoIndex) closest.offer(hint);
    boxes_.search([&](std::uint32_t l, std::uint32_t i) { return bound(l, i, p); }, closest.rho_squared(),
                  [&](std::uint32_t section) { closest.offer(compute_capsule(section)); });
    return closest.found();
}

void CapsuleTree::nearest(std::span<const Vec3d> points, std::uint32_t hint, std::span<Nearest> out) const {
    constexpr std::size_t kMaxCandidates = 48;
    out[0] = nearest(points[0], hint);
    std::array<std::uint32_t, kMaxCandidates> candidate;
    std::size_t count = 0;
    bool fit = out[0].capsule != kNoIndex && points.size() > 1;
    if (fit) {
        // No point is farther from its nearest capsule than from the capsule nearest to the first point.
        Box3 around;
        double limit = 0;
        for (const Vec3d p : points) {
            extend_outward(around, p);
            limit = std::max(limit, cones_[out[0].capsule].closest_point(p).relative_squared());
        }
        limit *= 1 + 1e-12;
        const auto to_box = [&](std::uint32_t l, std::uint32_t i) {
            return distance_squared(boxes_.level(l)[i], around) * inverse_radius_squared_[l][i];
        };
        boxes_.search(to_box, limit, [&](std::uint32_t section) {
            fit = fit && count < kMaxCandidates;
            if (fit) {
                candidate[count++] = compute_capsule(section);
            } else {
                limit = -1;
            }
        });
    }
    for (std::size_t k = 1; k < points.size(); ++k) {
        if (!fit) {
            out[k] = nearest(points[k], out[k - 1].capsule);
            continue;
        }
        Closest closest(cones_, points[k]);
        for (std::size_t c = 0; c < count; ++c) closest.offer(candidate[c]);
        out[k] = closest.found();
    }
}

bool CapsuleTree::any_within(Vec3d p, double rho, std::uint32_t except) const {
    double limit = rho * rho;
    bool found = false;
    boxes_.search([&](std::uint32_t l, std::uint32_t i) { return bound(l, i, p); }, limit,
                  [&](std::uint32_t section) {
                      const std::uint32_t i = compute_capsule(section);
                      if (i == except || cones_[i].closest_point(p).relative_squared() >= rho * rho) return;
                      found = true;
                      limit = -1;
                  });
    return found;
}

double CapsuleTree::axis_distance(Vec3d p) const {
    double least = std::numeric_limits<double>::infinity();
    visit_near(p, least, [&](std::uint32_t, double d2) { least = d2; });
    return std::sqrt(least);
}

SegmentGap gap(const RoundCone& a, const RoundCone& b) {
    const auto at = [&](double s, double t) { return SegmentGap{distance(a.point(s), b.point(t)), s, t}; };
    const auto closest_on_a = [&](double t) { return a.closest_point(b.point(t)).t; };
    const auto closest_on_b = [&](double s) { return b.closest_point(a.point(s)).t; };
    const double aa = length_squared(a.axis), bb = length_squared(b.axis), ab = dot(a.axis, b.axis);
    const double area = aa * bb - ab * ab;
    double s = 0;
    if (area > 1e-14 * aa * bb) {  // otherwise they are parallel, and any point of the overlap is correct
        const Vec3d w = a.a - b.a;
        s = std::clamp((ab * dot(b.axis, w) - bb * dot(a.axis, w)) / area, 0.0, 1.0);
    }
    const double t = closest_on_b(s);
    return at(closest_on_a(t), t);
}

}  // namespace coppice
