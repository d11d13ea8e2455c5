#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/extract/plot/terrain.h"
#include "coppice/extract/stem/stem_form.h"
#include "coppice/extract/stem/stem_trace_internal.h"

namespace coppice::extract_internal {

/// [m] The greatest z of each node and of all that it bears. O(n).
std::vector<float> highest_below(const Skeleton& skeleton);

/// The stem of one tree, from its root: it goes on with the child that leads highest, of those at least 0.4
/// times as thick as the thickest. Buttresses and stubs may be thicker than what goes on.
std::vector<NodeId> main_axis(const Skeleton& skeleton, NodeId root, std::span<const float> reach);

/// [m] How far points of that spacing lie off a stem, about: scans have some millimetres, bark included, and
/// the means of voxels more.
double stem_noise(double spacing);

/// The form of a stem that `track` (in world z) says of.
StemForm measure_stem(const HeightOrder& points, const StemTrack& track, const TraceOptions& trace,
                      Vec3d origin);

/// stem_form() on ground that is known; relative to the origin of the points.
StemForm stem_form_on(const Terrain& terrain, const PointSet& points, const Context& ctx);

/// The points of a cloud without its ground, and the stems that are seen in them.
struct StemScene {
    double lowest = 0;                   ///< [m] z of the lowest point that is no stray
    double scale = 1;                    ///< of heights, for trees of a few metres
    HeightOrder wood{{}};                ///< the points above the ground
    TraceOptions trace;                  ///< how stems are followed
    std::vector<StemTrack> tracks = {};  ///< in the frame of the points, those seen best first

    /// [m] z of the ground at a place, or else of the lowest end of the cloud.
    double ground(const Terrain& terrain, Vec3d at) const {
        return terrain.is_ground ? terrain.height(at.x, at.y) : lowest;
    }
    /// How this stem is followed, from its foot.
    TraceOptions trace_of(const Terrain& terrain, const StemTrack& track) const;
};

/// Looks for stems. O(n). Throws Cancelled.
StemScene find_stem_scene(std::span<const Vec3> points, const Terrain& terrain, double spacing,
                          const Context& ctx);

/// [m] z of the lowest end of a stem in points without ground: of those about its axis.
double foot_of(const HeightOrder& points, const StemTrack& track);

/// [m] z of the highest point that is no stray; at least one point.
double highest_of(const HeightOrder& points);

}  // namespace coppice::extract_internal
