#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/tetra/samples_kernel_internal.h"
#include "coppice/cuda/tetra/unsnap_kernel_internal.h"
#include "coppice/mesh/mesh.h"
#include "coppice/tetra/march/kernel/cut_kernel.h"

// Kernels of extract_stages_internal.h.

namespace coppice::cuda {

/// Position of a surface vertex: number `index` of the fine vertices, or fine edges, inside the element of a
/// group of the coarse tetrahedron that owns it.
struct SurfacePlace {
    std::uint32_t tetra, group, index;
};

/// A fine edge in a coarse tetrahedron.
struct FineEdge {
    std::uint32_t tetra;
    std::array<std::uint16_t, 2> local;
    std::uint32_t a, b;  ///< its fine vertices
};

COPPICE_HOST_DEVICE inline FineEdge fine_edge(const DeviceRefinement& r, std::uint32_t e) {
    const FinePlace place = r.view.edges.place(e);
    const OwnedElement owner = r.owner(place);
    const PatternView& pattern = r.view.pattern(owner.tetra);
    const auto ends = pattern.edges[pattern.first_edge[owner.group] + place.index];
    return {owner.tetra, ends, r.view.vertex(owner.tetra, ends[0]), r.view.vertex(owner.tetra, ends[1])};
}

/// Marks the corners of surface polygons: fine vertices moved onto the surface, and fine edges that it cuts.
struct MarkCorners {
    FineCrossings crossings;
    std::span<const std::uint32_t> crossed;  ///< fine tetrahedra
    std::span<std::uint64_t> moved;          ///< a bit for each fine vertex
    std::span<std::uint64_t> cuts;           ///< a bit for each fine edge
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const RefinementView& view = crossings.refinement.view;
        const std::uint32_t t = crossings.tetra(crossed[i]), fine = crossings.fine(crossed[i]);
        const tetra_kernel::Cut& cut = crossings.cut(crossed[i]);
        for (std::uint32_t k = 0; k < cut.size; ++k) {
            const std::uint8_t c = cut.corners[k];
            const PatternView& pattern = view.pattern(t);
            if (c < tetra_kernel::kCutVertex) {
                set_bit(cuts, view.edge(t, pattern.tetra_edges[fine][c]));
            } else {
                set_bit(moved, view.vertex(t, pattern.tetra[fine][c - tetra_kernel::kCutVertex]));
            }
        }
    }
};

/// Computes the vertex of a cut edge.
template <class Field>
struct PlaceCut {
    DeviceRefinement refinement;
    Field field;
    tetra_kernel::Profile profile;
    tetra_kernel::SamplesView samples;
    int refinements;
    std::span<const std::uint32_t> cuts;  ///< fine edges
    std::span<Vec3> position;             ///< position of each

    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const FineEdge at = fine_edge(refinement, cuts[i]);
        tetra_kernel::CutEdge edge =
            samples.cut_edge(at.a, at.b, refinement.view.position(at.tetra, at.local[0]),
                             refinement.view.position(at.tetra, at.local[1]), refinement.clearance);
        Vec3 p = edge.point();
        for (int round = 0; round < refinements; ++round) {
            edge.narrow(profile.height(field.sample(refinement.region[at.tetra], p).value));
            p = edge.point();
        }
        position[i] = p;
    }
};

/// Writes the vertices that were moved onto the surface and have triangles.
struct PlaceMoved {
    tetra_kernel::SamplesView samples;
    std::span<const std::uint32_t> moved;  ///< fine vertices
    std::span<Vec3> position;              ///< position of each
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        position[i] = samples.place[samples.placed.rank(moved[i])];
    }
};

/// Writes the position of each surface vertex in the refined mesh.
struct NameVertices {
    DeviceRefinement refinement;
    std::span<const std::uint32_t> moved;  ///< fine vertices, which come first
    std::span<const std::uint32_t> cuts;   ///< fine edges
    std::span<SurfacePlace> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const auto count = static_cast<std::uint32_t>(moved.size());
        const FinePlace place = i < count ? refinement.view.vertices.place(moved[i])
                                          : refinement.view.edges.place(cuts[i - count]);
        const OwnedElement owner = refinement.owner(place);
        out[i] = {owner.tetra, owner.group, place.index};
    }
};

/// Counts the triangles in crossed tetrahedra.
struct CountTriangles {
    FineCrossings crossings;
    std::span<const std::uint32_t> crossed;
    std::span<std::uint32_t> count;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        count[i] = crossings.cut(crossed[i]).size - 2u;
    }
};

struct WriteTriangles {
    FineCrossings crossings;
    std::span<const std::uint32_t> crossed;  ///< fine tetrahedra
    std::span<const std::uint32_t> first;    ///< first triangle of each
    tetra_kernel::RankedView moved, cuts;    ///< see MarkCorners
    std::uint32_t moved_count;
    std::span<const Vec3> position;
    std::span<Triangle> out;

    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const RefinementView& view = crossings.refinement.view;
        const std::uint32_t t = crossings.tetra(crossed[i]), fine = crossings.fine(crossed[i]);
        const PatternView& pattern = view.pattern(t);
        const tetra_kernel::Cut& cut = crossings.cut(crossed[i]);
        std::array<std::uint32_t, 4> corners{};
        for (std::uint32_t k = 0; k < cut.size; ++k) {
            const std::uint8_t c = cut.corners[k];
            if (c < tetra_kernel::kCutVertex) {
                corners[k] = moved_count + cuts.rank(view.edge(t, pattern.tetra_edges[fine][c]));
            } else {
                corners[k] = moved.rank(view.vertex(t, pattern.tetra[fine][c - tetra_kernel::kCutVertex]));
            }
        }
        if (view.traits[t].mirrored) tetra_kernel::turn_round(corners, cut.size);
        tetra_kernel::write_polygon(position.data(), corners, cut.size, out.data() + first[i]);
    }
};

}  // namespace coppice::cuda
