#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/sketch/sketch.h"

namespace coppice {

/// How strokes become branches.
struct SketchOptions {
    float noise = 0;       ///< [pixels] how far points stray from where they should lie; 0 = as measured
    float bend = 0.8f;     ///< [rad] by which branches turn, about, from start to tip; less is smoother
    float max_error = 10;  ///< [pixels] root mean square off its strokes, beyond which a branch is refused
    float least_angle = 0.05f;  ///< [rad] between views, below which there is no depth to be had from them
    float tolerance =
        0.05f;  ///< [radius] by which nodes that are left out may move the surface; 0 = keep all
    /// Moves cameras by little until strokes lie on each other's lines of sight; the first one stays.
    bool refine_cameras = false;
};

template <class Self, class Visitor>
requires SameOptions<Self, SketchOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"noise", "pixels by which drawn points stray; 0 = as measured along each stroke", Unit::none,
                0, 100},
          o.noise);
    visit(Field{"bend", "turn of a branch from start to tip that is usual; less is smoother", Unit::radian,
                0.01, 10},
          o.bend);
    visit(common_field("max_error",
                       "Maximum distance in pixels of a branch from its strokes, as root mean square",
                       Unit::none, 0.1, 1000),
          o.max_error);
    visit(
        Field{"least_angle", "angle between views below which strokes are refused", Unit::radian, 1e-3, 1.5},
        o.least_angle);
    visit(Field{"tolerance", "greatest shift of the surface by leaving out nodes; 0 keeps all", Unit::radius,
                0, 1},
          o.tolerance);
    visit(Field{"refine_cameras",
                "moves cameras by little until starts and tips lie on each other's lines of sight"},
          o.refine_cameras);
}

/// What became of one stroke.
struct StrokeFit {
    std::uint32_t view = 0;      ///< index of the view
    std::uint32_t points = 0;    ///< that were drawn, repeated ones apart
    std::uint32_t left_out = 0;  ///< of them, taken for wrong
    bool reversed = false;       ///< it was drawn from the tip
    double rms_error = 0;        ///< [pixels] of the other points off the branch in this picture
    double max_error = 0;        ///< [pixels] the same at most
};

/// What became of one branch.
struct BranchFit {
    std::uint32_t branch = 0;     ///< index in the sketch
    std::string refused;          ///< one sentence that names its strokes and their angle; empty: it was made
    double angle = 0;             ///< [rad] between the two lines of sight that it was made from
    double matched = 0;           ///< of the stroke of which less is matched, in [0, 1]
    double length = 0;            ///< [m]
    bool guessed_radius = false;  ///< no widths were drawn
    std::vector<StrokeFit> strokes;  ///< as drawn
};

/// A skeleton made of a sketch.
struct SketchResult {
    Skeleton skeleton;                ///< of all branches that were not refused
    std::vector<BranchFit> branches;  ///< one for each of the sketch, in its order
};

/// Makes a skeleton of a sketch, stems first [Huang2017].
///
/// Of every branch the two views that differ most are matched as whole strokes by dynamic programming: order
/// is kept, points lie near each other's epipolar line, and where that runs along the stroke both go on at
/// one pace. Then the axis in space is found that lies nearest to all strokes and bends least; wrong points
/// lose their weight. Parts that only one stroke has go on as smoothly as can be. A branch begins on its
/// parent's axis, at `attach` or where its strokes, drawn on backwards, come nearest to it. Radii are half of
/// the widths at the depth found; without widths or diameters a branch begins with 0.6 of its parent's radius
/// and ends with 0.3.
///
/// A branch is refused, and all that grow from it: drawn in one view alone, in views less than `least_angle`
/// apart, strokes that do not match or whose lines of sight meet behind a camera, or a result farther than
/// `max_error` off its strokes.
///
/// O(points) and 48^2 for each branch; the same bits for any number of threads. Throws InvalidInput as
/// `validate` does, for a stem without widths, and when every branch was refused; Cancelled. `source` names
/// the sketch in messages.
SketchResult reconstruct(const Sketch& sketch, const SketchOptions& options, const std::string& source,
                         const Context& ctx = {});

}  // namespace coppice
