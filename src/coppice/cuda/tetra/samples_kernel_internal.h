#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "coppice/base/id.h"
#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/tetra/axes_stages_internal.h"
#include "coppice/cuda/tetra/bits_stages_internal.h"
#include "coppice/cuda/tetra/refinement_stages_internal.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/tetra/march/kernel/profile_kernel.h"
#include "coppice/tetra/march/kernel/snap_kernel.h"
#include "coppice/tetra/march/samples_view.h"

// Kernels of samples_stages_internal.h. A Field has a member
// FieldSample sample(std::uint32_t region, Vec3 p) const.

namespace coppice::cuda {

/// A fine vertex in the coarse tetrahedron that owns it.
struct FineVertex {
    std::uint32_t number, region;
    float edge;  ///< [m] length of the shortest fine edge around it; 0 on the hull
    Vec3 position;
};

/// Returns the i-th fine vertex in order: see DeviceRefinement.
COPPICE_HOST_DEVICE inline FineVertex fine_vertex(const DeviceRefinement& r, std::uint32_t i) {
    const FinePlace place = r.ordered.place(i);
    const OwnedElement owner = place.kind == TetraElementKind::inside
                                   ? OwnedElement{place.part, TetraPattern::kInside}
                                   : r.in_order[static_cast<std::uint32_t>(place.kind)][place.part];
    const std::uint32_t t = owner.tetra;
    return {r.view.vertices.first(t, r.view.elements[t], owner.group) + place.index, r.region[t],
            r.view.shortest_edge(t, owner.group),
            r.view.position(t, r.view.pattern(t).first_vertex[owner.group] + place.index)};
}

/// A field with the parameters for moving vertices.
template <class Field>
struct SnapField {
    Field field;
    tetra_kernel::Profile profile;
    float snap;  ///< see MarchOptions
};

/// Samples a fine vertex, and computes the first step to the surface if it is near.
template <class Field>
struct SampleFine {
    DeviceRefinement refinement;
    SnapField<Field> at;
    tetra_kernel::BitsView held;
    std::span<float> height;           ///< by number
    std::span<std::uint64_t> above;    ///< a bit if the height is above 0
    std::span<std::uint64_t> shallow;  ///< a bit if a held vertex is near the surface or outside
    std::span<Vec3> target;            ///< in order; set if the vertex is near
    std::span<std::uint64_t> near;     ///< in order: a bit if the vertex is near

    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const FineVertex v = fine_vertex(refinement, i);
        const FieldSample s = at.field.sample(v.region, v.position);
        const float h = at.profile.height(s.value);
        height[v.number] = h;
        if (h > 0) set_bit(above, v.number);
        Vec3 step;
        const bool is_near = tetra_kernel::step_to_surface(at.profile, s, h, at.snap * v.edge, step);
        if (held.test(v.number)) {
            if (is_near || h <= 0) set_bit(shallow, v.number);
        } else if (is_near) {
            set_bit(near, i);
            target[i] = v.position + step;
        }
    }
};

/// A fine vertex that may be moved.
struct SnappedVertex {
    std::uint32_t vertex;           ///< fine; kNoIndex if it stays
    tetra_kernel::SnapPlace place;  ///< target
};

/// Computes the second step to the surface.
template <class Field>
struct FindPlace {
    DeviceRefinement refinement;
    SnapField<Field> at;
    std::span<const std::uint32_t> near;  ///< indices in the order
    std::span<const Vec3> target;         ///< in order
    std::span<SnappedVertex> moved;       ///< of near vertices
    std::span<std::uint64_t> placed;      ///< a bit for each vertex that moves

    COPPICE_HOST_DEVICE void operator()(std::uint32_t k) const {
        const FineVertex v = fine_vertex(refinement, near[k]);
        const Vec3 end = target[near[k]];
        SnappedVertex out{kNoIndex, {}};
        if (tetra_kernel::second_step(at.profile, at.field.sample(v.region, end), v.position, end,
                                      at.snap * v.edge, out.place)) {
            out.vertex = v.number;
            set_bit(placed, v.number);
        }
        moved[k] = out;
    }
};

