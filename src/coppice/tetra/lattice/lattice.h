#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/tetra/lattice/tetra_mesh.h"

namespace coppice {

/// Extent and resolution of a lattice.
struct LatticeOptions {
    float cell = 3;        ///< [radii] maximum size of a cell that the surface may cross
    float inside = 0.7f;   ///< [radii] points within this distance from an axis count as inside
    float outside = 1.3f;  ///< [radii] points beyond this distance from every axis count as outside
};

/// Lists the members for front ends.
void list_fields(LatticeOptions& o, FieldList& list);

/// Tetrahedra around the surface of a skeleton, with sizes proportional to the local radius. The mesh is
/// conforming for any skeleton: branches may cross, touch, or be shorter than their radius.
///
/// Space is divided by an octree, fine where the radius is small. Neighbours across faces, edges and corners
/// differ by at most one level. Each face between two cells, with each edge of its border and the centers of
/// the two cells, defines a tetrahedron: cells of one size form the body-centered cubic lattice of congruent
/// tetrahedra, and a face between two sizes, or an edge that a smaller cell halves, needs no special case.
/// The lattice contains the tetrahedra that the surface may cross: all except those within `inside` radii of
/// one segment or beyond `outside` radii of all segments. It also contains all tetrahedra that an axis passes
/// through. Sides of cells are those of the octree's cube over powers of two, so they are between half of
/// `cell` radii and `cell` radii, less near a thinner branch; all positions are floats without rounding.
///
/// The tetrahedra of one cell are a region; cells are ordered along the Morton curve.
class Lattice {
  public:
    /// Throws InvalidInput naming an option out of range or a segment that has no radius or is not finite,
    /// and if segments are so thin compared with their length or coordinates that more than 16 million cells
    /// or 21 levels are required. O(n log n + cells); 50 to 60 bytes for each tetrahedron.
    explicit Lattice(std::span<const Segment> segments, const LatticeOptions& options = {},
                     const Context& ctx = {});
    /// Releases the memory.
    ~Lattice();
    Lattice(Lattice&&) noexcept;             ///< leaves the source empty
    Lattice& operator=(Lattice&&) noexcept;  ///< leaves the source empty

    const TetraMesh& mesh() const;  ///< current tetrahedra
    /// Returns for each region of the mesh the numbers of the segments with axes that may pass through its
    /// tetrahedra, ascending: all that do, and some that do not.
    const CompressedRows<std::uint32_t>& passing() const;

    /// Adds the tetrahedra on the other side of faces that belong to one tetrahedron only, and rebuilds the
    /// mesh, which changes its numbering. Returns false if there are no tetrahedra to add, at the border of
    /// the octree.
    bool grow(std::span<const TetraFace> faces, const Context& ctx = {});

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace coppice
