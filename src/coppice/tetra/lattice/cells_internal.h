#pragma once

#include <array>
#include <cstdint>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/tetra/lattice/octree_internal.h"

namespace coppice {

/// A minimal face between two leaves, owned by the smaller leaf, or by the lower one if both have the same
/// size.
struct LatticeFace {
    std::uint32_t leaf = kNoIndex, other = kNoIndex;
    unsigned direction = 0;                    ///< x, y, z up, then x, y, z down
    bool up() const { return direction < 3; }  ///< whether `other` is above `leaf` along the axis
    /// Vertices of the border, counter-clockwise around the axis: corners at even indices, and between them
    /// the midpoints of edges that smaller leaves halve, kNoIndex if there is no midpoint.
    std::array<std::uint32_t, 8> border{};
};

/// All tetrahedra of an octree. The vertices are the centers and corners of the leaves; each face between two
/// leaves has a tetrahedron for every edge of its border, between the two centers. A tetrahedron is
/// identified by the leaf that owns its face, and a slot: 8 times the direction (x, y, z up, then x, y, z
/// down) plus the index in the border at which its edge starts.
class LatticeCells {
  public:
    static constexpr unsigned kSlots = 48;

    LatticeCells(Octree octree, const Context& ctx);

    const Octree& octree() const { return octree_; }
    std::uint32_t leaf_count() const { return octree_.leaf_count(); }
    std::uint32_t vertex_count() const { return vertex_count_; }
    std::uint32_t center(std::uint32_t leaf) const { return first_vertex_[leaf]; }
    std::uint32_t corner(std::uint32_t leaf, unsigned c) const { return corner_[8 * std::size_t{leaf} + c]; }

    /// Returns the leaf on the other side of the face in a direction; kNoIndex if `leaf` does not own that
    /// face.
    std::uint32_t other(std::uint32_t leaf, unsigned direction) const {
        const Octree::Neighbor there = octree_.neighbor(octree_.node_of_leaf(leaf), face_step(direction));
        if (there.node == kNoIndex || !octree_.is_leaf(there.node) || (!there.larger && direction >= 3))
            return kNoIndex;
        return octree_.leaf(there.node);
    }

    /// Returns the face in a direction; the leaf must own it.
    LatticeFace face(std::uint32_t leaf, unsigned direction) const;

    /// Computes the vertices of the tetrahedron at an index of a border, positively oriented: centers of
    /// `leaf` and `other`, then the edge. Returns false if no edge starts there.
    bool tetra(const LatticeFace& face, unsigned place, std::array<std::uint32_t, 4>& out) const {
        if (face.border[place] == kNoIndex) return false;
        const std::uint32_t from = face.border[place], to = face.border[next_place(face, place)];
        out = {center(face.leaf), center(face.other), face.up() ? from : to, face.up() ? to : from};
        return true;
    }

    /// Calls visit(face) for the faces that a leaf owns and that satisfy want(other), by direction.
    template <class Want, class Visit>
    void visit_faces(std::uint32_t leaf, const Want& want, const Visit& visit) const {
        for (unsigned direction = 0; direction < 6; ++direction) {
            const std::uint32_t beyond = other(leaf, direction);
            if (beyond != kNoIndex && want(beyond)) visit(face(leaf, direction));
        }
    }

    /// Calls visit(vertex, coordinates) for the vertices that a leaf numbers: its center, then its owned
    /// corners.
    template <class Visit>
    void visit_vertices(std::uint32_t leaf, const Visit& visit) const {
        const Octree::Cell cell = octree_.cell(leaf);
        std::uint32_t vertex = first_vertex_[leaf];
        visit(vertex++, middle(cell));
        for (unsigned c = 0; c < 8; ++c) {
            if ((owned_[leaf] >> c & 1) != 0) visit(vertex++, place(cell, c));
        }
    }

    /// Identifies a tetrahedron. `across` returns the tetrahedron on the other side of the face opposite
    /// vertex `opposite`.
    struct Name {
        std::uint32_t leaf = kNoIndex;
        unsigned slot = 0;
    };
    Name across(Name tetra, unsigned opposite) const;

    using Place = std::array<std::uint32_t, 3>;  ///< coordinates

    /// Returns the corners of the border, in order; `cell` is the cell of face.leaf.
    static std::array<Place, 4> square(const LatticeFace& face, const Octree::Cell& cell);

    /// Returns the index in a border at which the edge ends that starts at index `place`.
    static unsigned next_place(const LatticeFace& face, unsigned place) {
        return (face.border[(place + 1) % 8] != kNoIndex ? place + 1 : place + 2) % 8;
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