/// Moves shallow vertices towards the closest point of the axis that they hold, unless the field is smaller
/// there. Indexed by rank among the held vertices.
template <class Field>
struct MoveShallow {
    DeviceRefinement refinement;
    SnapField<Field> at;
    DeviceHeld held;
    tetra_kernel::BitsView shallow;
    std::span<const float> height;
    std::span<tetra_kernel::WeakVertex> weak;
    std::span<std::uint32_t> count;   ///< 1 if it is shallow
    std::span<SnappedVertex> moved;   ///< of all held vertices
    std::span<std::uint64_t> placed;  ///< a bit for each vertex that moves

    COPPICE_HOST_DEVICE void operator()(std::uint32_t rank) const {
        const std::uint32_t v = held.vertex[rank];
        SnappedVertex out{kNoIndex, {}};
        count[rank] = shallow.test(v) ? 1 : 0;
        if (count[rank] == 1) {
            const FinePlace part = refinement.view.vertices.place(v);
            const OwnedElement owner = refinement.owner(part);
            const std::uint32_t t = owner.tetra;
            const Vec3 from = refinement.view.position(
                t, refinement.view.pattern(t).first_vertex[owner.group] + part.index);
            const auto step = tetra_kernel::step_to_axis(
                held.segments[held.segment[rank]], from,
                tetra_kernel::kHeldReach * refinement.view.shortest_edge(t, owner.group));
            const float h = at.profile.height(at.field.sample(refinement.region[t], step.position).value);
            weak[rank] = {v, step.radius, step.away, h};
            out.place = {step.position, distance(step.position, from)};
            if (out.place.way > 0 && h >= height[v]) {
                out.vertex = v;
                set_bit(placed, v);
            }
        }
        moved[rank] = out;
    }
};

/// Compacts elements according to a scan of counts of 0 and 1.
struct ListWeak {
    std::span<const std::uint32_t> first;  ///< with one additional element
    std::span<const tetra_kernel::WeakVertex> from;
    std::span<tetra_kernel::WeakVertex> to;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        if (first[i] != first[i + 1]) to[first[i]] = from[i];
    }
};

/// Stores the targets of moved vertices, by rank.
struct NotePlaces {
    std::span<const SnappedVertex> moved;
    tetra_kernel::RankedView placed;
    std::span<Vec3> place;
    std::span<float> way;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        if (moved[i].vertex == kNoIndex) return;
        const std::uint32_t rank = placed.rank(moved[i].vertex);
        place[rank] = moved[i].place.position;
        way[rank] = moved[i].place.way;
    }
};

/// Computes the sides of all vertices, one word of bits at a time.
struct NoteSides {
    tetra_kernel::BitsView above, held, placed;
    std::span<std::uint64_t> inside, on, moved;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t w) const {
        moved[w] = placed.words[w];
        on[w] = placed.words[w] & ~held.words[w];
        inside[w] = (above.words[w] & ~on[w]) | held.words[w];
    }
};

/// Marks faces of the hull, four for each coarse tetrahedron, that have vertices on both sides.
struct MarkOpenFaces {
    DeviceRefinement refinement;
    tetra_kernel::BitsView inside;
    std::span<std::uint64_t> open;  ///< a bit for each face, by the opposite vertex in the order of the mesh

    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const RefinementView& view = refinement.view;
        const std::uint32_t t = i / 4;
        const TetraElements& elements = view.elements[t];
        std::uint32_t opposite = 0;
        while (elements[opposite] != refinement.tetra[t][i % 4]) ++opposite;
        if (view.shortest_edge(t, 10 + opposite) != 0) return;
        const PatternView& pattern = view.pattern(t);
        bool any = false, all = true;
        for (std::uint32_t v = 0; v < pattern.shares.size(); ++v) {
            if (pattern.shares[v][opposite] != 0) continue;
            const bool in = inside.test(view.vertex(t, v));
            any = any || in;
            all = all && in;
        }
        if (any && !all) set_bit(open, i);
    }
};

}  // namespace coppice::cuda
