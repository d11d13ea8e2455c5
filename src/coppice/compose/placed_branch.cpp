#include "coppice/compose/placed_branch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "coppice/base/error.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/compose/branch_frame_internal.h"

namespace coppice {
namespace {

using namespace compose_internal;

constexpr int kSides = 24;                           // number of candidate azimuths
constexpr std::array kProbes{0.25, 0.5, 0.75, 1.0};  // [extent of the branch] positions of the probe points
constexpr double kBetter = 1e-6;                     // minimum relative improvement over the best side

/// The segments of a tree that a branch of a given extent may meet at a place.
class Surroundings {
  public:
    Surroundings(const Skeleton& tree, Vec3d place, double extent) {
        for (const NodeId n : nodes(tree)) {
            if (tree.is_root(n)) continue;
            const Vec3d a(tree.position(tree.parent(n))), way = Vec3d(tree.position(n)) - a;
            if (distance_to(place, {a, way}) < 2 * extent) segments_.push_back({a, way});
        }
    }

    /// Returns the density of segments around probe points along a direction from a place, with near segments
    /// weighted most: at their closest points and at their ends, because the closest point of segments that
    /// leave the same place is the place itself.
    double crowd(Vec3d place, Vec3d way) const {
        const double least = 1e-6 * length_squared(way);
        const auto weight = [&](double d) { return 1 / std::max(least, d * d); };
        double sum = 0;
        for (const double part : kProbes) {
            const Vec3d probe = place + way * part;
            for (const Ray& s : segments_) {
                const double near = distance_to(probe, s), end = distance(probe, s.from + s.way);
                sum += length(s.way) * (weight(near) + weight(end));
            }
        }
        return sum;
    }

  private:
    struct Ray {
        Vec3d from, way;
    };
    static double distance_to(Vec3d p, const Ray& s) {
        return distance(p, s.from + s.way * closest_parameter(p, s.from, s.way));
    }

    std::vector<Ray> segments_;
};

/// Returns the direction with the original inclination towards the side with the most free space; on ties,
/// the first one counted from +x.
Vec3d roomy_direction(const ChildTree& branch, const Skeleton& tree, const ParentPlace& place, double scale) {
    const Frame side = branch_frame(place.direction, {1, 0, 0});
    const double extent = scale * measure(branch).extent, a = double{branch.inclination};
    const Surroundings surroundings(tree, place.position, extent);
    Vec3d best;
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < kSides; ++k) {
        const double azimuth = 2 * std::numbers::pi * k / kSides;
        const Vec3d out = side.x * std::cos(azimuth) + side.y * std::sin(azimuth);
        const Vec3d way = side.z * std::cos(a) + out * std::sin(a);
        const double crowd = surroundings.crowd(place.position, way * extent);
        if (k > 0 && crowd >= least * (1 - kBetter)) continue;
        least = crowd;
        best = way;
    }
    return best;
}

Vec3d compute_direction(const ChildTree& branch, const Skeleton& tree, const ParentPlace& place,
                        const BranchPose& pose) {
    if (!pose.direction) return roomy_direction(branch, tree, place, pose.scale);
    if (!(length(*pose.direction) > 0))
        throw InvalidInput("a direction of 0,0,0 leads nowhere; enter a vector that is not zero");
    return normalized(*pose.direction);
}

}  // namespace

ParentPlace find_parent_place(const Skeleton& tree, NodeId node, double along) {
    const ParentPlace end{Vec3d(tree.position(node)), compute_parent_direction(tree, node),
                          double{tree.radius(node)}};
    if (tree.is_root(node) || along >= 1) return end;
    const Segment s = tree.segment(node);
    return {lerp(Vec3d(s.a), Vec3d(s.b), along), normalized(Vec3d(s.b) - Vec3d(s.a), end.direction),
            s.radius_a + (double{s.radius_b} - s.radius_a) * along};
}

Skeleton placed_branch(const ChildTree& branch, const Skeleton& tree, const ParentPlace& place,
                       const BranchPose& pose) {
    const Frame frame =
        rolled(branch_frame(compute_direction(branch, tree, place, pose), place.direction), pose.roll);
    const Vec3d start =
        place.position + frame.z * std::max(0.0, place.radius - pose.scale * double{branch.parent_radius});
    const Skeleton& s = branch.skeleton;
    std::vector<Vec3> positions;
    std::vector<float> radii;
    for (const NodeId n : nodes(s)) {
        const Vec3d from = s.is_root(n) ? place.position : start;
        positions.emplace_back(from + frame.to_world(Vec3d(s.position(n)) * pose.scale));
        radii.push_back(static_cast<float>(double{s.radius(n)} * pose.scale));
    }
    return Skeleton({s.parents().begin(), s.parents().end()}, std::move(positions), std::move(radii),
                    tree.origin());
}

}  // namespace coppice
