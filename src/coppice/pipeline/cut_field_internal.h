#pragma once

#include <span>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/cage/cage.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Whether a tree ends at this node in a plane across it.
bool ends_flat(const Skeleton& skeleton, NodeId node, const ControlOptions& ends);

/// A field cut off by planes through the flat ends of its trees, each within a few radii of its end.
class CutField {
  public:
    /// Tips and roots (with one child) end as `ends` says. Refers to the field; one box per region.
    CutField(FieldRef field, const Skeleton& skeleton, const ControlOptions& ends,
             std::span<const Box3> regions, const Context& ctx);

    float level() const { return field_.level(); }
    void sample(std::uint32_t region, std::span<const Vec3> points, std::span<FieldSample> out) const;

  private:
    struct Cut {
        Vec3 center, outward;
        float radius;
    };

    FieldRef field_;
    std::vector<Cut> cuts_;
    std::vector<std::vector<std::uint32_t>>
        of_region_;  ///< places in cuts_; empty when there are none at all
};

}  // namespace coppice
