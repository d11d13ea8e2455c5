#include "coppice/tetra/polyhedron/sections_internal.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/frame.h"

namespace coppice::tetra_internal {
namespace {

/// [half edges, squared] weight of a heavy corner; a light corner has the negative of it. Large enough that
/// the weights determine the edges where points are cospherical.
constexpr double kWeight = 0.1;
/// [radii] distance from a node at the end of a branch to the last square
constexpr double kBeyondEnd = 1.35;
constexpr double kMinGap = 1.2;  ///< [radii] minimum distance between squares of one branch
/// [radii] distance from the axes of two branches at which they separate
constexpr double kForkClearance = 1.25;
/// minimum sine of the angle between branches; smaller angles separate too far out
constexpr double kMinSine = 0.25;
constexpr double kThinLateral = 0.6;  ///< [radii] a node with a thicker lateral is a fork
/// cosine of the maximum turn with which a branch continues across others
constexpr double kStraight = 0.64;
constexpr double kSharp = -0.17;  ///< cosine of the turn from which a bend is a fork
constexpr std::size_t kFewChildren = 4;

Vec3d direction(Vec3d from, Vec3d to) { return normalized(to - from, Vec3d{0, 0, 1}); }

/// A polyline of nodes with radii, parametrised by arc length.
class Limb {
  public:
    Limb(const Skeleton& skeleton, const std::vector<NodeId>& path) {
        const Segment first = skeleton.segment(path[1]);
        add(Vec3d(first.a), first.radius_a);
        for (std::size_t i = 1; i < path.size(); ++i)
            add(Vec3d(skeleton.position(path[i])), skeleton.radius(path[i]));
    }

    double length() const { return along_.back(); }
    std::size_t size() const { return at_.size(); }
    double along(std::size_t i) const { return along_[i]; }
    double radius(std::size_t i) const { return radius_[i]; }

    Vec3d point(double s) const {
        const std::size_t i = piece(s);
        const double l = along_[i + 1] - along_[i];
        if (s < 0) return at_[0] + direction(at_[0], at_[1]) * s;
        if (s > length()) return at_.back() + direction(at_[i], at_[i + 1]) * (s - length());
        return l > 0 ? lerp(at_[i], at_[i + 1], (s - along_[i]) / l) : at_[i];
    }
    double radius_at(double s) const {
        const std::size_t i = piece(s);
        const double l = along_[i + 1] - along_[i];
        const double t = l > 0 ? std::clamp((s - along_[i]) / l, 0.0, 1.0) : 1;
        return radius_[i] + t * (radius_[i + 1] - radius_[i]);
    }
    /// Returns the maximum radius of a section.
    double max_radius(double from, double to) const {
        double out = std::max(radius_at(from), radius_at(to));
        for (std::size_t i = piece(from) + 1; i < size() && along_[i] < to; ++i)
            out = std::max(out, radius_[i]);
        return out;
    }
    /// Returns the index of the segment that contains s.
    std::size_t piece(double s) const {
        const auto above = std::upper_bound(along_.begin() + 1, along_.end() - 1, s);
        return static_cast<std::size_t>(above - along_.begin()) - 1;
    }

  private:
    void add(Vec3d at, double radius) {
        along_.push_back(at_.empty() ? 0 : along_.back() + distance(at_.back(), at));
        at_.push_back(at);
        radius_.push_back(radius);
    }

    std::vector<Vec3d> at_;
    std::vector<double> along_, radius_;
};

class Finder {
  public:
    Finder(const Skeleton& skeleton, const PolyhedronOptions& options)
        : skeleton_(skeleton), options_(options) {
        out_.side.assign(skeleton.size(), Vec3d{1, 0, 0});
    }

    Sections run() {
        for (const NodeId n : nodes(skeleton_)) {
            const NodeId next = continued(n);
            for (const NodeId child : skeleton_.children(n)) {
                if (child != next) wrap(n, child);
            }
            if (skeleton_.is_root(n) ? skeleton_.children(n).size() != 1 : is_shapeless(n, next)) add_cube(n);
            if (!next) add_auxiliary(n);
        }
        return std::move(out_);
    }

