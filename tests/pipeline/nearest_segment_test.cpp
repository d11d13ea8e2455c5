#include <gtest/gtest.h>

#include <cmath>

#include "coppice/base/id.h"
#include "coppice/pipeline/fit/nearest_segment_internal.h"
#include "zoo.h"

namespace coppice::pipeline_internal {
namespace {

TEST(NearestSegment, FindsTheSegmentOfASurfacePointForAnyHint) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const CapsuleTree capsules(skeleton, skeleton.origin());
        const NearestSegment nearest(skeleton, capsules);
        for (std::uint32_t i = 0; i < capsules.size(); ++i) {
            const RoundCone& c = capsules.cone(i);
            const Vec3d p = c.point(0.5) + perpendicular(normalized(c.axis, {0, 0, 1})) * c.radius(0.5);
            const double least = capsules.nearest(p).rho;
            for (const std::uint32_t hint : {kNoIndex, i, 0u, capsules.size() - 1}) {
                const std::uint32_t found = nearest(p, hint);
                ASSERT_NE(found, kNoIndex);
                const double rho = std::sqrt(capsules.cone(found).closest_point(p).relative_squared());
                // The minimum, or a segment with the point on its bark.
                EXPECT_TRUE(rho <= least + 1e-9 || (rho > 0.6 && rho < 1.2)) << i << ' ' << hint;
            }
        }
    }
}

TEST(NearestSegment, ReturnsNoneWithoutSegments) {
    const Skeleton ball({NodeId::none()}, {{0, 0, 0}}, {1});
    const CapsuleTree capsules(ball, {});
    EXPECT_EQ(NearestSegment(ball, capsules)({0, 0, 1}, kNoIndex), kNoIndex);
}

}  // namespace
}  // namespace coppice::pipeline_internal
