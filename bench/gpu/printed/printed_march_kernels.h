#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/base/vec.h"
#include "coppice/cuda/tetra/refinement_stages_internal.h"
#include "coppice/mesh/mesh.h"
#include "coppice/tetra/lattice/pattern.h"
#include "coppice/tetra/lattice/tetra_mesh.h"
#include "coppice/tetra/march/kernel/cut_kernel.h"
#include "coppice/tetra/march/samples_view.h"

// The kernels of [Zhu2013], with the names of the paper: explicit tetrahedra on every level, marched without
// snapping.
//
// All elements are numbered in closed form. Edge e is divided into 2 e at its first vertex and 2 e + 1 at its
// second. Within face f of F: edge 2 E + 3 f + k cuts off corner k; faces 4 f + k at corner k, 4 f + 3 in the
// middle. Within tetrahedron t: the diagonal is edge 2 E + 3 F + t; faces 4 F + 8 t + i.

namespace coppice::bench {

/// Explicit tetrahedra with their edges and faces, and the regions of the field that contain these.
struct ExplicitTetra {
    /// A triangle, and the edge opposite each of its vertices.
    struct Face {
        std::array<std::uint32_t, 3> vertices, edges;
        std::uint32_t region;
    };
    struct Edge {
        std::array<std::uint32_t, 2> vertices;
        std::uint32_t region;
    };
    struct Cell {
        Tetra vertices;                      ///< positively oriented
        std::array<std::uint32_t, 6> edges;  ///< 01, 02, 03, 12, 13, 23
        std::array<std::uint32_t, 4> faces;  ///< opposite 0, 1, 2, 3
        std::uint32_t region;
    };
    std::span<Vec3> positions;         ///< [m]
    std::span<std::uint32_t> regions;  ///< of the vertices
    std::span<Edge> edges;
    std::span<Face> faces;
    std::span<Cell> tetra;
};

/// Copies vertices of the coarse mesh; one thread per vertex. Vertices without tetrahedra are in the first
/// region.
struct WriteVertices {
    std::span<const Vec3> from;
    ExplicitTetra to;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t v) const {
        to.positions[v] = from[v];
        to.regions[v] = 0;
    }
};

/// Writes the coarse mesh, from a refinement with 0 levels; one thread per tetrahedron.
struct WriteCoarse {
    cuda::DeviceRefinement from;
    ExplicitTetra to;

    COPPICE_HOST_DEVICE void operator()(std::uint32_t t) const {
        const TetraElements& p = from.view.elements[t];
        const TetraTraits& traits = from.view.traits[t];
        const std::uint32_t region = from.region[t];
        ExplicitTetra::Cell cell{{p[0], p[1], p[2], p[3]},
                                 {p[4], p[5], p[6], p[7], p[8], p[9]},
                                 {p[10], p[11], p[12], p[13]},
                                 region};
        if (traits.mirrored) {
            cell.vertices = {p[0], p[1], p[3], p[2]};
            cell.edges = {p[4], p[6], p[5], p[8], p[7], p[9]};
            cell.faces = {p[10], p[11], p[13], p[12]};
        }
        to.tetra[t] = cell;
        for (std::uint32_t g = 0; g < 14; ++g) {
            if ((traits.owned >> g & 1) != 0) write_part(p, g, region);
        }
    }

  private:
    COPPICE_HOST_DEVICE void write_part(const TetraElements& p, std::uint32_t group,
                                        std::uint32_t region) const {
        const auto edge = [&](std::uint32_t a, std::uint32_t b) { return p[3 + a + b + (a > 0 ? 1 : 0)]; };
        if (group < 4) {
            to.regions[p[group]] = region;
        } else if (group < 10) {
            const std::uint32_t a = group < 7 ? 0 : group < 9 ? 1 : 2, b = group - 3 - a - (a > 0 ? 1 : 0);
            to.edges[p[group]] = {{p[a], p[b]}, region};
        } else {
            const std::uint32_t opposite = group - 10, a = opposite == 0 ? 1 : 0, b = opposite <= 1 ? 2 : 1,
                                c = opposite == 3 ? 2 : 3;
            to.faces[p[group]] = {{p[a], p[b], p[c]}, {edge(b, c), edge(a, c), edge(a, b)}, region};
        }
    }
};

