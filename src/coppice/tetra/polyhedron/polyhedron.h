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

/// Dimensions of the polyhedron.
struct PolyhedronOptions {
    float section = 3;     ///< [radii] edge of the square cross-sections, as in the paper
    float outside = 1.2f;  ///< [radii] points beyond this distance from every axis count as outside
};

/// Lists the members for front ends.
void list_fields(PolyhedronOptions& o, FieldList& list);

/// Counts of the elements of a polyhedron.
struct PolyhedronReport {
    std::uint32_t sections = 0;   ///< squares across branches: at nodes, near forks, beyond ends
    std::uint32_t auxiliary = 0;  ///< points off the planes of pairs of children, and around shapeless nodes
    std::uint32_t added = 0;      ///< squares inserted where tetrahedra were too wide for their branch
    std::uint32_t tetra = 0;      ///< before subdivision
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const PolyhedronReport& r, Visitor&& visit) {
    visit("sections", r.sections);
    visit("auxiliary_points", r.auxiliary);
    visit("sections_added", r.added);
}

/// The bounding polyhedron of [Zhu2013] as tetrahedra: squares across the branches, three radii wide, at
/// every node and near every fork, auxiliary points on both sides of the plane of each pair of children, and
/// a few tetrahedra for each segment between them.
///
/// The tetrahedra are those of the regular triangulation of all these points that the surface may cross or an
/// axis passes through. They share whole faces, have positive volumes and do not overlap for any input; where
/// the polyhedra of two branches overlap, both share the tetrahedra between them. Straight branches have five
/// tetrahedra for each segment. Where a tetrahedron at the bark is much wider than its branch is thick, a
/// square is added.
///
/// The tetrahedra around one segment are a region.
class Polyhedron {
  public:
    /// `axes` are the segments of the nodes that are not roots, in order, and balls for trees of one node:
    /// see `segment_axes`. Throws InvalidInput naming an option out of range, or a segment that is too thin
    /// for the coordinates (by a factor of about a million). O(n log n); about 3 kB for each segment.
    Polyhedron(const Skeleton& skeleton, std::span<const Segment> axes, const PolyhedronOptions& options = {},
               const Context& ctx = {});
    /// Releases the memory.
    ~Polyhedron();
    Polyhedron(Polyhedron&&) noexcept;             ///< leaves the source empty
    Polyhedron& operator=(Polyhedron&&) noexcept;  ///< leaves the source empty

    const TetraMesh& mesh() const;           ///< current tetrahedra
    const PolyhedronReport& report() const;  ///< counts of the current mesh
    /// Returns for each region of the mesh the numbers of the axes that may pass through its tetrahedra,
    /// ascending: all that do, and some that do not.
    const CompressedRows<std::uint32_t>& passing() const;

    /// Adds the tetrahedra on the other side of faces that belong to one tetrahedron only, and rebuilds the
    /// mesh, which changes its numbering. Returns false if there are no tetrahedra to add.
    bool grow(std::span<const TetraFace> faces, const Context& ctx = {});

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Returns the segments of the nodes that are not roots, in order, and a ball for each tree of one node.
std::vector<Segment> segment_axes(const Skeleton& skeleton);

}  // namespace coppice
