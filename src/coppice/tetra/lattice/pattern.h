#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace coppice {

/// How one tetrahedron with corners 0, 1, 2, 3 is cut into 8^levels, the same for all that share a diagonal.
///
/// Its fine vertices are the points whose four weights, in parts of n = 2^levels, are whole numbers. A fine
/// vertex, and a fine edge, lies inside a corner, an edge, a face or the whole: its group. Groups 0 to 3 are
/// the corners, 4 to 9 the edges 01, 02, 03, 12, 13, 23, 10 to 13 the faces opposite 0, 1, 2, 3, and 14 is
/// the inside. Vertices and edges are listed group by group, within a group by the weights of the group's
/// corners in ascending order: two tetrahedra that give the corners of a shared face in the same order list
/// what lies in it in the same order.
struct TetraPattern {
    static constexpr std::uint32_t kGroups = 15;  ///< number of groups
    static constexpr std::uint32_t kInside = 14;  ///< the last group
    static constexpr int kMostLevels = 5;         ///< n = 32

    using Local = std::uint16_t;                       ///< a fine vertex or edge of one tetrahedron
    std::vector<std::array<std::uint8_t, 4>> weights;  ///< of every fine vertex; they add up to n
    std::vector<std::array<float, 4>> shares;          ///< the same, over n
    std::vector<std::uint8_t> group;                   ///< of every fine vertex
    /// Group g has the fine vertices first_vertex[g] .. first_vertex[g + 1].
    std::array<std::uint32_t, kGroups + 1> first_vertex;
    std::vector<std::array<Local, 4>> tetra;  ///< oriented as 0, 1, 2, 3
    std::vector<std::uint64_t> tetra_masks;   ///< the vertices of each as bits, where 64 are enough for all
    std::vector<std::array<Local, 2>> edges;  ///< fine ones, by group
    std::vector<std::uint8_t> edge_group;     ///< of every fine edge
    std::array<std::uint32_t, kGroups + 1> first_edge;  ///< as first_vertex
    std::vector<std::array<Local, 6>> tetra_edges;      ///< 01, 02, 03, 12, 13, 23 of every fine tetrahedron
    std::vector<std::uint32_t> first_around;            ///< vertex v has around[first_around[v]] ...
    std::vector<Local> around;                          ///< the fine tetrahedra that have it

    /// The fine tetrahedra that have a fine vertex.
    std::span<const Local> tetra_around(std::uint32_t vertex) const {
        return std::span(around).subspan(first_around[vertex],
                                         first_around[vertex + 1] - first_around[vertex]);
    }
};

/// The two ends of edge 01, 02, 03, 12, 13, 23.
inline constexpr std::array<std::array<std::uint8_t, 2>, 6> kTetraEdges{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

/// The corners of the three diagonals of the octahedron in the middle of a tetrahedron: from the middle of
/// the edge between the first two to the middle of the edge between the others.
inline constexpr std::array<std::array<std::uint8_t, 4>, 3> kTetraDiagonals{
    {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}}};

/// Cuts every octahedron along the diagonal of that number: with edges in seven directions only, whatever the
/// level, this is the triangulation of Freudenthal [Freudenthal1942] seen through an affine map, and fine
/// tetrahedra come in three shapes and their mirror images in a point. `levels` from 0 to kMostLevels.
TetraPattern tetra_pattern(int levels, std::uint32_t diagonal);

}  // namespace coppice