  private:
    struct Incident {
        Vec3d direction;
        double radius;
    };

    Vec3d at(NodeId n) const { return Vec3d(skeleton_.position(n)); }
    double cosine_of_turn(NodeId n, NodeId child) const {
        return dot(direction(at(skeleton_.parent(n)), at(n)), direction(at(n), at(child)));
    }

    /// Returns the child that continues the branch at n; invalid if the branch ends there.
    NodeId continued(NodeId n) const {
        const auto children = skeleton_.children(n);
        if (skeleton_.is_root(n) || children.empty()) return {};
        const NodeId leader = skeleton_.leader(n);
        const double cosine = cosine_of_turn(n, leader);
        if (children.size() == 1) return cosine > kSharp ? leader : NodeId{};
        if (cosine < kStraight) return {};
        for (const NodeId c : children) {
            if (c != leader && skeleton_.segment(c).radius_a > kThinLateral * skeleton_.radius(n)) return {};
        }
        return leader;
    }

    /// Returns whether squares and auxiliary points may fail to enclose the ball of a node.
    bool is_shapeless(NodeId n, NodeId next) const {
        const std::size_t children = skeleton_.children(n).size();
        return !next && (children == 1 || children > kFewChildren);
    }

    /// Returns the distance from n at which the branch towards `child`, or towards the parent, separates from
    /// the others.
    double clearance(NodeId n, NodeId child) const {
        std::vector<Incident> others;
        Incident own{};
        const auto add = [&](NodeId neighbor, double radius) {
            const Incident i{direction(at(n), at(neighbor)), radius};
            if (neighbor == child) {
                own = i;
            } else {
                others.push_back(i);
            }
        };
        if (!skeleton_.is_root(n)) add(skeleton_.parent(n), skeleton_.radius(n));
        for (const NodeId c : skeleton_.children(n)) add(c, skeleton_.segment(c).radius_a);
        double out = 0;
        for (const Incident& o : others) {
            const double cosine = dot(own.direction, o.direction);
            const double sine = std::max(kMinSine, std::sqrt(std::max(0.0, 1 - cosine * cosine)));
            out = std::max(out, kForkClearance * (cosine > 0 ? (own.radius + o.radius) / sine : o.radius));
        }
        return out;
    }

    /// Places squares along the branch that begins with the segment from n to child.
    void wrap(NodeId n, NodeId child) {
        std::vector<NodeId> path{n, child};
        while (const NodeId next = continued(path.back())) path.push_back(next);
        const NodeId last = path.back();
        const Limb limb(skeleton_, path);
        const bool from_end = skeleton_.is_root(n) && skeleton_.children(n).size() == 1;
        double start = from_end ? -kBeyondEnd * limb.radius(0) : clearance(n, child);
        double end = limb.length();
        if (skeleton_.is_tip(last)) {
            end += kBeyondEnd * limb.radius(limb.size() - 1);
            start = std::min(start, 0.75 * limb.length());
        } else {
            end -= clearance(last, path[path.size() - 2]);
            if (from_end) end = std::max(end, 0.25 * limb.length());
        }
        place(limb, path, stations(limb, start, end));
    }

    /// Returns the positions of squares along a limb: the first, the last, and at nodes between.
    static std::vector<double> stations(const Limb& limb, double start, double end) {
        if (end - start < kMinGap * limb.radius_at(0.5 * (start + end)) && start >= 0 && end <= limb.length())
            return {std::clamp(0.5 * (start + end), 0.0, limb.length())};
        std::vector<double> out{start};
        for (std::size_t i = 1; i + 1 < limb.size(); ++i) {
            const double gap = kMinGap * limb.radius(i);
            if (limb.along(i) > out.back() + gap && limb.along(i) < end - gap) out.push_back(limb.along(i));
        }
        out.push_back(end);
        return out;
    }