/// Computes the midpoint of every edge, and its two halves; one thread per edge.
struct CalcEdgePoints {
    ExplicitTetra coarse, fine;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t e) const {
        const auto [ends, region] = coarse.edges[e];
        const std::uint32_t middle = static_cast<std::uint32_t>(coarse.positions.size()) + e;
        fine.positions[middle] = (coarse.positions[ends[0]] + coarse.positions[ends[1]]) * 0.5f;
        fine.regions[middle] = region;
        fine.edges[2 * e] = {{ends[0], middle}, region};
        fine.edges[2 * e + 1] = {{ends[1], middle}, region};
    }
};

/// Copies vertices; one thread per vertex.
struct KeepVertices {
    ExplicitTetra coarse, fine;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t v) const {
        fine.positions[v] = coarse.positions[v];
        fine.regions[v] = coarse.regions[v];
    }
};

/// Creates the four elements of every face, and the three edges between them; one thread per face.
struct SubdivideFaces {
    ExplicitTetra coarse, fine;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t f) const {
        const ExplicitTetra::Face face = coarse.faces[f];
        const auto vertices = static_cast<std::uint32_t>(coarse.positions.size());
        const std::uint32_t inner = 2 * static_cast<std::uint32_t>(coarse.edges.size()) + 3 * f;
        const auto middle = [&](std::uint32_t k) { return vertices + face.edges[k]; };
        const auto half = [&](std::uint32_t opposite, std::uint32_t corner) {
            const std::uint32_t e = face.edges[opposite];
            return 2 * e + (coarse.edges[e].vertices[0] == face.vertices[corner] ? 0u : 1u);
        };
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t l = (k + 1) % 3, m = (k + 2) % 3;
            fine.edges[inner + k] = {{middle(l), middle(m)}, face.region};
            if (fine.faces.empty()) continue;
            fine.faces[4 * f + k] = {
                {face.vertices[k], middle(m), middle(l)}, {inner + k, half(l, k), half(m, k)}, face.region};
        }
        if (!fine.faces.empty())
            fine.faces[4 * f + 3] = {
                {middle(0), middle(1), middle(2)}, {inner, inner + 1, inner + 2}, face.region};
    }
};

/// Creates the eight elements of a tetrahedron: four at its corners, and four of the octahedron between them,
/// cut along the shortest of its diagonals. One thread per part, unlike the paper's one per tetrahedron, so
/// that adjacent threads write adjacent elements. The elements are those of the paper, except that all have
/// the orientation of the tetrahedron.
///
/// A vertex of a part is identified by the corners between which it is, as bits: one for a corner, two for a
/// midpoint.
struct SubdivideTetrahedra {
    static constexpr std::uint32_t kParts = 8;

