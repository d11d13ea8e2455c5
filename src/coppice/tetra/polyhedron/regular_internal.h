#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/tetra/polyhedron/exact_internal.h"

namespace coppice::tetra_internal {

/// The regular triangulation of weighted points in a box of the grid, which equals the Delaunay triangulation
/// if all weights are equal [Edelsbrunner1996]. Points are inserted incrementally: the tetrahedra in conflict
/// with a point are replaced by those between the point and the hull of the removed ones [Bowyer1981].
///
/// All signs are exact, and a point that would create a tetrahedron without volume is rejected: for any input
/// the tetrahedra fill the box, share whole faces, and have positive volumes.
class RegularTriangulation {
  public:
    /// Corners in positive order, and the cells across the faces opposite them.
    struct Cell {
        std::array<std::uint32_t, 4> vertex;
        std::array<std::uint32_t, 4> next;
        bool is_dead() const { return vertex[0] == kNoIndex; }  ///< replaced by other cells
    };

    /// Creates the box from low to high; its eight corners are the first vertices. Requires low < high.
    RegularTriangulation(const GridPlace& low, const GridPlace& high);

    /// Inserts points within the box, in an order of its own; may be called once. Omits a point that is too
    /// close to another one or has a weight too small compared with its neighbours. O(n log n) except for
    /// adversarial input. Throws Cancelled if cancelled.
    void insert(std::span<const WeightedPlace> points, const Context& ctx);

    std::span<const Cell> cells() const { return cells_; }                 ///< some of them dead
    const WeightedPlace& vertex(std::uint32_t v) const { return at_[v]; }  ///< a corner of cells
    /// Returns the index of the inserted point at a vertex; kNoIndex for a corner of the box.
    std::uint32_t point(std::uint32_t v) const { return point_[v]; }
    std::uint32_t vertex_count() const {
        return static_cast<std::uint32_t>(at_.size());
    }  ///< includes rejected points
    /// Returns a cell that contains p, which must be in the box, in its interior or on its boundary. Walks
    /// from cell `from`.
    std::uint32_t locate(const GridPlace& p, std::uint32_t from) const;
    std::uint32_t some_cell() const { return last_; }  ///< one that is alive

  private:
    struct HullFace {
        std::uint32_t cell, face;
    };

    bool insert(const WeightedPlace& p, std::uint32_t number);
    bool find_conflicts(std::uint32_t start, const WeightedPlace& p);
    bool is_crowded(const WeightedPlace& p) const;
    void fill(std::uint32_t vertex);
    std::uint32_t new_cell();
    std::uint32_t across_edge(const HullFace& from, std::uint32_t third) const;
    bool is_taken(std::uint32_t cell) const { return mark_[cell] == stamp_; }
    int side(const Cell& cell, std::size_t face, const GridPlace& p) const;

    std::vector<WeightedPlace> at_;
    std::vector<std::uint32_t> point_;
    Buffer<Cell> cells_;
    std::vector<std::uint32_t> mark_, free_;
    std::vector<std::uint32_t> taken_;  ///< cells in conflict with the current point
    std::vector<HullFace> hull_;        ///< their faces shared with other cells
    std::uint32_t stamp_ = 0, last_ = 0;
};

}  // namespace coppice::tetra_internal
