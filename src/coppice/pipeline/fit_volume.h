#pragma once

#include <cstdint>

#include "coppice/base/context.h"
#include "coppice/measure/cone_union.h"
#include "coppice/mesh/mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// What `fit_volume` found and did.
struct FitVolumeReport {
    double cones = 0;               ///< [m^3] of the union of the skeleton's rounded cones
    double error = 0;               ///< [m^3] of `cones`, two standard errors
    double before = 0;              ///< [m^3] that the surface enclosed
    double after = 0;               ///< [m^3] that it encloses now
    double mean_offset = 0;         ///< [radii] of all vertices; outward is positive
    double greatest_offset = 0;     ///< [radii] of any vertex, without sign
    std::uint64_t pulled_back = 0;  ///< vertices that moved less, so that no face folds or crosses another
    /// Whether the surface holds all of the skeleton but for what fitting can mend; where it does not, parts
    /// of it are fitted, but what is lost is not made up for elsewhere.
    bool closed = false;
    friend bool operator==(const FitVolumeReport&, const FitVolumeReport&) = default;  ///< member by member
};

/// Moves the vertices of a surface along their normals so that it encloses the volume that its skeleton means
/// (see ConeUnion), part by part and as a whole. Vertices that lie on the true radius leave out what chords
/// cut off: 2.6 % of a cylinder with 16 sides; and a field swells at forks and sinks at bends.
///
/// What lies between surface and cones is measured on every face, along its normal, and spread over about a
/// radius of the surface around it, in proportion to the local radius: every such piece of bark then lies as
/// much inside the cones as outside. What is left of the whole, a few parts in a thousand, is closed by one
/// factor for all, from the volume of the union (see union_volume). Vertices of flat ends stay in their
/// plane, and tips reach as far as before. Faces that would fold, and pairs that would cross and did not
/// before, are taken back: the surface has no more folds and crossings than before. Only positions change.
///
/// The surface must have been made of the skeleton with such ends; an open base counts as closed by its disc.
/// O(n log n), about 300 bytes per face meanwhile. The same bits for any number of threads.
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
    visit("greatest_offset", r.greatest_offset);
    visit("pulled_back", r.pulled_back);
    visit("closed", r.closed);
}

}  // namespace coppice