    ExplicitTetra coarse, fine;

    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const std::uint32_t t = i / kParts, number = i % kParts;
        const ExplicitTetra::Cell cell = coarse.tetra[t];
        const auto d = compute_diagonal(cell);
        // The ring of midpoints around the diagonal.
        const Masks ring{bit(d[0]) | bit(d[2]), bit(d[1]) | bit(d[2]), bit(d[1]) | bit(d[3]),
                         bit(d[0]) | bit(d[3])};
        const std::uint32_t p = bit(d[0]) | bit(d[1]), q = bit(d[2]) | bit(d[3]);
        if (number == 0) fine.edges[diagonal(t)] = {{vertex(cell, p), vertex(cell, q)}, cell.region};
        if (number < 4) {
            Masks part{}, face{};
            for (std::uint32_t j = 0, k = 0; j < 4; ++j) {
                part[j] = bit(number) | bit(j);
                if (j != number) face[k++] = part[j];
            }
            write_part(t, cell, ring, part, number);
            write_face(t, cell, ring, face);
        } else {
            const std::uint32_t r = ring[number - 4], s = ring[(number - 3) % 4];
            const bool odd = d[1] == 2;
            write_part(t, cell, ring, odd ? Masks{p, q, r, s} : Masks{p, q, s, r}, number);
            write_face(t, cell, ring, {p, q, r, 0});
        }
    }

  private:
    using Masks = std::array<std::uint32_t, 4>;

    COPPICE_HOST_DEVICE static std::uint32_t bit(std::uint32_t corner) { return 1u << corner; }
    /// Returns the number of the only corner in the mask.
    COPPICE_HOST_DEVICE static std::uint32_t find_corner(std::uint32_t mask) {
        return mask == 1 ? 0 : mask == 2 ? 1 : mask == 4 ? 2 : 3;
    }
    /// Returns the number of the edge between the two corners in the mask.
    COPPICE_HOST_DEVICE static std::uint32_t find_edge(std::uint32_t mask) {
        return mask == 3 ? 0 : mask == 5 ? 1 : mask == 9 ? 2 : mask == 6 ? 3 : mask == 10 ? 4 : 5;
    }
    COPPICE_HOST_DEVICE std::uint32_t diagonal(std::uint32_t t) const {
        return static_cast<std::uint32_t>(2 * coarse.edges.size() + 3 * coarse.faces.size()) + t;
    }

    /// Returns the corners of the shortest diagonal: see kTetraDiagonals.
    COPPICE_HOST_DEVICE std::array<std::uint32_t, 4> compute_diagonal(const ExplicitTetra::Cell& cell) const {
        std::array<std::uint32_t, 4> best{};
        float least = 0;
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::array<std::uint32_t, 4> d{0, 1 + k, k == 0 ? 2u : 1u, k == 2 ? 2u : 3u};
            const auto at = [&](std::uint32_t i) { return coarse.positions[cell.vertices[d[i]]]; };
            const float squared = length_squared((at(0) + at(1)) - (at(2) + at(3)));
            if (k > 0 && !(squared < least)) continue;
            least = squared;
            best = d;
        }
        return best;
    }

    COPPICE_HOST_DEVICE std::uint32_t vertex(const ExplicitTetra::Cell& cell, std::uint32_t mask) const {
        if ((mask & (mask - 1)) == 0) return cell.vertices[find_corner(mask)];
        return static_cast<std::uint32_t>(coarse.positions.size()) + cell.edges[find_edge(mask)];
    }
    /// Returns the index, in a face of the tetrahedron, of the corner in the mask.
    COPPICE_HOST_DEVICE std::uint32_t place_in_face(const ExplicitTetra::Cell& cell, std::uint32_t face,
                                                    std::uint32_t mask) const {
        const std::uint32_t v = cell.vertices[find_corner(mask)];
        const auto& of_face = coarse.faces[face].vertices;
        return of_face[0] == v ? 0 : of_face[1] == v ? 1 : 2;
    }

    COPPICE_HOST_DEVICE std::uint32_t edge(std::uint32_t t, const ExplicitTetra::Cell& cell, std::uint32_t a,
                                           std::uint32_t b) const {
        const std::uint32_t all = a | b, both = a & b;
        if (all == 15) return diagonal(t);
        if (tetra_kernel::count_bits(all) == 2) {
            const std::uint32_t e = cell.edges[find_edge(all)];
            return 2 * e + (coarse.edges[e].vertices[0] == cell.vertices[find_corner(both)] ? 0u : 1u);
        }
        const std::uint32_t face = cell.faces[find_corner(15 ^ all)];
        return static_cast<std::uint32_t>(2 * coarse.edges.size()) + 3 * face +
               place_in_face(cell, face, both);
    }

    COPPICE_HOST_DEVICE std::uint32_t face(std::uint32_t t, const ExplicitTetra::Cell& cell,
                                           const Masks& ring, const Masks& f) const {
        const std::uint32_t all = f[0] | f[1] | f[2], common = f[0] & f[1] & f[2];
        if (all != 15) {
            const std::uint32_t of = cell.faces[find_corner(15 ^ all)];
            return 4 * of + (common == 0 ? 3 : place_in_face(cell, of, common));
        }
        const std::uint32_t first = static_cast<std::uint32_t>(4 * coarse.faces.size()) + 8 * t;
        if (common != 0) return first + find_corner(common);
        std::uint32_t k = 0;
        while (f[0] != ring[k] && f[1] != ring[k] && f[2] != ring[k]) ++k;
        return first + 4 + k;
    }

    COPPICE_HOST_DEVICE void write_face(std::uint32_t t, const ExplicitTetra::Cell& cell, const Masks& ring,
                                        const Masks& f) const {
        if (fine.faces.empty()) return;
        fine.faces[face(t, cell, ring, f)] = {
            {vertex(cell, f[0]), vertex(cell, f[1]), vertex(cell, f[2])},
            {edge(t, cell, f[1], f[2]), edge(t, cell, f[0], f[2]), edge(t, cell, f[0], f[1])},
            cell.region};
    }

    COPPICE_HOST_DEVICE void write_part(std::uint32_t t, const ExplicitTetra::Cell& cell, const Masks& ring,
                                        const Masks& m, std::uint32_t number) const {
        ExplicitTetra::Cell& out = fine.tetra[8 * t + number];
        out.region = cell.region;
        for (std::uint32_t i = 0, e = 0; i < 4; ++i) {
            Masks opposite{};
            for (std::uint32_t j = 0, k = 0; j < 4; ++j) {
                if (j != i) opposite[k++] = m[j];
                if (j > i) out.edges[e++] = edge(t, cell, m[i], m[j]);
            }
            out.vertices[i] = vertex(cell, m[i]);
            out.faces[i] = fine.faces.empty() ? 0 : face(t, cell, ring, opposite);
        }
    }
};