    void place(const Limb& limb, const std::vector<NodeId>& path, const std::vector<double>& where) {
        std::vector<Section> made(where.size());
        for (std::size_t i = 0; i < where.size(); ++i) made[i].center = limb.point(where[i]);
        for (std::size_t i = 0; i < where.size(); ++i) {
            const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, where.size() - 1);
            Section& s = made[i];
            s.normal = before == after ? direction(limb.point(0), limb.point(limb.length()))
                                       : direction(made[before].center, made[after].center);
            s.radius = limb.max_radius(0.5 * (where[before] + where[i]), 0.5 * (where[i] + where[after]));
            s.side = i == 0 ? perpendicular(s.normal)
                            : carried(made[i - 1].side, made[i - 1].center, made[i - 1].normal, s.center,
                                      s.normal);
            s.is_odd = i % 2 == 1;
            add_corners(out_.corners, s, options_);
            ++out_.report.sections;
        }
        for (std::size_t i = 1; i < path.size(); ++i) {
            const double middle = 0.5 * (limb.along(i - 1) + limb.along(i));
            const auto above = std::ranges::lower_bound(where, middle);
            out_.side[path[i].index()] =
                made[std::min(static_cast<std::size_t>(above - where.begin()), made.size() - 1)].side;
        }
    }

    /// Adds the corners of a cube around a node.
    void add_cube(NodeId n) {
        const double half = 0.5 * options_.section * skeleton_.radius(n);
        for (unsigned c = 0; c < 8; ++c) {
            const auto coordinate = [&](unsigned axis) { return (c >> axis & 1) != 0 ? half : -half; };
            const bool is_heavy = ((c ^ c >> 1 ^ c >> 2) & 1) != 0;
            out_.corners.push_back({at(n) + Vec3d{coordinate(0), coordinate(1), coordinate(2)},
                                    (is_heavy ? kWeight : -kWeight) * half * half, half});
            ++out_.report.auxiliary;
        }
    }

    /// Adds points on both sides of the plane of each pair of children, at the average length of the two
    /// segments from the node, but at least at the middle of a square's edge and at most at its corner.
    void add_auxiliary(NodeId n) {
        const auto children = skeleton_.children(n);
        if (children.size() > kFewChildren) return;
        const double half = 0.5 * options_.section * skeleton_.radius(n);
        for (std::size_t i = 0; i < children.size(); ++i) {
            for (std::size_t j = i + 1; j < children.size(); ++j) {
                const Vec3d a = at(children[i]) - at(n), b = at(children[j]) - at(n), up = cross(a, b);
                if (!(length(up) > 1e-3 * length(a) * length(b))) continue;
                const double far = std::clamp(0.5 * (length(a) + length(b)), half, std::sqrt(2.0) * half);
                for (const double way : {far, -far})
                    out_.corners.push_back({at(n) + normalized(up, Vec3d{0, 0, 1}) * way, 0, half});
                out_.report.auxiliary += 2;
            }
        }
    }

    const Skeleton& skeleton_;
    const PolyhedronOptions& options_;
    Sections out_;
};

}  // namespace

void add_corners(std::vector<SectionCorner>& out, const Section& s, const PolyhedronOptions& options) {
    const double half = 0.5 * options.section * s.radius, diagonal = std::sqrt(2.0) * half;
    const Vec3d across = cross(s.normal, s.side);
    const Vec3d corner[4] = {s.side, across, -s.side, -across};
    for (unsigned k = 0; k < 4; ++k) {
        const bool is_heavy = (k % 2 == 1) == s.is_odd;
        out.push_back({s.center + corner[k] * diagonal, (is_heavy ? kWeight : -kWeight) * half * half, half});
    }
}

Sections find_sections(const Skeleton& skeleton, const PolyhedronOptions& options) {
    return Finder(skeleton, options).run();
}

}  // namespace coppice::tetra_internal
