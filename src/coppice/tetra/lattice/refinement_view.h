#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/base/vec.h"
#include "coppice/tetra/lattice/pattern.h"

namespace coppice {

/// Elements of a coarse tetrahedron, by group of its pattern: 4 vertices, 6 edges, 4 faces.
using TetraElements = std::array<std::uint32_t, 14>;

/// Properties of a coarse tetrahedron: see the functions of TetraRefinement of the same names.
struct TetraTraits {
    float shortest_edge;    ///< [m] fine
    float width;            ///< [m] fine
    std::uint16_t owned;    ///< bits by group
    std::uint8_t diagonal;  ///< along which it is cut
    bool mirrored;          ///< vertices in ascending order have negative orientation
};

/// Kind of an element of the coarse mesh that contains fine vertices and fine edges.
enum class TetraElementKind : std::uint8_t { vertex, edge, face, inside };

/// Returns the kind of a group of a pattern.
constexpr std::uint32_t element_kind(std::uint32_t group) {
    return (group >= 4 ? 1u : 0u) + (group >= 10 ? 1u : 0u) + (group >= TetraPattern::kInside ? 1u : 0u);
}

/// Position of a fine vertex or edge: number `index` of those inside a coarse element.
struct FinePlace {
    TetraElementKind kind;  ///< of the coarse element
    std::uint32_t part;     ///< number of the coarse vertex, edge, face or tetrahedron
    std::uint32_t index;    ///< among those inside that element
};

/// Numbering of fine vertices or fine edges: those of the coarse vertices, the edges, the faces and the
/// tetrahedra in sequence, with the same number inside each element of a kind.
struct FineNumbers {
    std::array<std::uint32_t, 4> per_kind{};       ///< inside one element
    std::array<std::uint32_t, 4> first_of_kind{};  ///< number of the first one

    /// Returns the number of the first one inside the element of a group; the others follow.
    COPPICE_HOST_DEVICE std::uint32_t first(std::uint32_t tetra, const TetraElements& elements,
                                            std::uint32_t group) const {
        const std::uint32_t kind = element_kind(group);
        const std::uint32_t part = group == TetraPattern::kInside ? tetra : elements[group];
        return first_of_kind[kind] + part * per_kind[kind];
    }
    /// Returns the coarse element that contains a fine vertex or edge.
    COPPICE_HOST_DEVICE FinePlace place(std::uint32_t number) const {
        std::uint32_t kind = 3;
        while (number < first_of_kind[kind] || per_kind[kind] == 0) --kind;
        const std::uint32_t offset = number - first_of_kind[kind];
        return {static_cast<TetraElementKind>(kind), offset / per_kind[kind], offset % per_kind[kind]};
    }
    /// Sets the first number of every kind, given the number of elements of each; returns the total.
    std::uint64_t begin_kinds(const std::array<std::uint64_t, 4>& elements) {
        std::uint64_t total = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            first_of_kind[k] = static_cast<std::uint32_t>(total);
            total += elements[k] * per_kind[k];
        }
        return total;
    }
};

/// Returns the number of fine vertices inside one coarse vertex, edge, face and tetrahedron.
inline std::array<std::uint32_t, 4> fine_vertices_per_part(int levels) {
    const std::uint32_t n = 1u << levels;
    return {1, n - 1, (n - 1) * (n - 2) / 2, n < 4 ? 0 : (n - 1) * (n - 2) * (n - 3) / 6};
}

/// Returns the number of fine edges inside each; it does not depend on the diagonal.
inline std::array<std::uint32_t, 4> fine_edges_per_part(const TetraPattern& pattern) {
    const auto& first = pattern.first_edge;
    return {0, first[5] - first[4], first[11] - first[10], first[15] - first[14]};
}

