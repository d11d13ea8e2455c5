#include <bit>
#include <utility>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/tetra/lattice/cells_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kCellsGrain = 1 << 11;

/// Codes of steps along an axis: kStep[axis] is added to code 13 for a step up.
constexpr std::array<int, 3> kStep{1, 3, 9};

constexpr unsigned step(int code) { return static_cast<unsigned>(13 + code); }

constexpr unsigned bit(unsigned axis, bool up) { return up ? 1u << axis : 0; }

/// Corners of a square, counter-clockwise: whether they are up along the first and the second axis.
constexpr std::array<std::array<bool, 2>, 4> kSquare{
    {{false, false}, {true, false}, {true, true}, {false, true}}};

/// The edge of a square from corner j to the next: low or up along the axis that it does not follow.
struct SquareEdge {
    bool along_u;  ///< follows the first axis, else the second
    bool up;       ///< along the other axis
};
constexpr std::array<SquareEdge, 4> kSquareEdge{{{true, false}, {false, true}, {true, true}, {false, false}}};

}  // namespace

LatticeCells::LatticeCells(Octree octree, const Context& ctx) : octree_(std::move(octree)) {
    const std::size_t leaves = octree_.leaf_count();
    corner_.resize(8 * leaves);
    owned_.resize(leaves);
    first_vertex_.resize(leaves);
    parallel_for(ctx, leaves, kCellsGrain, [&](std::size_t i) {
        const auto leaf = static_cast<std::uint32_t>(i);
        unsigned owned = 0;
        for (unsigned c = 0; c < 8; ++c) {
            corner_[8 * i + c] = owner(leaf, c);
            if (corner_[8 * i + c] == 8 * leaf + c) owned |= 1u << c;
        }
        owned_[i] = static_cast<std::uint8_t>(owned);
        first_vertex_[i] = 1 + static_cast<std::uint32_t>(std::popcount(owned));
    });
    vertex_count_ = exclusive_scan<std::uint32_t>(first_vertex_);
    parallel_for(ctx, 8 * leaves, 8 * kCellsGrain, [&](std::size_t i) {
        const Corner corner = corner_[i];
        const unsigned before = owned_[corner / 8] & ((1u << corner % 8) - 1);
        corner_[i] = first_vertex_[corner / 8] + 1 + static_cast<std::uint32_t>(std::popcount(before));
    });
}

/// Returns the owner of a corner: among the eight octants around it, upper ones first, the first with a leaf
/// that also has this corner. The result is the same for all leaves that share the corner; the first octant
/// nearly always succeeds.
LatticeCells::Corner LatticeCells::owner(std::uint32_t leaf, unsigned corner) const {
    const std::uint32_t node = octree_.node_of_leaf(leaf);
    const unsigned here = ~corner & 7;
    for (unsigned octant = 7; octant != here; --octant) {
        const unsigned its_corner = ~octant & 7;
        int way = 0;
        for (unsigned axis = 0; axis < 3; ++axis)
            way += kStep[axis] * (static_cast<int>(octant >> axis & 1) - static_cast<int>(here >> axis & 1));
        const Octree::Neighbor n = octree_.neighbor(node, step(way));
        if (n.node == kNoIndex || (n.larger && n.octant != its_corner)) continue;
        const std::uint32_t owner = octree_.is_leaf(n.node) ? n.node : octree_.child(n.node, its_corner);
        return 8 * octree_.leaf(owner) + its_corner;
    }
    return 8 * leaf + corner;
}

LatticeFace LatticeCells::face(std::uint32_t leaf, unsigned direction) const {
    const unsigned axis = direction % 3, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const bool up = direction < 3;
    const std::uint32_t node = octree_.node_of_leaf(leaf);
    const int across = up ? kStep[axis] : -kStep[axis];
    const Octree::Neighbor there = octree_.neighbor(node, step(across));
    LatticeFace out;
    out.leaf = leaf;
    out.other = octree_.leaf(there.node);
    out.direction = direction;
    for (unsigned j = 0; j < 4; ++j) {
        const auto [up_u, up_v] = kSquare[j];
        out.border[2 * j] = corner(leaf, bit(axis, up) | bit(u, up_u) | bit(v, up_v));
        out.border[2 * j + 1] = kNoIndex;
        // The edges of a larger leaf's neighbour are not halved: smaller cells there would be adjacent to
        // that leaf.
        if (there.larger) continue;
        const auto [along_u, edge_up] = kSquareEdge[j];
        const int out_of_face = (edge_up ? 1 : -1) * kStep[along_u ? v : u];
        for (const int way : {out_of_face, out_of_face + across}) {
            const Octree::Neighbor n = octree_.neighbor(node, step(way));
            if (n.node == kNoIndex || n.larger || octree_.is_leaf(n.node)) continue;
            // The child at the lower end of the edge has the midpoint as its corner at the upper end of the
            // edge.
            const unsigned at = bit(axis, (way == out_of_face) == up) | bit(along_u ? v : u, !edge_up);
            const std::uint32_t child = octree_.leaf(octree_.child(n.node, at));
            out.border[2 * j + 1] = corner(child, at | bit(along_u ? u : v, true));
            break;
        }
    }
    return out;
}

