#pragma once

#include <vector>

#include "coppice/pipeline/quads/quad_build.h"

namespace coppice::pipeline_internal {

/// Radii beyond places of tubes: the maximum radius of the branch from a place to all its tips. They only
/// decrease along every branch, so that it is thinner than a given radius from one place on.
class RadiiBeyond {
  public:
    /// The build must outlive this object. O(tubes).
    explicit RadiiBeyond(const QuadBuild& build);

    /// [m] Returns the radius beyond a node of the tubes.
    float at(NodeId node) const { return beyond_[node.index()]; }
    /// [m] Returns the radius beyond a place of a tube; `share` of its length from its beginning.
    float at(NodeId tube, float share) const;

  private:
    const QuadBuild& build_;
    std::vector<float> beyond_;  // [m] by node
};

}  // namespace coppice::pipeline_internal
