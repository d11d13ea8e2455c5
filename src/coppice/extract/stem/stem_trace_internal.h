#pragma once

#include <span>
#include <utility>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/extract/stem/stem_search_internal.h"

namespace coppice::extract_internal {

/// Points in order of height, so that those between two heights are found at once.
class HeightOrder {
  public:
    explicit HeightOrder(std::span<const Vec3> points);  ///< copies them; O(n log n)
    /// Those with low <= z < high.
    std::span<const Vec3> between(double low, double high) const;
    std::span<const Vec3> all() const { return points_; }

  private:
    std::vector<Vec3> points_;
};

struct TraceOptions {
    double foot = 0;        ///< [m] z of the ground at the stem
    double top = 0;         ///< [m] z of the highest point
    double noise = 0.006;   ///< [m]
    double spacing = 0.01;  ///< [m] of the points; stems thinner than about that are not followed
};

/// Sections across a stem up to where it can no longer be told from its branches, from what `track` says of
/// breast height (in world z). They stand `step` apart, each across the axis. Where some are hidden the axis
/// is followed straight on for a while. Upward.
std::vector<StemSection> trace_stem(const HeightOrder& points, const StemTrack& track, double step,
                                    const TraceOptions& options);

/// The diameter at a height by a straight line through the radii of sections about it.
struct DiameterAt {
    double diameter = 0;   ///< [m] 0: there is no section about
    double deviation = 0;  ///< [m] standard deviation
    double residual = 0;   ///< [m] of points about the circles, median
    double coverage = 0;   ///< share of the circumference that has points, median
    std::size_t sections = 0;
    Vec3d center;  ///< [m]
};
DiameterAt diameter_at(const HeightOrder& points, const StemTrack& track, double height,
                       const TraceOptions& options);

}  // namespace coppice::extract_internal
