#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/sketch/sketch.h"

namespace coppice {

/// Options of reconstruct.
struct SketchOptions {
    float noise = 0;       ///< [pixels] standard deviation of drawn points; 0 = measured
    float bend = 0.8f;     ///< [rad] standard turn of a branch from start to tip; smaller values are smoother
    float max_error = 10;  ///< [pixels] maximum root mean square distance of a branch from its strokes
    float min_angle = 0.05f;  ///< [rad] minimum angle between views, below which depth cannot be computed
    /// [radius] maximum displacement of the surface by removing nodes; 0 = keep all
    float tolerance = 0.05f;
    /// Adjusts cameras slightly until strokes are on each other's lines of sight; the first camera is fixed.
    bool refine_cameras = false;
};

/// Lists the members for front ends.
void list_fields(SketchOptions& o, FieldList& list);

/// Result for one stroke.
struct StrokeFit {
    std::uint32_t view = 0;      ///< index of the view
    std::uint32_t points = 0;    ///< number of drawn points, without repeated ones
    std::uint32_t left_out = 0;  ///< number of points removed as wrong
    bool reversed = false;       ///< whether it was drawn from the tip
    /// [pixels] root mean square distance of the remaining points from the projected branch
    double rms_error = 0;
    double max_error = 0;  ///< [pixels] maximum of these distances
};

/// Result for one branch.
struct BranchFit {
    std::uint32_t branch = 0;  ///< index in the sketch
    std::string refused;       ///< reason for rejection: one sentence that names its strokes and their angle;
                               ///< empty if reconstructed
    double angle = 0;          ///< [rad] between the lines of sight of the two matched strokes
    double matched = 0;        ///< matched fraction of a stroke, the smaller of both, in [0, 1]
    double length = 0;         ///< [m]
    bool guessed_radius = false;     ///< whether the radii are guessed because no widths were drawn
    std::vector<StrokeFit> strokes;  ///< in the order of the sketch
};

/// A skeleton reconstructed from a sketch.
struct SketchResult {
    Skeleton skeleton;                ///< all branches that were not rejected
    std::vector<BranchFit> branches;  ///< one per branch of the sketch, in its order
};

/// Reconstructs a skeleton from a sketch, stems first [Huang2017].
///
/// For every branch, the strokes of the two views with the largest angle are matched by dynamic programming:
/// the order is preserved, points are near each other's epipolar lines, and where these are parallel to the
/// stroke both advance at the same rate. Then the axis that minimizes the distances to all strokes and the
/// bending is computed; outliers lose their weight. Sections that only one stroke shows continue as smoothly
/// as possible. A branch begins on the axis of its parent, at `attach` or at the point closest to the
/// backward extensions of its strokes. Radii are half of the widths at the computed depth; without widths or
/// diameters, a branch begins with 0.6 of the radius of its parent and ends with 0.3.
///
/// A branch and its descendants are rejected if it is drawn in a single view or in views with an angle below
/// `min_angle`, if its strokes do not match or their lines of sight meet behind a camera, or if the result
/// is farther than `max_error` from its strokes.
///
/// O(points) and 48^2 for each branch. The result does not depend on the number of threads. Throws
/// InvalidInput as `validate` does, for a stem without widths, and if every branch was rejected; Cancelled.
/// `source` names the sketch in messages.
SketchResult reconstruct(const Sketch& sketch, const SketchOptions& options, const std::string& source,
                         const Context& ctx = {});

}  // namespace coppice
