#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/exec/atomics_internal.h"
#include "coppice/tetra/lattice/refinement.h"
#include "coppice/tetra/lattice/shape_kernel.h"
#include "coppice/tetra/march/samples_view.h"

// Kernels that find the edges and faces of a coarse mesh, and number them as TetraRefinement does: by their
// smallest vertex, then by the first tetrahedron that lists them, then by group.

namespace coppice::cuda {

/// Returns the corners of a group of a pattern, as bits.
COPPICE_HOST_DEVICE constexpr std::uint32_t group_corners(std::uint32_t group) {
    if (group < 4) return 1u << group;
    if (group >= 10) return 15u ^ 1u << (group - 10);
    const std::uint32_t a = group < 7 ? 0 : group < 9 ? 1 : 2, b = group - 3 - a - (a > 0 ? 1 : 0);
    return 1u << a | 1u << b;
}
/// Returns the group with these one, two or three corners.
COPPICE_HOST_DEVICE constexpr std::uint32_t group_of_corners(std::uint32_t corners) {
    std::uint32_t group = 0;
    while (group_corners(group) != corners) ++group;
    return group;
}
/// Returns the smallest corner of a group.
COPPICE_HOST_DEVICE constexpr std::uint32_t lowest_corner(std::uint32_t group) {
    const std::uint32_t corners = group_corners(group);
    return (corners & 1) != 0 ? 0 : (corners & 2) != 0 ? 1 : (corners & 4) != 0 ? 2 : 3;
}

/// The tetrahedra around each coarse vertex, ascending: each as four times its number plus the corner at the
/// vertex.
struct VertexStars {
    std::span<const std::uint32_t> first;    ///< of every vertex, plus the end
    std::span<const std::uint32_t> corners;  ///< concatenated rows
    std::span<const std::uint32_t> vertex;   ///< vertex of the row of each corner
};

/// Describes every coarse tetrahedron, and lists its corners.
struct DescribeTetra {
    std::span<const Vec3> positions;
    std::span<const Tetra> tetra;
    int levels;
    std::span<TetraElements> elements;
    std::span<TetraTraits> traits;
    std::span<std::uint32_t> vertex;  ///< of every corner
    std::span<std::uint32_t> corner;  ///< 0, 1, 2 ...
    std::span<std::uint32_t> faulty;  ///< set to 1 if a tetrahedron is invalid

    COPPICE_HOST_DEVICE void operator()(std::uint32_t t) const {
        const Tetra& own = tetra[t];
        bool fine = true;
        for (std::uint32_t k = 0; k < 4; ++k) fine = fine && own[k] < positions.size();
        fine = fine && tetra_kernel::is_sound(tetra_kernel::get_corners(positions.data(), own));
        if (!fine) raise_to(faulty[0], 1u);
        if (fine) tetra_kernel::describe_tetra(positions.data(), own, levels, elements[t], traits[t]);
        for (std::uint32_t k = 0; k < 4; ++k) {
            vertex[4 * t + k] = fine ? elements[t][k] : 0;
            corner[4 * t + k] = 4 * t + k;
        }
    }
};

/// Finds the start of the row of every vertex in corners sorted by vertex.
struct FindRows {
    std::span<const std::uint32_t> vertex;  ///< of every corner, ascending
    std::span<std::uint32_t> first;         ///< of every vertex, plus the end
    COPPICE_HOST_DEVICE void operator()(std::uint32_t v) const {
        std::uint32_t low = 0, high = static_cast<std::uint32_t>(vertex.size());
        while (low < high) {
            const std::uint32_t middle = (low + high) / 2;
            if (vertex[middle] < v) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        first[v] = low;
    }
};

/// Elements owned by the corners of tetrahedra: bits by group of the elements that have the corner as their
/// smallest vertex and this as their first tetrahedron; and from kHull, bits by opposite corner of the faces
/// that no other tetrahedron has.
struct OwnedByCorner {
    static constexpr std::uint32_t kHull = 16;
    static constexpr std::uint32_t kEdges = 0x3f0;   ///< groups
    static constexpr std::uint32_t kFaces = 0x3c00;  ///< groups
    std::span<std::uint32_t> bits;                   ///< of every corner

