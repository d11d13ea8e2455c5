#include "coppice/pipeline/deform/node_binding_internal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/id.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/base/parallel.h"
#include "coppice/measure/capsule_tree.h"

namespace coppice::pipeline_internal {
namespace {

// Ranges of nodes in depth-first order: test whether one is a descendant of another.
class Lineage {
  public:
    explicit Lineage(const Skeleton& s) : size_(s.size(), 1), first_(s.size()) {
        for (std::uint32_t i = s.size(); i-- > 0;) {
            const NodeId parent = s.parent(NodeId(i));
            if (parent) size_[parent.index()] += size_[i];
        }
        std::vector<std::uint32_t> next(s.size());  // unused indices below a node
        std::uint32_t roots = 0;
        for (const NodeId n : nodes(s)) {
            const NodeId parent = s.parent(n);
            std::uint32_t& place = parent ? next[parent.index()] : roots;
            first_[n.index()] = place;
            place += size_[n.index()];
            next[n.index()] = first_[n.index()] + 1;
        }
    }
    bool is_line(NodeId a, NodeId b) const { return holds(a, b) || holds(b, a); }

  private:
    bool holds(NodeId a, NodeId b) const {
        return first_[b.index()] >= first_[a.index()] &&
               first_[b.index()] < first_[a.index()] + size_[a.index()];
    }
    std::vector<std::uint32_t> size_, first_;
};

struct Found {
    NodeId segment;
    double t = 1;
};

// Returns the closest segment, in metres, of those in line with `above`; of all segments if none of these is
// near.
Found find(const CapsuleTree& capsules, const Lineage& lineage, Vec3d p, NodeId above, double reach) {
    Found best, any;
    double least = std::numeric_limits<double>::infinity(), least_any = least;
    const double limit = reach * reach;
    const auto take = [&](Found& found, double& least_yet, std::uint32_t capsule, double d2) {
        const NodeId n = capsules.node(capsule);
        // Of equally close segments, as at nodes, the one closer to the root, independent of their order.
        if (d2 > least_yet || (d2 == least_yet && found.segment && !(n < found.segment))) return;
        const RoundCone& cone = capsules.cone(capsule);
        found = {n, std::clamp(cone.line_parameter(p), 0.0, 1.0)};
        least_yet = d2;
    };
    capsules.visit_near(p, limit, [&](std::uint32_t capsule, double d2) {
        take(any, least_any, capsule, d2);
        if (!above || lineage.is_line(above, capsules.node(capsule))) take(best, least, capsule, d2);
    });
    if (best.segment) return best;
    if (any.segment) return any;
    const CapsuleTree::Nearest nearest = capsules.nearest(p);
    if (nearest.capsule == kNoIndex) return {};
    return {capsules.node(nearest.capsule),
            std::clamp(capsules.cone(nearest.capsule).line_parameter(p), 0.0, 1.0)};
}

}  // namespace

NodeBinding::NodeBinding(const Skeleton& s, const Skeleton& made, const Context& ctx) : place_(made.size()) {
    constexpr double kReach = 1.5;  // [radii]
    const CapsuleTree capsules(s, s.origin(), ctx);
    const Lineage lineage(s);
    for (const NodeId n : nodes(made)) {
        Place& place = place_[n.index()];
        const Vec3d p(made.position(n));
        const double reach = kReach * double{made.radius(n)};
        const NodeId parent = made.parent(n);
        const NodeId above = parent ? place_[parent.index()].segment : NodeId::none();
        Found at = find(capsules, lineage, p, above, reach);
        if (!at.segment) {  // a tree of one node
            NodeId nearest(0);
            for (const NodeId m : nodes(s)) {
                if (distance(made.position(n), s.position(m)) <
                    distance(made.position(n), s.position(nearest)))
                    nearest = m;
            }
            at = {nearest, 1};
        }
        place.segment = at.segment;
        place.t = s.is_root(at.segment) ? 1 : at.t;
        place.turn = at.segment;
        if (parent) {
            const Vec3d middle = 0.5 * (p + Vec3d(made.position(parent)));
            const Found half = find(capsules, lineage, middle, at.segment, reach);
            if (half.segment) place.turn = half.segment;
        }
        const Vec3d b(s.position(at.segment));
        const Vec3d a = s.is_root(at.segment) ? b : Vec3d(s.position(s.parent(at.segment)));
        place.offset = p - lerp(a, b, place.t);
    }
}

Pose NodeBinding::follow(const Skeleton& s, const Skeleton& made, const Pose& pose) const {
    Pose out{std::vector<Vec3>(made.size()), std::vector<float>(made.size()),
             std::vector<Rotation>(made.size())};
    for (const NodeId n : nodes(made)) {
        const Place& place = place_[n.index()];
        const std::uint32_t i = place.segment.index();
        const std::uint32_t p = s.is_root(place.segment) ? i : s.parent(place.segment).index();
        const Vec3d on_axis = lerp(Vec3d(pose.positions[p]), Vec3d(pose.positions[i]), place.t);
        const double growth = std::lerp(double{pose.radii[p]} / double{s.radii()[p]},
                                        double{pose.radii[i]} / double{s.radii()[i]}, place.t);
        out.positions[n.index()] = Vec3(on_axis + pose.turns[i](place.offset));
        out.radii[n.index()] = static_cast<float>(growth * double{made.radius(n)});
        out.turns[n.index()] = pose.turns[place.turn.index()];
    }
    return out;
}

}  // namespace coppice::pipeline_internal
