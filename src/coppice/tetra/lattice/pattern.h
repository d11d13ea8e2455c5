#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace coppice {

/// Subdivision of one tetrahedron with corners 0, 1, 2, 3 into 8^levels, equal for all that share a diagonal.
///
/// Its fine vertices are the points with four weights, in units of 1/n with n = 2^levels, that are integers.
/// A fine vertex or fine edge is inside a corner, an edge, a face or the tetrahedron: its group. Groups 0 to
/// 3 are the corners, 4 to 9 the edges 01, 02, 03, 12, 13, 23, 10 to 13 the faces opposite 0, 1, 2, 3, and 14
/// is the interior. Vertices and edges are sorted by group, and within a group by the weights of the group's
/// corners in ascending order: two tetrahedra that list the corners of a shared face in the same order list
/// its elements in the same order.
struct TetraPattern {
    static constexpr std::uint32_t kGroups = 15;  ///< number of groups
    static constexpr std::uint32_t kInside = 14;  ///< the last group
    static constexpr int kMaxLevels = 5;          ///< n = 32

    using Local = std::uint16_t;                       ///< a fine vertex or edge of one tetrahedron
    std::vector<std::array<std::uint8_t, 4>> weights;  ///< of every fine vertex; they add up to n
    std::vector<std::array<float, 4>> shares;          ///< weights divided by n
    std::vector<std::uint8_t> group;                   ///< of every fine vertex
    /// Group g has the fine vertices first_vertex[g] .. first_vertex[g + 1].
    std::array<std::uint32_t, kGroups + 1> first_vertex;
    std::vector<std::array<Local, 4>> tetra;  ///< oriented as 0, 1, 2, 3
    std::vector<std::uint64_t> tetra_masks;   ///< the vertices of each as bits, if 64 bits suffice for all
    std::vector<std::array<Local, 2>> edges;  ///< fine edges, by group
    std::vector<std::uint8_t> edge_group;     ///< of every fine edge
    std::array<std::uint32_t, kGroups + 1> first_edge;  ///< as first_vertex
    std::vector<std::array<Local, 6>> tetra_edges;      ///< 01, 02, 03, 12, 13, 23 of every fine tetrahedron
    std::vector<std::uint32_t> first_around;            ///< vertex v has around[first_around[v]] ...
    std::vector<Local> around;                          ///< the fine tetrahedra that contain it

    /// Returns the fine tetrahedra that contain a fine vertex.
    std::span<const Local> tetra_around(std::uint32_t vertex) const {
        return std::span(around).subspan(first_around[vertex],
                                         first_around[vertex + 1] - first_around[vertex]);
    }
};

/// The two ends of edge 01, 02, 03, 12, 13, 23.
inline constexpr std::array<std::array<std::uint8_t, 2>, 6> kTetraEdges{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

/// The corners of the three diagonals of the octahedron in the middle of a tetrahedron: from the midpoint of
/// the edge between the first two to the midpoint of the edge between the other two.
inline constexpr std::array<std::array<std::uint8_t, 4>, 3> kTetraDiagonals{
    {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}}};

/// Creates the pattern that cuts every octahedron along the given diagonal: edges have only seven directions
/// on any level, this is the triangulation of Freudenthal [Freudenthal1942] under an affine map, and fine
/// tetrahedra have three shapes and their point reflections. `levels` from 0 to kMaxLevels.
TetraPattern tetra_pattern(int levels, std::uint32_t diagonal);

}  // namespace coppice