    /// Returns the faces of a tetrahedron on the hull, by their opposite corners.
    COPPICE_HOST_DEVICE std::uint32_t hull(std::uint32_t tetra) const {
        return (bits[4 * tetra] | bits[4 * tetra + 1]) >> kHull;
    }
};

/// Common vertices of two tetrahedra, starting at one vertex.
struct SharedAbove {
    std::uint32_t here = 0;  ///< corners of the first tetrahedron, as bits
    /// for each of these, four bits: the corner of the second tetrahedron, as a bit
    std::uint32_t there = 0;

    /// Finds the common vertices from the vertex that is corner `c` of the first, and corner `d` of the
    /// second.
    COPPICE_HOST_DEVICE static SharedAbove find(const TetraElements& one, std::uint32_t c,
                                                const TetraElements& other, std::uint32_t d) {
        SharedAbove out{1u << c, 1u << (4 * c + d)};
        // Corners are ascending.
        for (std::uint32_t i = c + 1; i < 4; ++i) {
            for (std::uint32_t j = d + 1; j < 4; ++j) {
                if (one[i] != other[j]) continue;
                out.here |= 1u << i;
                out.there |= 1u << (4 * i + j);
            }
        }
        return out;
    }
    /// Returns the corners of the second tetrahedron that equal those of a group of the first, as bits; 0 if
    /// some are missing.
    COPPICE_HOST_DEVICE std::uint32_t corners_there(std::uint32_t group) const {
        const std::uint32_t corners = group_corners(group);
        if ((here & corners) != corners) return 0;
        std::uint32_t out = 0;
        for (std::uint32_t i = 0; i < 4; ++i) out |= (corners >> i & 1) != 0 ? there >> (4 * i) & 15 : 0;
        return out;
    }
};

/// Returns the groups with this smallest corner, as bits.
COPPICE_HOST_DEVICE constexpr std::uint32_t groups_above(std::uint32_t corner) {
    std::uint32_t out = 0;
    for (std::uint32_t g = 0; g < TetraPattern::kInside; ++g) out |= lowest_corner(g) == corner ? 1u << g : 0;
    return out;
}

/// Finds the elements that each corner owns; indexed by position in the rows.
struct FindOwned {
    VertexStars stars;
    std::span<const TetraElements> elements;
    OwnedByCorner owned;
    std::span<std::uint64_t> count;   ///< number of edges, plus 2^32 times the number of faces
    std::span<std::uint32_t> faulty;  ///< set to 1 if a face has a third tetrahedron

    COPPICE_HOST_DEVICE void operator()(std::uint32_t s) const {
        const std::uint32_t at = stars.corners[s], c = at % 4, first = stars.first[stars.vertex[s]];
        const std::uint32_t above = groups_above(c);
        std::uint32_t named = s > first ? 1u << c : 0, shared_faces = 0;
        // The last corner has no elements above it.
        for (std::uint32_t q = first; c < 3 && q < stars.first[stars.vertex[s] + 1]; ++q) {
            if (q == s) continue;
            const std::uint32_t has = groups_shared(at, stars.corners[q]) & above;
            if (q < s) named |= has;
            const std::uint32_t faces = has & OwnedByCorner::kFaces;
            if ((shared_faces & faces) != 0) raise_to(faulty[0], 1u);
            shared_faces |= faces;
        }
        const std::uint32_t alone = above & OwnedByCorner::kFaces & ~shared_faces;
        const std::uint32_t bits = above & ~named;
        owned.bits[at] = bits | alone >> 10 << OwnedByCorner::kHull;
        count[s] = std::uint64_t{tetra_kernel::count_bits(bits & OwnedByCorner::kEdges)} |
                   std::uint64_t{tetra_kernel::count_bits(bits & OwnedByCorner::kFaces)} << 32;
    }

