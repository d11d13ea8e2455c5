#pragma once

#include <array>
#include <cstdint>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/tetra/lattice/octree_internal.h"

namespace coppice {

/// A smallest face between two leaves, handled by the smaller one, or of two alike by the lower one.
struct LatticeFace {
    std::uint32_t leaf = kNone, other = kNone;
    unsigned direction = 0;  ///< x, y, z up, then x, y, z down
    bool up() const {
        return direction < 3;
    }  ///< the way from leaf to other is along an axis, not against it
    /// Vertices of the border, counter-clockwise about the axis: corners at even places, and between them the
    /// middles of edges that smaller leaves halve, kNone where there is none.
    std::array<std::uint32_t, 8> border{};
};

/// All tetrahedra of an octree. Its vertices are the centers and corners of the leaves; each face between two
/// leaves has a tetrahedron for every edge of its border, between the centers. A tetrahedron is named by the
/// leaf that handles its face, and a slot: 8 times the direction (x, y, z up, then x, y, z down) and the
/// place in the border where its edge starts.
class LatticeCells {
  public:
    static constexpr unsigned kSlots = 48;

    LatticeCells(Octree octree, const Context& ctx);

    const Octree& octree() const { return octree_; }
    std::uint32_t leaf_count() const { return octree_.leaf_count(); }
    std::uint32_t vertex_count() const { return vertex_count_; }
    std::uint32_t center(std::uint32_t leaf) const { return first_vertex_[leaf]; }
    std::uint32_t corner(std::uint32_t leaf, unsigned c) const { return corner_[8 * std::size_t{leaf} + c]; }

    /// The leaf on the other side of the face in a direction; kNone when `leaf` does not handle that face.
    std::uint32_t other(std::uint32_t leaf, unsigned direction) const {
        const Octree::Neighbor there = octree_.neighbor(octree_.node_of_leaf(leaf), face_step(direction));
        if (there.node == kNone || !octree_.is_leaf(there.node) || (!there.larger && direction >= 3))
            return kNone;
        return octree_.leaf(there.node);
    }

    /// The face in a direction; the leaf must handle it.
    LatticeFace face(std::uint32_t leaf, unsigned direction) const;

    /// Vertices of the tetrahedron at a place of a border, positively oriented: centers of `leaf` and
    /// `other`, then the edge. False when no edge starts there.
    bool tetra(const LatticeFace& face, unsigned place, std::array<std::uint32_t, 4>& out) const {
        if (face.border[place] == kNone) return false;
        const std::uint32_t from = face.border[place], to = face.border[next_place(face, place)];
        out = {center(face.leaf), center(face.other), face.up() ? from : to, face.up() ? to : from};
        return true;
    }

    /// Calls visit(face) for the faces that a leaf handles, by direction, those for which want(other) holds.
    template <class Want, class Visit>
    void visit_faces(std::uint32_t leaf, const Want& want, const Visit& visit) const {
        for (unsigned direction = 0; direction < 6; ++direction) {
            const std::uint32_t beyond = other(leaf, direction);
            if (beyond != kNone && want(beyond)) visit(face(leaf, direction));
        }
    }

    /// Calls visit(vertex, coordinates) for the vertices that a leaf numbers: its center, then some corners.
    template <class Visit>
    void visit_vertices(std::uint32_t leaf, const Visit& visit) const {
        const Octree::Cell cell = octree_.cell(leaf);
        std::uint32_t vertex = first_vertex_[leaf];
        visit(vertex++, middle(cell));
        for (unsigned c = 0; c < 8; ++c) {
            if ((owned_[leaf] >> c & 1) != 0) visit(vertex++, place(cell, c));
        }
    }

    /// The tetrahedron on the other side of the face opposite vertex `opposite` of a tetrahedron.
    struct Name {
        std::uint32_t leaf = kNone;
        unsigned slot = 0;
    };
    Name across(Name tetra, unsigned opposite) const;

    using Place = std::array<std::uint32_t, 3>;  ///< coordinates

    /// The corners of the border, in its order; `cell` is that of face.leaf.
    static std::array<Place, 4> square(const LatticeFace& face, const Octree::Cell& cell);

    /// Where in a border the edge ends that starts at a place of it.
    static unsigned next_place(const LatticeFace& face, unsigned place) {
        return (face.border[(place + 1) % 8] != kNone ? place + 1 : place + 2) % 8;
    }

    static Place middle(const Octree::Cell& cell) {
        const std::uint32_t half = cell.side / 2;
        return {cell.low[0] + half, cell.low[1] + half, cell.low[2] + half};
    }
    static Place place(const Octree::Cell& cell, unsigned corner) {
        return {cell.low[0] + (corner & 1) * cell.side, cell.low[1] + (corner >> 1 & 1) * cell.side,
                cell.low[2] + (corner >> 2 & 1) * cell.side};
    }

  private:
    /// Eight times a leaf plus one of its corners.
    using Corner = std::uint32_t;

    static constexpr unsigned face_step(unsigned direction) {
        constexpr std::array<unsigned, 6> kStep{14, 16, 22, 12, 10, 4};
        return kStep[direction];
    }
    Corner owner(std::uint32_t leaf, unsigned corner) const;
    Name around_edge(Name tetra, unsigned opposite) const;
    Name along_border(Name tetra, const LatticeFace& face, bool at_end) const;

    Octree octree_;
    std::uint32_t vertex_count_ = 0;
    Buffer<std::uint32_t> first_vertex_;  ///< per leaf
    Buffer<std::uint8_t> owned_;          ///< per leaf: corners that it numbers
    Buffer<std::uint32_t> corner_;        ///< eight per leaf
};

}  // namespace coppice
