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

/// Points in layers of 2 cm or more, sorted upward, for fast queries between two heights.
class HeightOrder {
  public:
    /// Copies the points; O(n). Throws Cancelled.
    explicit HeightOrder(std::span<const Vec3> points, const Context& ctx = {});
    /// Returns the points with low <= z < high, and the other points of their layers.
    std::span<const Vec3> between(double low, double high) const;
    std::span<const Vec3> all() const { return points_; }  ///< sorted upward by layer
    double low() const { return low_; }                    ///< [m] minimum z
    double high() const { return high_; }                  ///< [m] maximum z

  private:
    std::size_t find_layer(double z) const;

    double low_ = 0, high_ = 0, thick_ = 1;
    std::vector<std::uint32_t> first_;  ///< first index of each layer, then the number of points
    Buffer<Vec3> points_;
};

struct TraceOptions {
    double foot = 0;        ///< [m] z of the ground at the stem
    double top = 0;         ///< [m] z of the highest point
    double noise = 0.006;   ///< [m]
    double spacing = 0.01;  ///< [m] spacing of the points; thinner stems are not traced
};

/// Returns sections across a stem up to where its branches can no longer be distinguished from it, starting
/// from `track` about breast height (in world z). The sections are at intervals of `step`, each across the
/// axis. Occluded sections are bridged over a limited length along the straight axis. Sorted upward.
std::vector<StemSection> trace_stem(const HeightOrder& points, const StemTrack& track, double step,
                                    const TraceOptions& options);

/// Diameter at a height, from a straight line through the radii of adjacent sections.
struct DiameterAt {
    double diameter = 0;   ///< [m] 0 if there is no section
    double deviation = 0;  ///< [m] standard deviation
    double residual = 0;   ///< [m] median residual of the circles
    double coverage = 0;   ///< median share of the circumference with points
    std::size_t sections = 0;
    Vec3d center;  ///< [m]
};
DiameterAt diameter_at(const HeightOrder& points, const StemTrack& track, double height,
                       const TraceOptions& options);

}  // namespace coppice::extract_internal
