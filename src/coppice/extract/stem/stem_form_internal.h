#pragma once

#include "coppice/extract/stem/stem_form.h"
#include "coppice/extract/stem/stem_trace_internal.h"

namespace coppice::extract_internal {

/// [m] How far points of that spacing lie off a stem, about: scans have some millimetres, bark included, and
/// the means of voxels more.
double stem_noise(double spacing);

/// The form of a stem that `track` (in world z) says of.
StemForm measure_stem(const HeightOrder& points, const StemTrack& track, const TraceOptions& trace,
                      Vec3d origin);

/// [m] z of the lowest end of a stem in points without ground: of those about its axis.
double foot_of(const HeightOrder& points, const StemTrack& track);

/// [m] z of the highest point that is no stray; at least one point.
double highest_of(const HeightOrder& points);

}  // namespace coppice::extract_internal
