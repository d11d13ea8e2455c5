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

/// A box of the grid cut into tetrahedra whose corners are weighted points: the regular triangulation, which
/// is Delaunay's where all weights are alike [Edelsbrunner1996]. Point by point, the tetrahedra in conflict
/// with it make way for those between it and the hull of these [Bowyer1981].
///
/// All signs are exact, and a point is refused rather than made part of a tetrahedron without volume: so
/// whatever the points are, the tetrahedra fill the box, share whole faces, and have positive volumes.
class RegularTriangulation {
  public:
    static constexpr std::uint32_t kNoCell = 0xffffffffu;  ///< beyond the box
    /// Corners in positive order, and the cells across the faces opposite them.
    struct Cell {
        std::array<std::uint32_t, 4> vertex;
        std::array<std::uint32_t, 4> next;
        bool is_dead() const { return vertex[0] == kNoCell; }  ///< made way for others
    };

    /// The box from low to high, of which the eight corners are the first vertices; low < high.
    RegularTriangulation(const GridPlace& low, const GridPlace& high);

    /// Adds points within the box, once, in an order of its own. What has no place is left out: a point too
    /// near another one, and one whose weight is too small beside its neighbours'. O(n log n) but for
    /// contrived ones. Throws Cancelled on a stop.
    void insert(std::span<const WeightedPlace> points, const Context& ctx);

    std::span<const Cell> cells() const { return cells_; }                 ///< some of them dead
    const WeightedPlace& vertex(std::uint32_t v) const { return at_[v]; }  ///< a corner of cells
    /// Which of the points that were inserted a vertex is; kNoCell for a corner of the box.
    std::uint32_t point(std::uint32_t v) const { return point_[v]; }
    std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(at_.size()); }  ///< tried too
    /// A cell in or on whose border p lies, which is in the box; looked for from another one on.
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
    std::vector<std::uint32_t> taken_;  ///< cells in conflict with the present point
    std::vector<HullFace> hull_;        ///< their faces towards others
    std::uint32_t stamp_ = 0, last_ = 0;
};

}  // namespace coppice::tetra_internal