/// [m] Computes a fine vertex by summing its shares of the corners in ascending order; corners with share 0
/// add exactly nothing. The result is therefore bit-identical for every coarse tetrahedron.
COPPICE_HOST_DEVICE inline Vec3 fine_position(const Vec3* coarse, const TetraElements& elements,
                                              const std::array<float, 4>& shares) {
    Vec3 sum;
    for (std::size_t i = 0; i < 4; ++i) sum += coarse[elements[i]] * shares[i];
    return sum;
}

/// A TetraPattern with arrays in any memory, such as on a device.
struct PatternView {
    using Local = TetraPattern::Local;                                    ///< see TetraPattern
    std::span<const std::array<float, 4>> shares;                         ///< see TetraPattern
    std::span<const std::uint8_t> group;                                  ///< see TetraPattern
    std::span<const std::array<Local, 4>> tetra;                          ///< see TetraPattern
    std::span<const std::array<Local, 2>> edges;                          ///< see TetraPattern
    std::span<const std::uint8_t> edge_group;                             ///< see TetraPattern
    std::span<const std::array<Local, 6>> tetra_edges;                    ///< see TetraPattern
    std::span<const std::uint32_t> first_around;                          ///< see TetraPattern
    std::span<const Local> around;                                        ///< see TetraPattern
    std::array<std::uint32_t, TetraPattern::kGroups + 1> first_vertex{};  ///< see TetraPattern
    std::array<std::uint32_t, TetraPattern::kGroups + 1> first_edge{};    ///< see TetraPattern
};

/// Returns a view of the arrays of a pattern, which must outlive it.
inline PatternView make_view(const TetraPattern& p) {
    return {p.shares,      p.group,        p.tetra,  p.edges,        p.edge_group,
            p.tetra_edges, p.first_around, p.around, p.first_vertex, p.first_edge};
}

/// A TetraRefinement with arrays in any memory, such as on a device.
struct RefinementView {
    std::span<const Vec3> positions;               ///< [m] of the coarse mesh
    std::span<const TetraElements> elements;       ///< of every coarse tetrahedron
    std::span<const TetraTraits> traits;           ///< of every coarse tetrahedron
    std::span<const float> shortest_at;            ///< [m] of coarse vertices, edges, faces
    std::array<std::uint32_t, 4> first_element{};  ///< first element of every kind in shortest_at
    std::array<PatternView, 3> patterns;           ///< by diagonal
    FineNumbers vertices;                          ///< fine
    FineNumbers edges;                             ///< fine
    std::uint64_t edge_count = 0;                  ///< fine; their numbers are up to 2^32
    int levels = 0;                                ///< number of subdivisions

    /// subdivision of a coarse tetrahedron
    COPPICE_HOST_DEVICE const PatternView& pattern(std::uint32_t tetra) const {
        return patterns[traits[tetra].diagonal];
    }
    /// See TetraRefinement.
    COPPICE_HOST_DEVICE std::uint32_t vertex(std::uint32_t tetra, std::uint32_t local) const {
        const PatternView& p = pattern(tetra);
        const std::uint32_t group = p.group[local];
        return vertices.first(tetra, elements[tetra], group) + (local - p.first_vertex[group]);
    }
    /// Returns the number of a fine edge, given by its local number in a coarse tetrahedron.
    COPPICE_HOST_DEVICE std::uint32_t edge(std::uint32_t tetra, std::uint32_t local) const {
        const PatternView& p = pattern(tetra);
        const std::uint32_t group = p.edge_group[local];
        return edges.first(tetra, elements[tetra], group) + (local - p.first_edge[group]);
    }
    /// See TetraRefinement.
    COPPICE_HOST_DEVICE Vec3 position(std::uint32_t tetra, std::uint32_t local) const {
        return fine_position(positions.data(), elements[tetra], pattern(tetra).shares[local]);
    }
    /// See TetraRefinement.
    COPPICE_HOST_DEVICE float shortest_edge(std::uint32_t tetra, std::uint32_t group) const {
        if (group == TetraPattern::kInside) return traits[tetra].shortest_edge;
        return shortest_at[first_element[element_kind(group)] + elements[tetra][group]];
    }
};

}  // namespace coppice
