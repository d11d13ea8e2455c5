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

/// Where a lattice is, and how fine.
struct LatticeOptions {
    float cell = 3;        ///< [radii] a cell that the surface may cross is no larger than this
    float inside = 0.7f;   ///< [radii] what lies within this of an axis is taken to be inside
    float outside = 1.3f;  ///< [radii] what lies beyond this of every axis is taken to be outside
};

template <class Self, class Visitor>
requires SameOptions<Self, LatticeOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"cell", "greatest size of a cell that the surface may cross", Unit::radius, 0.1, 200},
          o.cell);
    visit(Field{"inside", "how far from an axis all is taken to be inside", Unit::radius, 0, 0.99}, o.inside);
    visit(Field{"outside", "how far from every axis all is taken to be outside", Unit::radius, 1.01, 4},
          o.outside);
}

/// Tetrahedra around the surface of a skeleton, their size in proportion to the local radius, conforming
/// whatever the skeleton does: branches may cross, touch, or be shorter than their radius.
///
/// Space is cut into an octree, fine where the radius is small, whose neighbours (across faces, edges and
/// corners) differ by one level at most. Each face between two cells, with each edge of its border, and the
/// centers of the two cells, makes a tetrahedron: cells of one size give the body-centered cubic lattice,
/// whose tetrahedra are all alike, and a face between two sizes, or an edge that a smaller cell halves, needs
/// no special case. The lattice holds those tetrahedra that the surface may cross: all but those that lie
/// within `inside` radii of one segment or beyond `outside` radii of all. And it holds all that a segment's
/// axis passes through. Sides of cells are powers of two,
/// so they lie between half of `cell` radii and `cell` radii, less where a thinner branch is near, and all
/// positions are floats without rounding.
///
/// The tetrahedra of one cell are a region; cells follow each other along the Morton curve.
class Lattice {
  public:
    /// Throws InvalidInput naming an option out of range or a segment that has no radius or is not finite,
    /// and when segments are so thin for their length, or for their coordinates, that more than 16 million
    /// cells or 21 levels would be needed. O(n log n + cells); 50 to 60 bytes for each tetrahedron.
    explicit Lattice(std::span<const Segment> segments, const LatticeOptions& options = {},
                     const Context& ctx = {});
    /// Frees the memory.
    ~Lattice();
    Lattice(Lattice&&) noexcept;             ///< leaves the other one empty
    Lattice& operator=(Lattice&&) noexcept;  ///< leaves the other one empty

    const TetraMesh& mesh() const;  ///< what it holds now
    /// For each region of the mesh, the numbers of the segments whose axes may pass through its tetrahedra,
    /// ascending: all that do, and some that pass it by.
    const CompressedRows<std::uint32_t>& passing() const;

    /// Adds the tetrahedra on the other side of faces that belong to one tetrahedron only, and rebuilds the
    /// mesh, so that its numbers change. False when there is nothing there, at the border of the octree.
    bool grow(std::span<const TetraFace> faces, const Context& ctx = {});

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace coppice
