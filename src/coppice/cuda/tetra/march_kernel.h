#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/exec/atomics.h"
#include "coppice/cuda/tetra/refinement_stages.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/mesh/mesh.h"
#include "coppice/tetra/march/cut_kernel.h"
#include "coppice/tetra/march/march_stages.h"
#include "coppice/tetra/march/profile_kernel.h"
#include "coppice/tetra/march/samples_view.h"
#include "coppice/tetra/march/snap_kernel.h"

// The kernels of march_stages.h. A Field has a member FieldSample sample(std::uint32_t region, Vec3 p) const.

namespace coppice::cuda {

/// A fine vertex as the first coarse tetrahedron that has it sees it.
struct FineVertex {
    std::uint32_t number, region;
    float edge;  ///< [m] of the shortest fine edge about it; 0 on the hull
    Vec3 position;
};

/// The i-th in order: see DeviceRefinement.
COPPICE_HOST_DEVICE inline FineVertex fine_vertex(const DeviceRefinement& r, std::uint32_t i) {
    const FinePlace place = r.ordered.place(i);
    const OwnedPart owner = place.kind == TetraPartKind::inside
                                ? OwnedPart{place.part, TetraPattern::kInside}
                                : r.in_order[static_cast<std::uint32_t>(place.kind)][place.part];
    const std::uint32_t t = owner.tetra;
    return {r.view.vertices.first(t, r.view.parts[t], owner.group) + place.index, r.region[t],
            r.view.shortest_edge(t, owner.group),
            r.view.position(t, r.view.pattern(t).first_vertex[owner.group] + place.index)};
}

/// Samples a fine vertex, and makes the first step to the surface where it is near.
template <class Field>
struct SampleFine {
    DeviceRefinement refinement;
    Field field;
    tetra_kernel::Profile profile;
    float snap;
    tetra_kernel::BitsView held;
    std::span<float> height;         ///< by number
    std::span<std::uint64_t> above;  ///< a bit where the height is above 0
    std::span<Vec3> target;          ///< in order; set where the vertex is near
    /// In order: 1 where the vertex is near, 2^32 where it is held and near or not inside.
    std::span<std::uint64_t> count;

    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const FineVertex v = fine_vertex(refinement, i);
        const FieldSample s = field.sample(v.region, v.position);
        const float h = profile.height(s.value);
        height[v.number] = h;
        if (h > 0) set_bits(above[v.number / 64], std::uint64_t{1} << (v.number % 64));
        Vec3 step;
        const bool is_near = tetra_kernel::step_to_surface(profile, s, h, snap * v.edge, step);
        if (held.test(v.number)) {
            count[i] = is_near || h <= 0 ? std::uint64_t{1} << 32 : 0;
            return;
        }
        count[i] = is_near ? 1 : 0;
        if (is_near) target[i] = v.position + step;
    }
};

/// Lists what SampleFine counted, at the places that the scan of the counts gives.
struct ListFound {
    DeviceRefinement refinement;
    std::span<const std::uint64_t> first;  ///< in order, and one more
    std::span<const float> height;         ///< by number
    std::span<std::uint32_t> near;         ///< their places in the order
    std::span<ShallowVertex> shallow;

    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const std::uint64_t here = first[i], next = first[i + 1];
        if (here == next) return;
        if (static_cast<std::uint32_t>(here) != static_cast<std::uint32_t>(next)) {
            near[static_cast<std::uint32_t>(here)] = i;
            return;
        }
        const FineVertex v = fine_vertex(refinement, i);
        shallow[here >> 32] = {v.number, v.region, v.position, tetra_kernel::kHeldReach * v.edge,
                               height[v.number]};
    }
};

/// Makes the second step to the surface.
template <class Field>
struct FindPlace {
    DeviceRefinement refinement;
    Field field;
    tetra_kernel::Profile profile;
    float snap;
    std::span<const std::uint32_t> near;  ///< places in the order
    std::span<const Vec3> target;         ///< in order
    std::span<MovedVertex> place;
    std::span<std::uint32_t> count;  ///< 1 where it is found

    COPPICE_HOST_DEVICE void operator()(std::uint32_t k) const {
        const FineVertex v = fine_vertex(refinement, near[k]);
        const Vec3 end = target[near[k]];
        tetra_kernel::SnapPlace out;
        const bool found = tetra_kernel::second_step(profile, field.sample(v.region, end), v.position, end,
                                                     snap * v.edge, out);
        count[k] = found ? 1 : 0;
        if (found) place[k] = {v.number, out.position, out.way};
    }
};

