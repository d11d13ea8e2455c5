#include "coppice/measure/cone_union.h"

#include <algorithm>
#include <utility>

#include "coppice/base/id.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice {
namespace {

constexpr double kReach = 3;  // [radii] from its centre to which a cut applies, as in the field

CapsuleTree make_capsules(const Skeleton& skeleton, Vec3d origin, const Context& ctx) {
    const Vec3d shift = skeleton.origin() - origin;
    std::vector<NodeId> named;
    std::vector<RoundCone> cones;
    named.reserve(skeleton.size());
    cones.reserve(skeleton.size());
    for (const NodeId n : nodes(skeleton)) {
        if (!skeleton.is_root(n)) {
            cones.push_back(round_cone(skeleton.segment(n)));
        } else if (skeleton.is_tip(n) || is_ball(skeleton, n)) {
            cones.push_back({Vec3d(skeleton.position(n)), {}, double{skeleton.radius(n)}, 0});
        } else {
            continue;
        }
        cones.back().a += shift;
        named.push_back(n);
    }
    return {std::move(named), std::move(cones), ctx};
}

/// Finds the flat ends of a skeleton and the segments that each may shorten.
class Cutter {
  public:
    Cutter(const Skeleton& skeleton, Vec3d origin, const CapsuleTree& capsules)
        : skeleton_(skeleton), shift_(skeleton.origin() - origin), capsule_of_(skeleton.size(), kNoIndex) {
        for (std::uint32_t i = 0; i < capsules.size(); ++i) capsule_of_[capsules.node(i).index()] = i;
    }

    void cut_bases() {
        for (const NodeId n : nodes(skeleton_)) {
            if (skeleton_.is_root(n) && skeleton_.children(n).size() == 1 && add(n, skeleton_.leader(n))) {
                cut_below(n);
            }
        }
    }

    void cut_tips() {
        for (const NodeId n : nodes(skeleton_)) {
            if (!skeleton_.is_root(n) && skeleton_.is_tip(n) && add(n, skeleton_.parent(n))) cut_above(n);
        }
    }

    std::vector<ConeUnion::Cut> cuts;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> taken;  ///< pairs of capsule and cut

  private:
    bool add(NodeId end, NodeId inward) {
        const Vec3d at(skeleton_.position(end)), axis = at - Vec3d(skeleton_.position(inward));
        const double l = length(axis);
        if (l > 0) cuts.push_back({at + shift_, axis / l, double{skeleton_.radius(end)}});
        return l > 0;
    }

    double reach() const { return kReach * cuts.back().radius; }
    void take(NodeId n) {
        taken.emplace_back(capsule_of_[n.index()], static_cast<std::uint32_t>(cuts.size() - 1));
    }
    double compute_length(NodeId n) const {
        return distance(skeleton_.position(n), skeleton_.position(skeleton_.parent(n)));
    }

    /// Marks segments away from the root.
    void cut_below(NodeId root) {
        std::vector<std::pair<NodeId, double>> open{{root, 0.0}};
        while (!open.empty()) {
            const auto [n, way] = open.back();
            open.pop_back();
            for (const NodeId child : skeleton_.children(n)) {
                take(child);
                const double there = way + compute_length(child);
                if (there < reach()) open.emplace_back(child, there);
            }
        }
    }

    /// Marks segments from the tip towards the root.
    void cut_above(NodeId tip) {
        double way = 0;
        for (NodeId n = tip; !skeleton_.is_root(n) && way < reach(); n = skeleton_.parent(n)) {
            take(n);
            way += compute_length(n);
        }
    }

    const Skeleton& skeleton_;
    Vec3d shift_;
    std::vector<std::uint32_t> capsule_of_;
};

}  // namespace

ConeUnion::ConeUnion(const Skeleton& skeleton, Vec3d origin, EndShape base, EndShape tips, const Context& ctx)
    : capsules_(make_capsules(skeleton, origin, ctx)) {
    Cutter cutter(skeleton, origin, capsules_);
    if (base == EndShape::flat) cutter.cut_bases();
    if (tips == EndShape::flat) cutter.cut_tips();
    cuts_ = std::move(cutter.cuts);
    cuts_of_ = compress_rows<std::uint32_t>(capsules_.size(), [&](const auto& put) {
        for (const auto& [capsule, cut] : cutter.taken) put(capsule, cut);
    });
}

bool ConeUnion::is_cut_off(std::uint32_t i, Vec3d p) const {
    return std::ranges::any_of(cuts_of_[i], [&](std::uint32_t k) {
        const Cut& cut = cuts_[k];
        const Vec3d w = p - cut.center;
        return dot(w, cut.outward) > 0 && length_squared(w) < kReach * kReach * cut.radius * cut.radius;
    });
}

bool ConeUnion::contains(Vec3d p) const {
    bool found = false;
    capsules_.visit_containing(p, [&](std::uint32_t i, const RoundCone::ClosestPoint&) {
        found = !is_cut_off(i, p);
        return !found;
    });
    return found;
}

}  // namespace coppice
