#include <algorithm>
#include <bit>

#include "coppice/base/id.h"
#include "coppice/base/kernel/morton.h"
#include "coppice/base/random.h"
#include "coppice/tetra/lattice/tetra_mesh.h"
#include "coppice/tetra/polyhedron/regular_internal.h"

namespace coppice::tetra_internal {
namespace {

constexpr std::size_t kPoll = 512;  ///< points between two checks for cancellation
constexpr int kTries = 6;  ///< attempts at positions nearby, if a point is in the plane of other points

/// Orders points in rounds of about twice as many points as all previous rounds together, and along a
/// space-filling curve within a round [Amenta2003]: consecutive points are close, and no cell is in conflict
/// with many of them.
std::vector<std::uint32_t> rounds(std::span<const WeightedPlace> points, const GridPlace& low) {
    struct Key {
        std::uint32_t round, point;
        std::uint64_t along;
    };
    std::vector<Key> keys(points.size());
    const CounterRandom random(0, 0x7e74a);
    for (std::uint32_t i = 0; i < keys.size(); ++i) {
        const auto cell = [&](std::size_t axis) {
            return static_cast<std::uint64_t>(points[i].at[axis] - low[axis]) >> 5;
        };
        const auto round = static_cast<std::uint32_t>(std::countr_zero(random.bits(i) | 1ull << 40));
        keys[i] = {40 - round, i, morton_code(cell(0), cell(1), cell(2))};
    }
    std::ranges::sort(keys, [](const Key& a, const Key& b) {
        if (a.round != b.round) return a.round < b.round;
        return a.along != b.along ? a.along < b.along : a.point < b.point;
    });
    std::vector<std::uint32_t> order(keys.size());
    std::ranges::transform(keys, order.begin(), &Key::point);
    return order;
}

std::size_t find_place(const std::array<std::uint32_t, 4>& four, std::uint32_t value) {
    return static_cast<std::size_t>(std::ranges::find(four, value) - four.begin());
}

}  // namespace

RegularTriangulation::RegularTriangulation(const GridPlace& low, const GridPlace& high) {
    for (unsigned c = 0; c < 8; ++c) {
        WeightedPlace& p = at_.emplace_back();
        for (unsigned axis = 0; axis < 3; ++axis) p.at[axis] = (c >> axis & 1 ? high : low)[axis];
    }
    // Six tetrahedra around the diagonal from 0 to 7, one for each order of the axes of a path along the
    // edges.
    for (const auto& [i, j] : {std::array<std::uint32_t, 2>{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}}) {
        cells_.push_back({{0, i, j, 7}, {kNoIndex, kNoIndex, kNoIndex, kNoIndex}});
        Cell& c = cells_.back();
        if (orientation(at_[0].at, at_[i].at, at_[j].at, at_[7].at) < 0) std::swap(c.vertex[1], c.vertex[2]);
    }
    for (std::uint32_t c = 0; c < 6; ++c) {
        for (const std::uint32_t other : {(c + 1) % 6, (c + 5) % 6}) {
            for (std::size_t i = 0; i < 4; ++i) {
                if (find_place(cells_[other].vertex, cells_[c].vertex[i]) == 4) cells_[c].next[i] = other;
            }
        }
    }
    mark_.assign(cells_.size(), 0);
    point_.assign(at_.size(), kNoIndex);
}

int RegularTriangulation::side(const Cell& cell, std::size_t face, const GridPlace& p) const {
    const auto& f = kTetraFaces[face];
    // Faces are oriented outward, so a point inside forms a negative volume with them.
    return -orientation(at_[cell.vertex[f[0]]].at, at_[cell.vertex[f[1]]].at, at_[cell.vertex[f[2]]].at, p);
}

std::uint32_t RegularTriangulation::locate(const GridPlace& p, std::uint32_t from) const {
    // Crosses a random one of the faces that p is beyond, so that the walk cannot cycle.
    std::uint64_t draws = mix_bits(from);
    for (std::uint32_t cell = from, before = kNoIndex;;) {
        const Cell& c = cells_[cell];
        std::uint32_t to = kNoIndex;
        draws = draws * 6364136223846793005ull + 1442695040888963407ull;
        for (std::size_t k = 0; k < 4 && to == kNoIndex; ++k) {
            const std::size_t face = (k + (draws >> 62)) % 4;
            if (c.next[face] != kNoIndex && c.next[face] != before && side(c, face, p) < 0) to = c.next[face];
        }
        if (to == kNoIndex) return cell;
        before = cell;
        cell = to;
    }
}

void RegularTriangulation::insert(std::span<const WeightedPlace> points, const Context& ctx) {
    const std::vector<std::uint32_t> order = rounds(points, at_[0].at);
    const CounterRandom random(0, 0x6a177);
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i % kPoll == 0) ctx.throw_if_cancelled();
        WeightedPlace p = points[order[i]];
        for (int t = 0; t < kTries && !insert(p, order[i]); ++t) {
            const std::uint64_t bits =
                random.bits(std::uint64_t{kTries} * order[i] + static_cast<unsigned>(t));
            for (std::size_t axis = 0; axis < 3; ++axis)
                p.at[axis] = std::clamp(p.at[axis] + static_cast<std::int32_t>(bits >> (8 * axis) & 3) - 1,
                                        at_[0].at[axis] + 1, at_[7].at[axis] - 1);
        }
    }
}

