#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/pipeline/repair/row_kernels_internal.h"
#include "coppice/pipeline/repair/tube_quads_internal.h"

namespace coppice::pipeline_internal {

/// Bound of the rounding error of an area of points at most 1 away, in double precision.
inline constexpr double kTurnRounding = 1e-13;

/// The section of a tube that faces away from a point at one of its ends.
struct View {
    /// Number of rows from that end, followed by the cap of the tube, or by a ring that runs once around the
    /// directions it encloses: a disc, star-shaped around its middle.
    std::uint32_t clear = 0;
    /// Whether all later rows are within the directions that this ring encloses.
    bool is_apart = false;
    /// [m] minimum distance of all later rows behind c, towards the other node; if is_apart is false.
    double behind = 0;
};

/// The refined points of one tube; reused for the next one.
class TubePoints {
  public:
    TubePoints(const QuadMesh& mesh, const TubeRows& tube_rows) : mesh_(&mesh), tube_rows_(&tube_rows) {}

    /// Loads the points of a tube.
    void load(const TubeFaces& faces);

    bool has_sides() const { return has_sides_; }                  ///< false for the ball of a single node
    const RowPoints& sides() const { return sides_; }              ///< one row of points per tube row
    std::uint32_t rows() const { return tube_rows_->per_tube(); }  ///< number of rows
    /// Returns whether quads close the tube at its beginning (0) or its end (1).
    bool is_closed(int end) const { return faces_.cap[end].count > 0; }
    /// Returns whether the quads between the tubes at a branch node there belong to this tube.
    bool has_fork(int end) const { return faces_.fork[end].count > 0; }

    /// Returns the extent of each row, including the quads beyond the outermost ones.
    void reach(const Directions& directions, std::vector<Reach>& out) const;

    /// Adds the refined quads of a row that overlap another extent; touching counts, and so does a distance
    /// of at most `margin`.
    void collect(std::uint32_t row, const Directions& directions, const Reach& other, const Margins& margin,
                 std::vector<std::uint32_t>& out) const;

    /// Returns its bounds, including the distance from the segment from a along the unit direction d.
    Bounds bounds(Vec3d a, Vec3d d, double length) const;

    /// Returns the view of a node at c from an end (0: the beginning) inward; the other node is in the
    /// direction d. `size` is a bound of the distance from c.
    View view(int end, Vec3d c, Vec3d d, double size) const;
    /// Returns the range of rows first .. second around the first ring of row `row` that face away from a
    /// point c within it, without caps, and end in rings that run around once; empty if they are not on both
    /// sides of it.
    std::array<std::uint32_t, 2> clear_about(std::uint32_t row, Vec3d c, double size) const;
    /// Returns whether the quads beyond an end face away from c.
    bool is_clear_beyond(int end, Vec3d c, double size) const;
    /// Returns whether a tube closed at both ends faces away from c everywhere.
    bool is_star(Vec3d c, double size) const;

    /// Counts for each cage vertex of the ring at an end how often quads of the tube, around the vertex as
    /// seen from c, pass a plane that is the same for all tubes there. `visit(k, turns)` gets the index of
    /// the cage quad among the sides, and -1 if the count is not certain.
    template <class Visit>
    void visit_turns(int end, Vec3d c, double size, const Visit& visit) const;
    /// The same for the quads between the tubes at a branch node, by corner: `visit(cage_quad, corner,
    /// turns)`.
    template <class Visit>
    void visit_fork_turns(int end, Vec3d c, double size, const Visit& visit) const;

    /// Returns the mean of the first ring of row `row`.
    Vec3d ring_center(std::size_t row) const;