  private:
    /// Returns the groups of one tetrahedron that another one around the same vertex shares, as bits.
    COPPICE_HOST_DEVICE std::uint32_t groups_shared(std::uint32_t one, std::uint32_t other) const {
        const std::uint32_t shared =
            SharedAbove::find(elements[one / 4], one % 4, elements[other / 4], other % 4).here;
        std::uint32_t out = 0;
        for (std::uint32_t g = 4; g < TetraPattern::kInside; ++g)
            out |= (shared & group_corners(g)) == group_corners(g) ? 1u << g : 0;
        return out;
    }
};

/// Numbers the edges and faces that have each corner as their smallest vertex; indexed by position in the
/// rows.
struct NumberElements {
    VertexStars stars;
    OwnedByCorner owned;
    std::span<const std::uint64_t> first;  ///< number of edges and faces owned before, by position
    std::span<TetraElements> elements;     ///< vertices are already set

    COPPICE_HOST_DEVICE void operator()(std::uint32_t s) const {
        const std::uint32_t at = stars.corners[s], c = at % 4;
        TetraElements& here = elements[at / 4];
        std::uint32_t open = groups_above(c) & (OwnedByCorner::kEdges | OwnedByCorner::kFaces);
        for (std::uint32_t q = stars.first[stars.vertex[s]]; open != 0; ++q) {
            const std::uint32_t other = stars.corners[q];
            const SharedAbove shared = SharedAbove::find(here, c, elements[other / 4], other % 4);
            for (std::uint32_t g = 4; g < TetraPattern::kInside; ++g) {
                const std::uint32_t there = (open >> g & 1) != 0 ? shared.corners_there(g) : 0;
                if (there == 0) continue;
                open &= ~(1u << g);
                const bool is_edge = g < 10;
                const std::uint32_t before = owned.bits[other] & ((1u << group_of_corners(there)) - 1) &
                                             (is_edge ? OwnedByCorner::kEdges : OwnedByCorner::kFaces);
                here[g] = static_cast<std::uint32_t>(first[q] >> (is_edge ? 0 : 32)) +
                          tetra_kernel::count_bits(before);
            }
        }
    }
};

/// Initialises vertices, which may have no tetrahedra and so no edges.
struct BeginShortest {
    std::span<float> shortest_at;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t v) const {
        shortest_at[v] = std::numeric_limits<float>::infinity();
    }
};

/// Finds the shortest fine edge around each element that a corner owns, or 0 on the hull; indexed by position
/// in the rows.
struct FindShortest {
    VertexStars stars;
    OwnedByCorner owned;
    std::span<const TetraElements> elements;
    std::span<const TetraTraits> traits;
    std::array<std::uint32_t, 4> first_element;  ///< see RefinementView
    std::span<float> shortest_at;                ///< see RefinementView

    COPPICE_HOST_DEVICE void operator()(std::uint32_t s) const {
        const std::uint32_t at = stars.corners[s], v = stars.vertex[s];
        const std::uint32_t own = owned.bits[at] & ((1u << TetraPattern::kInside) - 1);
        if (own == 0) return;
        const TetraElements& here = elements[at / 4];
        std::array<float, TetraPattern::kInside> shortest{};
        for (float& l : shortest) l = std::numeric_limits<float>::infinity();
        for (std::uint32_t q = stars.first[v]; q < stars.first[v + 1]; ++q) {
            const std::uint32_t other = stars.corners[q] / 4;
            const SharedAbove shared = SharedAbove::find(here, at % 4, elements[other], stars.corners[q] % 4);
            for (std::uint32_t g = 0; g < TetraPattern::kInside; ++g) {
                const std::uint32_t there = (own >> g & 1) != 0 ? shared.corners_there(g) : 0;
                if (there == 0) continue;
                const bool on_hull = (owned.hull(other) & ~there) != 0;
                shortest[g] = std::min(shortest[g], on_hull ? 0 : traits[other].shortest_edge);
            }
        }
        for (std::uint32_t g = 0; g < TetraPattern::kInside; ++g) {
            if ((own >> g & 1) != 0) shortest_at[first_element[element_kind(g)] + here[g]] = shortest[g];
        }
    }
};

/// Combines the elements that the corners of each tetrahedron own.
struct NoteOwned {
    OwnedByCorner owned;
    std::span<TetraTraits> traits;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t t) const {
        std::uint32_t bits = 1u << TetraPattern::kInside;
        for (std::uint32_t k = 0; k < 4; ++k) bits |= owned.bits[4 * t + k] & 0x3fffu;
        traits[t].owned = static_cast<std::uint16_t>(bits);
    }
};

}  // namespace coppice::cuda
