#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/vec.h"
#include "coppice/extract/stem/stem_search_internal.h"

namespace coppice::extract_internal {

/// Points in layers of 2 cm or more, upward, so that those between two heights are found at once.
class HeightOrder {
  public:
    /// Copies them; O(n). Throws Cancelled.
    explicit HeightOrder(std::span<const Vec3> points, const Context& ctx = {});
    /// Those with low <= z < high, and what else their layers hold.
    std::span<const Vec3> between(double low, double high) const;
    std::span<const Vec3> all() const { return points_; }  ///< upward layer by layer
    double low() const { return low_; }                    ///< [m] least z
    double high() const { return high_; }                  ///< [m] greatest z

  private:
    std::size_t layer_of(double z) const;

    double low_ = 0, high_ = 0, thick_ = 1;
    std::vector<std::uint32_t> first_;  ///< of each layer, and the number of points
    Buffer<Vec3> points_;
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
