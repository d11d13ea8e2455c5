#pragma once

#include <cstdint>

#include "coppice/base/context.h"
#include "coppice/measure/cone_union.h"
#include "coppice/mesh/mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Results of fit_volume().
struct FitVolumeReport {
    double cones = 0;               ///< [m^3] volume of the union of the skeleton's rounded cones
    double error = 0;               ///< [m^3] two standard errors of `cones`
    double before = 0;              ///< [m^3] enclosed volume before the fit
    double after = 0;               ///< [m^3] enclosed volume after the fit
    double mean_offset = 0;         ///< [radii] mean displacement of all vertices; outward is positive
    double max_offset = 0;          ///< [radii] maximum absolute displacement of a vertex
    std::uint64_t pulled_back = 0;  ///< vertices that moved less to avoid folded or intersecting faces
    /// Whether the surface contains all of the skeleton except for deviations that fitting can repair. If
    /// not, its sections are fitted, but missing volume is not compensated elsewhere.
    bool closed = false;
    friend bool operator==(const FitVolumeReport&, const FitVolumeReport&) = default;  ///< memberwise
};

/// Moves the vertices of a surface along their normals so that it encloses the volume that its skeleton
/// specifies (see ConeUnion), locally and as a whole. With vertices on the true radius, chords cut off
/// volume: 2.6 % of a cylinder with 16 sides; and a field swells at forks and shrinks at bends.
///
/// The gap between surface and cones is measured on every face, along its normal, and spread over about one
/// radius of the surface around it, in proportion to the local radius: each such area of bark is then inside
/// the cones as much as outside. The remaining global difference, a few parts per thousand, is closed by one
/// factor for all vertices, from the volume of the union (see union_volume). Vertices of flat ends stay in
/// their plane, and tips keep their reach. Displacements that would fold a face, or create an intersecting
/// pair that did not intersect before, are reduced: the surface has no additional folds or intersections.
/// Only positions change.
///
/// The surface must have been built from the skeleton with these ends; an open base counts as closed by its
/// disc. O(n log n), about 300 bytes of additional memory per face. The result does not depend on the number
/// of threads.
FitVolumeReport fit_volume(QuadMesh& mesh, const Skeleton& skeleton, EndShape base, EndShape tips,
                           const Context& ctx = {});
/// The same for triangles.
FitVolumeReport fit_volume(TriMesh& mesh, const Skeleton& skeleton, EndShape base, EndShape tips,
                           const Context& ctx = {});

/// Calls visit(name, value) for every figure.
template <class Visitor>
void visit_figures(const FitVolumeReport& r, Visitor&& visit) {
    visit("cones", r.cones);
    visit("error", r.error);
    visit("before", r.before);
    visit("after", r.after);
    visit("mean_offset", r.mean_offset);
    visit("max_offset", r.max_offset);
    visit("pulled_back", r.pulled_back);
    visit("closed", r.closed);
}

}  // namespace coppice
