#include "coppice/pipeline/texture/radii_beyond_internal.h"

#include <algorithm>
#include <cmath>

namespace coppice::pipeline_internal {

RadiiBeyond::RadiiBeyond(const QuadBuild& build)
    : build_(build), beyond_(build.tubes.radii().begin(), build.tubes.radii().end()) {
    const Skeleton& tubes = build.tubes;
    for (std::uint32_t i = tubes.size(); i-- > 0;) {  // children before their parents
        if (tubes.is_root(NodeId(i))) continue;
        float& parent = beyond_[tubes.parent(NodeId(i)).index()];
        parent = std::max(parent, beyond_[i]);
    }
}

float RadiiBeyond::at(NodeId tube, float share) const {
    if (build_.tubes.is_root(tube)) return at(tube);
    const Segment segment = build_.tubes.segment(tube);
    if (!build_.sides.empty()) {
        const auto [first, last] = build_.sides[tube.index()];
        share = std::lerp(first, last, share);
    }
    return std::max(std::lerp(segment.radius_a, segment.radius_b, share), at(tube));
}

}  // namespace coppice::pipeline_internal