  private:
    // Visits the points of rows from index `row` on, counted from an end, and of the cap.
    template <class Visit>
    void visit_rest(int end, std::uint32_t row, const Visit& visit) const;
    // A ring seen from a point: whether its directions are star-shaped around its centre, the direction of
    // the centre, and the square of the tangent of the maximum angle from there that the ring encloses all
    // around.
    struct Opening {
        bool is_simple;
        Vec3d axis;
        double tangent_squared;
    };
    Opening opening(std::size_t row, Vec3d c, double sense, double size) const;
    double behind(int end, std::uint32_t clear, Vec3d c, Vec3d d) const;
    bool is_within(int end, std::uint32_t clear, Vec3d c, const Opening& ring) const;
    void load_patch(RowPoints& out, std::uint32_t cage_quad, std::size_t column) const;

    const QuadMesh* mesh_;
    const TubeRows* tube_rows_;
    TubeFaces faces_;
    bool has_sides_ = false;
    RowPoints sides_;
    std::array<std::vector<RowPoints>, 2> beyond_;  // by end: a patch for each cage quad beyond it
    std::array<std::size_t, 2> count_{};            // number of these patches
    mutable std::vector<std::int32_t> turns_;
};

/// Sides of a plane through x and c, the same for all callers, on which edges of x are: the distances of
/// their ends, and whether these are certain.
template <std::size_t N>
struct Sides {
    std::array<double, N> at;
    bool is_certain;

    Sides(Vec3d x, Vec3d c, double size, const std::array<Vec3d, N>& ends) : at(), is_certain(true) {
        constexpr Vec3d kAside{0.3713906763541037, 0.5570860145311556, 0.7427813527082074};
        const Vec3d plane = cross(x - c, kAside);
        for (std::size_t i = 0; i < N; ++i) {
            at[i] = dot(ends[i] - x, plane);
            is_certain &= std::fabs(at[i]) > kTurnRounding * size * size;
        }
    }
    /// Returns whether the step from one edge to the next passes the plane forward.
    int passes(std::size_t from) const { return at[from] < 0 && at[from + 1] >= 0 ? 1 : 0; }
};

template <class Visit>
void TubePoints::visit_fork_turns(int end, Vec3d c, double size, const Visit& visit) const {
    const std::size_t n = rows();
    constexpr std::array<std::array<int, 2>, 4> kCorner{{{0, 0}, {0, 1}, {1, 1}, {1, 0}}};  // row and column
    for (std::size_t f = 0; has_fork(end) && f < count_[end]; ++f) {
        const RowPoints& patch = beyond_[end][f];
        const auto at = [&](std::size_t j, std::size_t i) {
            const std::size_t k = j * patch.stride() + i;
            return Vec3d{patch.x[k], patch.y[k], patch.z[k]};
        };
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t j = kCorner[k][0] == 0 ? 0 : n, i = kCorner[k][1] == 0 ? 0 : n;
            const std::size_t inner_j = j == 0 ? 1 : n - 1, inner_i = i == 0 ? 1 : n - 1;
            const Vec3d across = at(j, inner_i), along = at(inner_j, i);
            // From the edge to the next corner to the edge to the previous one.
            const bool is_even = k % 2 == 0;
            const Sides<2> sides(at(j, i), c, size, {is_even ? across : along, is_even ? along : across});
            visit(faces_.fork[end].first + f, k, sides.is_certain ? sides.passes(0) : -1);
        }
    }
}

template <class Visit>
void TubePoints::visit_turns(int end, Vec3d c, double size, const Visit& visit) const {
    const std::size_t n = rows(), around = sides_.columns;
    const std::size_t row = end == 0 ? 0 : n, inner = end == 0 ? 1 : n - 1;
    const auto at = [&](std::size_t j, std::size_t k) {
        const std::size_t i = j * sides_.stride() + k;
        return Vec3d{sides_.x[i], sides_.y[i], sides_.z[i]};
    };
    for (std::size_t k = 0; k < around; k += n) {
        const Vec3d after = at(row, k + 1), before = at(row, k == 0 ? around - 1 : k - 1);
        const Sides<3> sides(at(row, k), c, size,
                             {end == 0 ? after : before, at(inner, k), end == 0 ? before : after});
        visit(k / n, sides.is_certain ? sides.passes(0) + sides.passes(1) : -1);
    }
}

}  // namespace coppice::pipeline_internal
