#pragma once

#include <cstdint>

#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/mesh/height_texture.h"
#include "coppice/pipeline/mesh_result.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Options of the displacement of a surface by heights.
struct DisplaceOptions {
    float displace_height = 0;    ///< [m] difference in height of black and white; 0: that of the texture
    float displace_share = 0.2f;  ///< [radii] maximum displacement: heights are scaled down on thin branches
};

/// Lists the members for front ends.
void list_fields(DisplaceOptions& o, FieldList& list);

/// Counts and displacements of `displace_surface`.
struct DisplaceReport {
    std::uint64_t displaced = 0;    ///< vertices that moved
    std::uint64_t pulled_back = 0;  ///< vertices that moved less to avoid folded or intersecting faces
    std::uint32_t rounds = 0;       ///< rounds that limited displacements
    double scale = 0;               ///< [m] difference in height of black and white on thick branches
    double mean_offset = 0;         ///< [m] mean absolute displacement of all vertices
    double max_offset = 0;          ///< [m] maximum absolute displacement
    double volume_before = 0;       ///< [m^3] enclosed; not meaningful for open bases
    double volume_after = 0;        ///< [m^3] enclosed
    friend bool operator==(const DisplaceReport&, const DisplaceReport&) = default;  ///< memberwise
};

/// Calls visit(name, value) for every figure.
template <class Visitor>
void visit_figures(const DisplaceReport& r, Visitor&& visit) {
    visit("displaced", r.displaced);
    visit("pulled_back", r.pulled_back);
    visit("rounds", r.rounds);
    visit("scale_m", r.scale);
    visit("mean_offset_m", r.mean_offset);
    visit("max_offset_m", r.max_offset);
    visit("volume_before_m3", r.volume_before);
    visit("volume_after_m3", r.volume_after);
}

/// Moves the vertices of a surface along their normals by the heights of a texture, relative to the mean
/// height of the texture, so that the volume is about the same. Every vertex takes the mean height over the
/// distance to its neighbours in the texture, so that details between vertices do not alias; on seams, the
/// mean of its coordinates. Vertices of flat ends stay in their plane, and tips keep their reach.
///
/// Heights are scaled down where the largest one would exceed `displace_share` of the local radius (that of
/// `skeleton` nearby; a tree of one node has no radii and does not move). At faces that would fold, and pairs
/// that would intersect and did not before, displacements are reduced by halves, then to zero: the surface
/// has no additional folds or intersections. Only positions change, and the volumes of the surface.
///
/// O(n log n) for n vertices; about 300 bytes of additional memory per face, and 8 per pixel. The result does
/// not depend on the number of threads. Throws InvalidInput naming an option out of range, if the surface has
/// no texture coordinates, consists of cylinders, which intersect each other, or has tetrahedra inside, if
/// neither texture nor options have a scale, or if the surface intersects itself too often to separate new
/// intersections from existing ones.
DisplaceReport displace_surface(MeshResult& surface, const Skeleton& skeleton, const HeightTexture& texture,
                                const DisplaceOptions& options = {}, const Context& ctx = {});

}  // namespace coppice