/// Moves what was found together.
struct ListMoved {
    std::span<const std::uint32_t> first;  ///< by candidate, and one more
    std::span<const MovedVertex> from;
    std::span<MovedVertex> to;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        if (first[i] != first[i + 1]) to[first[i]] = from[i];
    }
};

/// A fine edge as a coarse tetrahedron sees it.
struct FineEdge {
    std::uint32_t tetra;
    std::array<std::uint16_t, 2> local;
    std::uint32_t a, b;  ///< its fine vertices
};

COPPICE_HOST_DEVICE inline FineEdge fine_edge(const DeviceRefinement& r, std::uint32_t e) {
    const FinePlace place = r.view.edges.place(e);
    const OwnedPart owner = r.owner(place);
    const PatternView& pattern = r.view.pattern(owner.tetra);
    const auto ends = pattern.edges[pattern.first_edge[owner.group] + place.index];
    return {owner.tetra, ends, r.view.vertex(owner.tetra, ends[0]), r.view.vertex(owner.tetra, ends[1])};
}

/// Marks the fine edges that have a vertex of the surface inside.
struct MarkCuts {
    DeviceRefinement refinement;
    tetra_kernel::SamplesView samples;
    std::span<std::uint32_t> count;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t e) const {
        const FineEdge edge = fine_edge(refinement, e);
        count[e] = samples.cuts(edge.a, edge.b) ? 1 : 0;
    }
};

/// Lists those i that a scan of counts of 0 and 1 gives a place.
struct ListMarked {
    std::span<const std::uint32_t> first;  ///< and one more
    std::span<std::uint32_t> list;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        if (first[i] != first[i + 1]) list[first[i]] = i;
    }
};

/// Puts the vertex of a cut edge onto the surface.
template <class Field>
struct PlaceCut {
    DeviceRefinement refinement;
    Field field;
    tetra_kernel::Profile profile;
    tetra_kernel::SamplesView samples;
    int refinements;
    std::span<const std::uint32_t> cuts;  ///< fine edges
    std::span<Vec3> position;             ///< of each

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

/// Writes the vertices that were moved onto the surface.
struct PlaceMoved {
    std::span<const std::uint32_t> number;  ///< by rank; 2^32 - 1 for those not in use
    std::span<const Vec3> place;            ///< by rank
    std::span<Vec3> position;               ///< of the surface
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        if (number[i] != 0xffffffffu) position[number[i]] = place[i];
    }
};

/// How the surface crosses fine tetrahedra, by their number.
struct FineCrossings {
    DeviceRefinement refinement;
    tetra_kernel::SamplesView samples;
    std::span<const tetra_kernel::Cut> table;  ///< kCuts

    COPPICE_HOST_DEVICE std::uint32_t tetra(std::uint32_t i) const { return refinement.tetra_of(i); }
    COPPICE_HOST_DEVICE std::uint32_t fine(std::uint32_t i) const { return refinement.fine_of(i); }
    COPPICE_HOST_DEVICE const tetra_kernel::Cut& cut(std::uint32_t i) const {
        const std::uint32_t t = tetra(i);
        const auto& corners = refinement.view.pattern(t).tetra[fine(i)];
        std::uint32_t inside = 0, on = 0;
        for (std::uint32_t k = 0; k < 4; ++k) {
            const std::uint32_t v = refinement.view.vertex(t, corners[k]);
            inside |= (samples.inside.test(v) ? 1u : 0u) << k;
            on |= (samples.on.test(v) ? 1u : 0u) << k;
        }
        return table[16 * inside + on];
    }
};

/// Marks the fine tetrahedra that the surface crosses.
struct MarkCrossed {
    FineCrossings crossings;
    std::span<std::uint32_t> count;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        count[i] = crossings.cut(i).size > 0 ? 1 : 0;
    }
};

/// Counts the triangles in those that it crosses.
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
    std::span<const std::uint32_t> first;    ///< of each its first triangle
    std::span<const std::uint32_t> number;   ///< of the vertex in a fine edge, less placed_count
    std::span<const std::uint32_t> placed;   ///< see PlaceMoved
    std::uint32_t placed_count;
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
                corners[k] = placed_count + number[view.edge(t, pattern.tetra_edges[fine][c])];
            } else {
                const std::uint32_t v = view.vertex(t, pattern.tetra[fine][c - tetra_kernel::kCutVertex]);
                corners[k] = placed[crossings.samples.placed.rank(v)];
            }
        }
        if (view.traits[t].mirrored) tetra_kernel::turn_round(corners, cut.size);
        tetra_kernel::write_polygon(position.data(), corners, cut.size, out.data() + first[i]);
    }
};

}  // namespace coppice::cuda
