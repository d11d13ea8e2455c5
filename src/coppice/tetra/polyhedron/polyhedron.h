#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/tetra/lattice/tetra_mesh.h"

namespace coppice {

/// How wide the polyhedron is.
struct PolyhedronOptions {
    float section = 3;     ///< [radii] edge of the square cross-sections, as printed
    float outside = 1.2f;  ///< [radii] what lies beyond this of every axis is taken to be outside
};

template <class Self, class Visitor>
requires SameOptions<Self, PolyhedronOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"section", "edge of the square cross-sections", Unit::radius, 2, 8}, o.section);
    visit(Field{"outside", "how far from every axis all is taken to be outside", Unit::radius, 1.01, 4},
          o.outside);
}

/// What a polyhedron is made of, counted.
struct PolyhedronReport {
    std::uint32_t sections = 0;   ///< squares across branches: at nodes, beside forks, beyond ends
    std::uint32_t auxiliary = 0;  ///< points beside the planes of two children, and about nodes without shape
    std::uint32_t added = 0;      ///< squares put in where tetrahedra were too wide for their branch
    std::uint32_t tetra = 0;      ///< before anything is cut in eight
};

/// The bounding polyhedron of [Zhu2013] as tetrahedra: squares across the branches, three radii wide, at
/// every node and beside every fork, auxiliary points on both sides of the plane of two children, and
/// tetrahedra between them, a handful for each segment.
///
/// The tetrahedra are those of the regular triangulation of all these points that the surface may cross or an
/// axis passes through. So they share whole faces, have positive volumes and do not overlap, whatever the
/// branches do; where the polyhedra of two branches overlap, both share the tetrahedra between them. Straight
/// branches get five for each segment. Where a tetrahedron by the bark is much wider than its branch is
/// thick, a square is added.
///
/// The tetrahedra about one segment are a region.
class Polyhedron {
  public:
    /// `axes` are the segments of the nodes that are not roots, in order, and balls where a tree is one node:
    /// see `segment_axes`. Throws InvalidInput naming an option out of range, and when a segment is too thin
    /// for the coordinates: by a factor of about a million. O(n log n); some 3 kB for each segment.
    Polyhedron(const Skeleton& skeleton, std::span<const Segment> axes, const PolyhedronOptions& options = {},
               const Context& ctx = {});
    /// Frees the memory.
    ~Polyhedron();
    Polyhedron(Polyhedron&&) noexcept;             ///< leaves the other one empty
    Polyhedron& operator=(Polyhedron&&) noexcept;  ///< leaves the other one empty

    const TetraMesh& mesh() const;           ///< what it holds now
    const PolyhedronReport& report() const;  ///< of what it holds now
    /// For each region of the mesh, the numbers of the axes that may pass through its tetrahedra, ascending:
    /// all that do, and some that pass it by.
    const CompressedRows<std::uint32_t>& passing() const;

    /// Adds the tetrahedra on the other side of faces that belong to one tetrahedron only, and rebuilds the
    /// mesh, so that its numbers change. False when there is nothing there.
    bool grow(std::span<const TetraFace> faces, const Context& ctx = {});

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The segments of the nodes that are not roots, in their order, and a ball for each tree of one node.
std::vector<Segment> segment_axes(const Skeleton& skeleton);

}  // namespace coppice
