#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/pipeline/knots/row_kernels_internal.h"
#include "coppice/pipeline/knots/tube_quads_internal.h"

namespace coppice::pipeline_internal {

/// Above the rounding of an area of points at most 1 away, in double precision.
inline constexpr double kTurnRounding = 1e-13;

/// What of a tube faces away from a point at one of its ends.
struct View {
    /// Slices from that end on, followed by what closes the tube, or by a ring that runs once around the
    /// directions it encloses: a disc, star-shaped about its middle.
    std::uint32_t clear = 0;
    /// Whether all later slices lie within the directions that this ring encloses.
    bool is_apart = false;
    /// [m] How far behind c, towards the other node, all later slices stay; where is_apart does not hold.
    double behind = 0;
};

/// The refined points of one tube; used again for the next one.
class TubePoints {
  public:
    TubePoints(const QuadMesh& mesh, const Slices& slices) : mesh_(&mesh), slices_(&slices) {}

    /// Fetches them.
    void load(const TubeFaces& faces);

    bool has_sides() const { return has_sides_; }               ///< not for the ball of a lone node
    const RowPoints& sides() const { return sides_; }           ///< one row per slice
    std::uint32_t rows() const { return slices_->per_tube(); }  ///< slices
    /// Whether quads close the tube at its beginning (0) or its end (1).
    bool is_closed(int end) const { return faces_.cap[end].count > 0; }
    /// Whether quads between the tubes at a branch node there are among its own.
    bool has_fork(int end) const { return faces_.fork[end].count > 0; }

    /// How far the slices reach, with what lies beyond the outermost: one entry per slice.
    void reach(const Directions& directions, std::vector<Reach>& out) const;

    /// Adds those refined quads of a slice that reach into what something else reaches; touching counts, and
    /// so does what is apart by no more than `margin`.
    void collect(std::uint32_t row, const Directions& directions, const Reach& other, const Margins& margin,
                 std::vector<std::uint32_t>& out) const;

    /// Where it lies, and how far from the segment from a along the unit direction d.
    Bounds bounds(Vec3d a, Vec3d d, double length) const;

    /// What a node at c can see from an end (0: the beginning) inward; the other node lies in the direction
    /// d. `size` bounds the distance from c.
    View view(int end, Vec3d c, Vec3d d, double size) const;
    /// Slices first .. second about the ring with which slice `row` begins that face away from a point c
    /// within it, without caps, and end in rings that run around once; none when these are not on both sides
    /// of it.
    std::array<std::uint32_t, 2> clear_about(std::uint32_t row, Vec3d c, double size) const;
    /// Whether what lies beyond an end faces away from c.
    bool is_clear_beyond(int end, Vec3d c, double size) const;
    /// Whether a tube closed at both ends faces away from c everywhere.
    bool is_star(Vec3d c, double size) const;

    /// Of the ring at an end, by cage vertex: how often quads of the tube, on their way around the vertex as
    /// seen from c, pass a plane that is the same for all tubes there. `visit(k, turns)` gets the number of
    /// the cage quad among the sides and -1 where that is not certain.
    template <class Visit>
    void visit_turns(int end, Vec3d c, double size, const Visit& visit) const;
    /// The same of the quads between the tubes at a branch node, by corner: `visit(cage_quad, corner,
    /// turns)`.
    template <class Visit>
    void visit_fork_turns(int end, Vec3d c, double size, const Visit& visit) const;

    /// The mean of the ring with which slice `row` begins.
    Vec3d ring_center(std::size_t row) const;

  private:
    // The points of slices from number `row` on, counted from an end, and of what closes them.
    template <class Visit>
    void visit_rest(int end, std::uint32_t row, const Visit& visit) const;
    // Of a ring seen from a point: whether its directions are star-shaped about its centre, the direction of
    // that, and the square of the tangent of the greatest angle from there that the ring encloses all around.
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
    const Slices* slices_;
    TubeFaces faces_;
    bool has_sides_ = false;
    RowPoints sides_;
    std::array<std::vector<RowPoints>, 2> beyond_;  // by end: a patch for each cage quad beyond it
    std::array<std::size_t, 2> count_{};            // of these
    mutable std::vector<std::int32_t> turns_;
};

/// On which side of a plane through x and c, the same for all that ask, edges of x lie: their ends'
/// distances, and whether those are certain.
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
    /// Whether the way from one edge to the next passes it forward.
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
            // From the edge to the next corner to that to the one before.
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