/// Samples the field; one thread per vertex.
template <class Field>
struct CalcFields {
    ExplicitTetra mesh;
    Field field;
    std::span<float> value;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t v) const {
        value[v] = field.sample(mesh.regions[v], mesh.positions[v]).value;
    }
};

/// Crossings of the surface, by linear interpolation between two values.
struct IsoSurface {
    ExplicitTetra mesh;
    std::span<const float> value;
    float level;
    std::span<const tetra_kernel::Cut> table;  ///< kCuts

    COPPICE_HOST_DEVICE const tetra_kernel::Cut& cut(std::uint32_t index) const { return table[16 * index]; }
    COPPICE_HOST_DEVICE Vec3 point(std::uint32_t edge) const {
        const auto [a, b] = mesh.edges[edge].vertices;
        const float share = (level - value[a]) / (value[b] - value[a]);
        return lerp(mesh.positions[a], mesh.positions[b], share);
    }
};

/// Computes the 4-bit index of every tetrahedron, and its number of triangles; one thread per tetrahedron.
struct CalcTetrahedralIndice {
    IsoSurface surface;
    std::span<std::uint8_t> index;
    std::span<std::uint32_t> count;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t t) const {
        std::uint32_t inside = 0;
        for (std::uint32_t i = 0; i < 4; ++i) {
            const float value = surface.value[surface.mesh.tetra[t].vertices[i]];
            inside |= (value > surface.level ? 1u : 0u) << i;
        }
        index[t] = static_cast<std::uint8_t>(inside);
        const std::uint32_t size = surface.cut(inside).size;
        count[t] = size == 0 ? 0 : size - 2;
    }
};

/// Calls use(triangle, edges) for the triangles of a tetrahedron, numbered from `first`.
template <class Use>
COPPICE_HOST_DEVICE void for_each_iso_triangle(const IsoSurface& surface, std::uint32_t t,
                                               std::uint32_t index, std::uint32_t first, const Use& use) {
    const tetra_kernel::Cut& cut = surface.cut(index);
    const auto& edges = surface.mesh.tetra[t].edges;
    for (std::uint32_t k = 2; k < cut.size; ++k)
        use(first + k - 2, Triangle{edges[cut.corners[0]], edges[cut.corners[k - 1]], edges[cut.corners[k]]});
}

/// Writes every triangle with its own corners; one thread per tetrahedron.
struct ExtractIsoTriangles {
    IsoSurface surface;
    std::span<const std::uint8_t> index;
    std::span<const std::uint32_t> first;
    std::span<std::array<Vec3, 3>> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t t) const {
        for_each_iso_triangle(surface, t, index[t], first[t], [&](std::uint32_t i, const Triangle& edges) {
            for (std::uint32_t k = 0; k < 3; ++k) out[i][k] = surface.point(edges[k]);
        });
    }
};

/// Marks the edges that the surface crosses; one thread per edge.
struct MarkCutEdges {
    IsoSurface surface;
    std::span<std::uint32_t> count;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t e) const {
        const auto [a, b] = surface.mesh.edges[e].vertices;
        count[e] = (surface.value[a] > surface.level) != (surface.value[b] > surface.level) ? 1 : 0;
    }
};

/// Writes the vertex of every such edge once; one thread per edge.
struct WeldVertices {
    IsoSurface surface;
    std::span<const std::uint32_t> first;  ///< by edge, plus the end
    std::span<Vec3> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t e) const {
        if (first[e] != first[e + 1]) out[first[e]] = surface.point(e);
    }
};

/// Writes triangles between these vertices; one thread per tetrahedron.
struct WeldTriangles {
    IsoSurface surface;
    std::span<const std::uint8_t> index;
    std::span<const std::uint32_t> first;
    std::span<const std::uint32_t> vertex;  ///< by edge
    std::span<Triangle> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t t) const {
        for_each_iso_triangle(surface, t, index[t], first[t], [&](std::uint32_t i, const Triangle& edges) {
            out[i] = {vertex[edges[0]], vertex[edges[1]], vertex[edges[2]]};
        });
    }
};

}  // namespace coppice::bench