std::array<LatticeCells::Place, 4> LatticeCells::square(const LatticeFace& face, const Octree::Cell& cell) {
    const unsigned axis = face.direction % 3, u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::array<Place, 4> out;
    for (std::size_t j = 0; j < 4; ++j)
        out[j] = place(cell, bit(axis, face.up()) | bit(u, kSquare[j][0]) | bit(v, kSquare[j][1]));
    return out;
}

LatticeCells::Name LatticeCells::across(Name tetra, unsigned opposite) const {
    if (opposite < 2) return around_edge(tetra, opposite);
    const LatticeFace f = face(tetra.leaf, tetra.slot / 8);
    return along_border(tetra, f, (opposite == 2) == f.up());
}

/// Returns the next tetrahedron of the same face, at the end or at the start of this one's edge.
LatticeCells::Name LatticeCells::along_border(Name tetra, const LatticeFace& face, bool at_end) const {
    unsigned place = tetra.slot % 8;
    do {
        place = (place + (at_end ? 1 : 7)) % 8;
    } while (face.border[place] == kNoIndex);
    return {tetra.leaf, tetra.slot / 8 * 8 + place};
}

/// Returns the next tetrahedron around an edge, beyond the center that is kept. The leaves around an edge
/// form a ring, and each two consecutive leaves have a tetrahedron between them.
LatticeCells::Name LatticeCells::around_edge(Name tetra, unsigned opposite) const {
    const unsigned direction = tetra.slot / 8, place = tetra.slot % 8;
    const LatticeFace f = face(tetra.leaf, direction);
    const unsigned axis = direction % 3;
    const auto [along_u, edge_up] = kSquareEdge[place / 2];
    const unsigned along = (axis + (along_u ? 1 : 2)) % 3, out_of_face = (axis + (along_u ? 2 : 1)) % 3;
    // The midpoint and the length of the edge.
    const Octree::Cell cell = octree_.cell(tetra.leaf);
    const bool halved = f.border[place / 2 * 2 + 1] != kNoIndex;
    const std::uint32_t edge_length = halved ? cell.side / 2 : cell.side;
    // The last two edges of the square point downwards.
    const bool upper_half = halved && (place % 2 == 1) == (place < 4);
    std::array<std::uint32_t, 3> middle = cell.low;
    middle[axis] += f.up() ? cell.side : 0;
    middle[out_of_face] += edge_up ? cell.side : 0;
    middle[along] += edge_length / 2 + (upper_half ? edge_length : 0);

    // Leaves in the quadrants around the edge, by the two axes that follow the edge's axis.
    const unsigned u = (along + 1) % 3, v = (along + 2) % 3;
    std::array<std::uint32_t, 4> ring{};
    for (std::size_t q = 0; q < 4; ++q) {
        std::array<std::uint32_t, 3> point = middle;
        point[u] = kSquare[q][0] ? middle[u] : middle[u] - 1;
        point[v] = kSquare[q][1] ? middle[v] : middle[v] - 1;
        ring[q] = point[u] < Octree::kSide && point[v] < Octree::kSide ? octree_.leaf_at(point) : kNoIndex;
    }
    const std::uint32_t from = opposite == 0 ? f.leaf : f.other, kept = opposite == 0 ? f.other : f.leaf;
    std::size_t at = 0;
    while (ring[at] != kept) ++at;
    const std::size_t turn = [&] {
        std::size_t next = at;
        while (ring[next] == kept) next = (next + 1) % 4;
        return ring[next] == from ? std::size_t{3} : std::size_t{1};
    }();
    // Starts at the first quadrant of the kept leaf and turns away from the other.
    std::size_t last = at;
    while (ring[(last + turn) % 4] == kept) last = (last + turn) % 4;
    const std::uint32_t next = ring[(last + turn) % 4];
    if (next == kNoIndex) return {};

    const Octree::Cell a = octree_.cell(kept), b = octree_.cell(next);
    const std::size_t to = (last + turn) % 4;
    const unsigned new_axis = kSquare[last][0] != kSquare[to][0] ? u : v, other_axis = new_axis == u ? v : u;
    const bool next_is_up = kSquare[to][new_axis == u ? 0 : 1];
    const bool kept_handles = a.side < b.side || (a.side == b.side && next_is_up);
    Name out;
    out.leaf = kept_handles ? kept : next;
    const Octree::Cell& own = kept_handles ? a : b;
    const bool up = kept_handles == next_is_up;
    // The position of the edge in the square of the face.
    const bool new_along_u = along == (new_axis + 1) % 3, new_up = middle[other_axis] != own.low[other_axis];
    unsigned j = 0;
    while (kSquareEdge[j].along_u != new_along_u || kSquareEdge[j].up != new_up) ++j;
    const bool second = edge_length < own.side && (middle[along] - own.low[along] > own.side / 2) == (j < 2);
    out.slot = 8 * (new_axis + (up ? 0 : 3)) + 2 * j + (second ? 1 : 0);
    return out;
}

}  // namespace coppice