/// Returns false if a point nearby may succeed.
bool RegularTriangulation::insert(const WeightedPlace& p, std::uint32_t number) {
    last_ = locate(p.at, last_);
    const auto corner = [&](std::size_t i) { return &at_[cells_[last_].vertex[i]]; };
    if (!conflicts({corner(0), corner(1), corner(2), corner(3)}, p)) return true;
    if (!find_conflicts(last_, p)) return false;
    if (is_crowded(p)) return true;
    at_.push_back(p);
    point_.push_back(number);
    fill(static_cast<std::uint32_t>(at_.size() - 1));
    return true;
}

/// Marks the cells in conflict and lists their hull. Returns false if p does not see all of the hull.
bool RegularTriangulation::find_conflicts(std::uint32_t start, const WeightedPlace& p) {
    ++stamp_;
    taken_.assign(1, start);
    hull_.clear();
    mark_[start] = stamp_;
    for (std::size_t i = 0; i < taken_.size(); ++i) {
        const Cell& c = cells_[taken_[i]];
        for (std::uint32_t face = 0; face < 4; ++face) {
            const std::uint32_t other = c.next[face];
            if (other != kNoIndex && is_taken(other)) continue;
            if (other != kNoIndex) {
                const auto& v = cells_[other].vertex;
                if (conflicts({&at_[v[0]], &at_[v[1]], &at_[v[2]], &at_[v[3]]}, p)) {
                    mark_[other] = stamp_;
                    taken_.push_back(other);
                    continue;
                }
            }
            hull_.push_back({taken_[i], face});
        }
    }
    return std::ranges::all_of(hull_,
                               [&](const HullFace& h) { return side(cells_[h.cell], h.face, p.at) > 0; });
}

/// Returns whether a vertex is too close. For small weights the closest vertex is a corner of a cell in
/// conflict.
bool RegularTriangulation::is_crowded(const WeightedPlace& p) const {
    return std::ranges::any_of(taken_, [&](std::uint32_t cell) {
        return std::ranges::any_of(cells_[cell].vertex, [&](std::uint32_t v) {
            const double room = std::min(p.room, at_[v].room);
            return distance_squared(p.at, at_[v].at) < room * room;
        });
    });
}

std::uint32_t RegularTriangulation::new_cell() {
    if (!free_.empty()) {
        const std::uint32_t c = free_.back();
        free_.pop_back();
        return c;
    }
    cells_.push_back({});
    mark_.push_back(0);
    return static_cast<std::uint32_t>(cells_.size() - 1);
}

/// Returns the new cell adjacent to the new cell of a hull face, across the edge opposite its corner `third`.
/// Rotates around that edge through the removed cells up to the next hull face, which stores its new cell.
std::uint32_t RegularTriangulation::across_edge(const HullFace& from, std::uint32_t third) const {
    std::uint32_t cell = from.cell, pivot = third, other = cells_[cell].vertex[from.face];
    for (;;) {
        const Cell& c = cells_[cell];
        const std::uint32_t to = c.next[find_place(c.vertex, pivot)];
        if (!is_taken(to)) return to;
        // The edge, the common corner, and the new corner.
        const Cell& t = cells_[to];
        const std::size_t back = static_cast<std::size_t>(std::ranges::find(t.next, cell) - t.next.begin());
        pivot = std::exchange(other, t.vertex[back]);
        cell = to;
    }
}

/// Creates a cell between the vertex and each face of the hull.
void RegularTriangulation::fill(std::uint32_t vertex) {
    for (const HullFace& h : hull_) {
        const std::uint32_t made = new_cell();
        Cell c = cells_[h.cell];
        c.vertex[h.face] = vertex;
        cells_[made] = c;
        if (const std::uint32_t outer = c.next[h.face]; outer != kNoIndex) {
            auto& next = cells_[outer].next;
            *std::ranges::find(next, h.cell) = made;
        }
        cells_[h.cell].next[h.face] = made;
    }
    for (const HullFace& h : hull_) {
        const std::uint32_t made = cells_[h.cell].next[h.face];
        for (std::size_t i = 0; i < 4; ++i) {
            if (i != h.face) cells_[made].next[i] = across_edge(h, cells_[made].vertex[i]);
        }
        last_ = made;
    }
    for (const std::uint32_t t : taken_) {
        cells_[t].vertex[0] = kNoIndex;
        free_.push_back(t);
    }
}

}  // namespace coppice::tetra_internal
