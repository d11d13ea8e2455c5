#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/pipeline/repair/tube_proofs_internal.h"

namespace coppice::pipeline_internal {
namespace {

// Bound of the rounding error in double precision of a volume or an area of points at most 1 away: about
// thirty operations, each with a relative error of 2^-53.
constexpr double kRounding = 1e-13;

// Reduces the opening of a cone; the error of the opening is far smaller.
constexpr double kLess = 1 - 1e-6;

// Calls visit(k) for the quads of a row that overlap another extent.
template <class Visit>
void visit_meeting(const RowPoints& points, std::size_t row, const Directions& directions, const Reach& other,
                   const Margins& margin, const Visit& visit) {
    const auto is_apart_along = [&](std::size_t i, const std::array<std::size_t, 4>& corner) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const std::size_t k : corner) {
            const double at =
                points.x[k] * directions.x[i] + points.y[k] * directions.y[i] + points.z[k] * directions.z[i];
            low = std::min(low, at);
            high = std::max(high, at);
        }
        return low > other.high[i] + margin[i] || other.low[i] > high + margin[i];
    };
    for (std::size_t k = 0; k < points.columns; ++k) {
        const std::size_t a = row * points.stride() + k, d = a + points.stride();
        bool meets = true;
        for (std::size_t i = 0; i < Directions::kCount && meets; ++i)
            meets = !is_apart_along(i, {a, a + 1, d + 1, d});
        if (meets) visit(k);
    }
}

}  // namespace

// Loads all columns except the last.
void TubePoints::load_patch(RowPoints& out, std::uint32_t cage_quad, std::size_t column) const {
    const std::size_t n = rows();
    const Quad* quad = mesh_->quads.data() + (std::size_t{cage_quad} << (2 * tube_rows_->levels()));
    const auto& x = mesh_->positions;
    for (std::size_t j = 0; j < n; ++j, quad += n) {
        for (std::size_t i = 0; i < n; ++i) out.set(j, column + i, x[quad[i][0]]);
    }
    quad -= n;
    for (std::size_t i = 0; i < n; ++i) out.set(n, column + i, x[quad[i][3]]);
}

void TubePoints::load(const TubeFaces& faces) {
    faces_ = faces;
    const std::size_t n = rows(), around = faces.side.count * n;
    has_sides_ = around > 0;
    if (has_sides_) {
        sides_.resize(n, around);
        for (std::uint32_t s = 0; s < faces.side.count; ++s) load_patch(sides_, faces.side.first + s, s * n);
        for (auto* c : {&sides_.x, &sides_.y, &sides_.z}) {
            for (std::size_t j = 0; j <= n; ++j) (*c)[j * (around + 1) + around] = (*c)[j * (around + 1)];
        }
        sides_.pad();
    }
    for (int end = 0; end < 2; ++end) {
        const CageRun& run = faces.beyond(end);
        auto& patches = beyond_[end];
        count_[end] = run.count;
        if (patches.size() < run.count) patches.resize(run.count);
        for (std::uint32_t f = 0; f < run.count; ++f) {
            RowPoints& patch = patches[f];
            patch.resize(n, n);
            load_patch(patch, run.first + f, 0);
            const Quad* quad =
                mesh_->quads.data() + (std::size_t{run.first + f} << (2 * tube_rows_->levels()));
            for (std::size_t j = 0; j < n; ++j) patch.set(j, n, mesh_->positions[quad[j * n + n - 1][1]]);
            patch.set(n, n, mesh_->positions[quad[n * n - 1][2]]);
            patch.pad();
        }
    }
}

void TubePoints::reach(const Directions& directions, std::vector<Reach>& out) const {
    out.assign(rows(), Reach());
    for (std::size_t j = 0; has_sides_ && j <= rows(); ++j) {
        Reach ring;
        extend_reach(sides_, {j * sides_.stride(), (j + 1) * sides_.stride()}, directions, ring);
        if (j < rows()) out[j].extend(ring);
        if (j > 0) out[j - 1].extend(ring);
    }
    for (int end = 0; end < 2; ++end) {
        Reach& outermost = end == 0 ? out.front() : out.back();
        for (std::size_t f = 0; f < count_[end]; ++f)
            extend_reach(beyond_[end][f], {0, beyond_[end][f].size()}, directions, outermost);
    }
}

void TubePoints::collect(std::uint32_t row, const Directions& directions, const Reach& other,
                         const Margins& margin, std::vector<std::uint32_t>& out) const {
    const std::size_t n = rows();
    const auto number = [&](std::size_t cage_quad, std::size_t j, std::size_t i) {
        return static_cast<std::uint32_t>((cage_quad * n + j) * n + i);
    };
    if (has_sides_) {
        visit_meeting(sides_, row, directions, other, margin,
                      [&](std::size_t k) { out.push_back(number(faces_.side.first + k / n, row, k % n)); });
    }
    for (int end = 0; end < 2; ++end) {
        if (row != (end == 0 ? 0 : n - 1)) continue;
        for (std::size_t f = 0; f < count_[end]; ++f) {
            for (std::size_t j = 0; j < n; ++j) {
                visit_meeting(beyond_[end][f], j, directions, other, margin, [&](std::size_t i) {
                    out.push_back(number(faces_.beyond(end).first + f, j, i));
                });
            }
        }
    }
}

Vec3d TubePoints::ring_center(std::size_t row) const {
    Vec3d sum;
    const std::size_t first = row * sides_.stride();
    for (std::size_t i = first; i < first + sides_.columns; ++i)
        sum += Vec3d{sides_.x[i], sides_.y[i], sides_.z[i]};
    return sum / static_cast<double>(sides_.columns);
}

