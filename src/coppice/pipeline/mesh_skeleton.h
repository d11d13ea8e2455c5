#pragma once

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/mesh_options.h"
#include "coppice/pipeline/mesh_result.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Returns the faces of a surface of any method. O(n).
PolygonMesh to_polygons(const MeshResult& result);

/// Wraps a skeleton in one closed surface of quads, one sphere per tree that does not intersect another:
/// prepares the skeleton, merges branches that intersect each other, finds the ramifications, builds a coarse
/// cage, subdivides it, moves it onto the convolution field, and unfolds folded quads [Zhu2015]. Where quads
/// still cross, or from two levels on sever an axis, the tubes are replaced by quads made from the triangles
/// of tetrahedra, which never intersect and contain all axes; branches that touch there become one body, and
/// a loop of such branches is a handle of the surface. Level 0 and open bases are not checked. Trees that
/// intersect each other are merged too; with `overlaps` apart they are bent apart first (see bend_apart), and
/// the surface is that of the bent skeleton.
///
/// About 70 quads per segment at two levels. O(n log n); memory: at most 120 bytes per quad in addition to
/// the input.
///
/// With tetrahedra, wraps the skeleton in triangles, as large as the local radius allows: prepares the
/// skeleton, puts a lattice of tetrahedra around it, and finds the surface in them. Branches that cross or
/// touch become one body: the surface is closed, manifold and never intersects itself, but may have handles.
/// It has one component for each tree, for any options, or fewer if trees touch. With tetra.base polyhedron,
/// the bounding polyhedron of [Zhu2013] replaces the lattice.
///
/// With ramifications, builds the cage from units at forks (see build_ramifications), which is subdivided
/// once less, moved onto the field, unfolded, and remeshed where quads cross, as for quads. Level 1 is not
/// checked.
///
/// With bmesh, the field is the plain sum of metaballs (kernel balls, blend 1, for any given values);
/// everything else is done as with quads.
///
/// With cylinders, creates a tube for every axis of the prepared skeleton (see cylinders()): `sides` around,
/// doubled for each level, and two to the power of levels rows along each segment.
///
/// With `fit` volume, each of the closed surfaces is finally moved so that it encloses the volume of the
/// skeleton's rounded cones (see fit_volume). With `automatic` its volume is measured (about 20 ms), and it
/// is moved if the volume deviates by more than half a percent beyond the error and moving improves it;
/// without levels always, unless the result deviates more. Triangles, cylinders, quads on metaballs, and
/// quads with an open base, global weights or a radius_scale stay unchanged.
///
/// Throws InvalidInput naming an option out of range, a node at which more than 256 branches begin (except
/// for cylinders), `levels` if the mesh would be too large to index, `fit` if it is not surface for
/// cylinders, and `kernel` if it is neither quartic nor balls for bmesh; and if tetrahedra find no surface
/// because it is thinner than they are.
MeshResult mesh_skeleton(const Skeleton& skeleton, const MeshOptions& options = {}, const Context& ctx = {});

/// The same with global weights that are fitted to these points of the surface, or to chosen points if there
/// are none. The points are ignored for local weights.
MeshResult mesh_skeleton(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options,
                         const Context& ctx = {});

/// The same by tetrahedra, including those inside the surface, for finite elements (TetraSurface::solid):
/// they share whole faces, grow with the local radius, and their vertices begin with those of the surface;
/// the triangles of the surface are exactly their unshared faces. Memory: about 40 bytes more for each
/// tetrahedron of the finest level.
///
/// Throws as above, and InvalidInput naming `method` if it is not tetrahedra, or `fit` if it is not surface.
MeshResult mesh_solid(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options = {},
                      const Context& ctx = {});

}  // namespace coppice
