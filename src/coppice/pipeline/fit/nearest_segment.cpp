#include "coppice/pipeline/fit/nearest_segment_internal.h"

#include "coppice/base/id.h"

namespace coppice::pipeline_internal {

namespace {

// [radii] A point of a surface on its own segment is about one radius from it.
constexpr double kMin = 0.6, kMax = 1.2;
constexpr int kMaxSteps = 64;
constexpr std::size_t kMaxChildren = 8;  // larger stars are left to the tree

}  // namespace

NearestSegment::NearestSegment(const Skeleton& skeleton, const CapsuleTree& capsules)
    : skeleton_(skeleton), capsules_(capsules), capsule_of_(skeleton.size(), kNoIndex) {
    for (std::uint32_t i = 0; i < capsules.size(); ++i) capsule_of_[capsules.node(i).index()] = i;
}

std::uint32_t NearestSegment::downhill(Vec3d p, std::uint32_t from, double& rho_squared) const {
    std::uint32_t best = from;
    const auto look = [&](NodeId n) {
        const std::uint32_t i = capsule_of_[n.index()];
        if (i == kNoIndex) return;
        const double there = capsules_.cone(i).closest_point(p).relative_squared();
        if (there >= rho_squared) return;
        rho_squared = there;
        best = i;
    };
    const auto look_at_children = [&](NodeId n) {
        const auto children = skeleton_.children(n);
        if (children.size() > kMaxChildren) return;
        for (const NodeId child : children) look(child);
    };
    rho_squared = capsules_.cone(from).closest_point(p).relative_squared();
    for (int step = 0; step < kMaxSteps; ++step) {
        const std::uint32_t at = best;
        const NodeId n = capsules_.node(at);
        look_at_children(n);
        if (!skeleton_.is_root(n)) {
            look(skeleton_.parent(n));
            look_at_children(skeleton_.parent(n));
        }
        if (best == at) break;
    }
    return best;
}

std::uint32_t NearestSegment::operator()(Vec3d p, std::uint32_t hint) const {
    if (hint != kNoIndex) {
        double rho_squared = 0;
        hint = downhill(p, hint, rho_squared);
        if (rho_squared > kMin * kMin && rho_squared < kMax * kMax) return hint;
    }
    return capsules_.nearest(p, hint).capsule;
}

}  // namespace coppice::pipeline_internal
