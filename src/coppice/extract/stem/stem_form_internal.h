#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/extract/plot/terrain.h"
#include "coppice/extract/stem/stem_form.h"
#include "coppice/extract/stem/stem_trace_internal.h"

namespace coppice::extract_internal {

/// Returns the maximum z [m] of each node and its descendants. O(n).
std::vector<float> highest_below(const Skeleton& skeleton);

/// Returns the axis of the stem of one tree, from its root: it continues with the child that leads highest,
/// of those at least 0.4 times as thick as the thickest one. Buttresses and stubs may be thicker than the
/// continuation of the stem.
std::vector<NodeId> main_axis(const Skeleton& skeleton, NodeId root, std::span<const float> reach);

/// Returns the approximate distance [m] of points of this spacing from the surface of a stem: some
/// millimetres for scans, bark included, and more for the means of voxels.
double stem_noise(double spacing);

/// Measures the form of the stem of `track` (in world z).
StemForm measure_stem(const HeightOrder& points, const StemTrack& track, const TraceOptions& trace,
                      Vec3d origin);

/// stem_form() for known ground; relative to the origin of the points.
StemForm stem_form_on(const Terrain& terrain, const PointSet& points, const Context& ctx);

/// Points of a cloud without its ground, and the stems detected in them.
struct StemScene {
    double lowest = 0;                   ///< [m] z of the lowest point that is not an outlier
    double scale = 1;                    ///< scale of the heights; smaller for trees of a few metres
    HeightOrder wood{{}};                ///< the points above the ground
    TraceOptions trace;                  ///< options of the tracing of stems
    std::vector<StemTrack> tracks = {};  ///< in the coordinate frame of the points, best coverage first

    /// Returns z [m] of the ground at a position, or of the lowest end of the cloud if there is no ground.
    double ground(const Terrain& terrain, Vec3d at) const {
        return terrain.is_ground ? terrain.height(at.x, at.y) : lowest;
    }
    /// Returns the trace options of this stem, starting at its foot.
    TraceOptions make_trace_options(const Terrain& terrain, const StemTrack& track) const;
};

/// Detects stems. O(n). Throws Cancelled.
StemScene find_stem_scene(std::span<const Vec3> points, const Terrain& terrain, double spacing,
                          const Context& ctx);

/// Returns z [m] of the lowest end of a stem in points without ground, from the points about its axis.
double find_base_height(const HeightOrder& points, const StemTrack& track);

/// Returns z [m] of the highest point that is not an outlier; requires at least one point.
double compute_max_height(const HeightOrder& points);

}  // namespace coppice::extract_internal