bool TubePoints::is_clear_beyond(int end, Vec3d c, double size) const {
    const double margin = kRounding * size * size * size;
    turns_.resize(rows());
    for (std::size_t f = 0; f < count_[end]; ++f) {
        mark_rows_that_turn(beyond_[end][f], c, margin, turns_.data());
        if (std::any_of(turns_.begin(), turns_.end(), [](std::int32_t t) { return t != 0; })) return false;
    }
    return true;
}

template <class Visit>
void TubePoints::visit_rest(int end, std::uint32_t row, const Visit& visit) const {
    const auto look = [&](const RowPoints& points, std::size_t begin, std::size_t count) {
        for (std::size_t k = begin; k < begin + count; ++k)
            visit(Vec3d{points.x[k], points.y[k], points.z[k]});
    };
    look(sides_, end == 0 ? row * sides_.stride() : 0, (rows() + 1 - row) * sides_.stride());
    for (std::size_t f = 0; f < count_[1 - end]; ++f)
        look(beyond_[1 - end][f], 0, beyond_[1 - end][f].size());
}

// Returns whether all rows from index `clear` on are in the opening of the ring they begin with.
bool TubePoints::is_within(int end, std::uint32_t clear, Vec3d c, const Opening& ring) const {
    const double limit = kLess * ring.tangent_squared;
    bool within = true;
    visit_rest(end, clear + 1, [&](Vec3d x) {
        const Vec3d p = x - c;
        const double along = dot(p, ring.axis);
        within &= along > 0 && length_squared(p) - along * along < limit * (along * along);
    });
    return within;
}

double TubePoints::behind(int end, std::uint32_t clear, Vec3d c, Vec3d d) const {
    double least = std::numeric_limits<double>::infinity();
    visit_rest(end, clear, [&](Vec3d p) { least = std::min(least, dot(p - c, d)); });
    return least;
}

Bounds TubePoints::bounds(Vec3d a, Vec3d d, double length) const {
    Bounds out;
    if (has_sides_) extend_bounds(sides_, a, d, length, out);
    for (int end = 0; end < 2; ++end) {
        for (std::size_t f = 0; f < count_[end]; ++f) extend_bounds(beyond_[end][f], a, d, length, out);
    }
    return out;
}

// Returns whether a ring, closed by triangles to a point beyond its centre, is a cone that faces away from c,
// where `sense` is 1 if that point is towards the tube's end, -1 if towards its beginning: each step turns
// forward by less than half a turn, and all of them together turn once. If so, also the maximum circular cone
// inside: it is in the kernel of the disc of directions that the ring encloses, so that quads that begin at
// the ring and end in the circular cone stay in that disc.
TubePoints::Opening TubePoints::opening(std::size_t row, Vec3d c, double sense, double size) const {
    const Vec3d axis = normalized(ring_center(row) - c);
    const Vec3d u = perpendicular(axis);
    const RingTurn turn = turn_of_ring(sides_, row, c, {u, sense * cross(axis, u), axis});
    return {turn.min_area > kRounding * size * size && turn.turns == 1, axis, turn.tangent_squared};
}

View TubePoints::view(int end, Vec3d c, Vec3d d, double size) const {
    const double margin = kRounding * size * size * size;
    const std::uint32_t n = rows();
    turns_.resize(n);
    mark_rows_that_turn(sides_, c, margin, turns_.data());
    std::uint32_t clear = 0;
    while (clear < n && turns_[end == 0 ? clear : n - 1 - clear] == 0) ++clear;
    if (clear == n && is_closed(1 - end)) {
        if (is_clear_beyond(1 - end, c, size)) return {.clear = n, .is_apart = true};
        --clear;
    } else if (clear == n && has_fork(1 - end)) {
        --clear;
    }
    View best;
    for (; clear > 0; --clear) {
        const Opening ring = opening(end == 0 ? clear : n - clear, c, end == 0 ? 1 : -1, size);
        if (!ring.is_simple) continue;
        if (clear == n || is_within(end, clear, c, ring)) return {.clear = clear, .is_apart = true};
        if (best.clear == 0) best.clear = clear;
    }
    if (best.clear == 0) return best;
    best.behind = behind(end, best.clear, c, d);
    return best;
}

std::array<std::uint32_t, 2> TubePoints::clear_about(std::uint32_t row, Vec3d c, double size) const {
    turns_.resize(rows());
    mark_rows_that_turn(sides_, c, kRounding * size * size * size, turns_.data());
    std::uint32_t begin = row, end = row;
    while (begin > 0 && turns_[begin - 1] == 0) --begin;
    while (end < rows() && turns_[end] == 0) ++end;
    while (begin < row && !opening(begin, c, -1, size).is_simple) ++begin;
    while (end > row && !opening(end, c, 1, size).is_simple) --end;
    return begin < row && row < end ? std::array{begin, end} : std::array{row, row};
}

bool TubePoints::is_star(Vec3d c, double size) const {
    if (!is_clear_beyond(0, c, size) || !is_clear_beyond(1, c, size)) return false;
    if (!has_sides_) return true;
    turns_.resize(rows());
    mark_rows_that_turn(sides_, c, kRounding * size * size * size, turns_.data());
    return is_closed(0) && is_closed(1) &&
           std::all_of(turns_.begin(), turns_.end(), [](std::int32_t t) { return t == 0; });
}

}  // namespace coppice::pipeline_internal
