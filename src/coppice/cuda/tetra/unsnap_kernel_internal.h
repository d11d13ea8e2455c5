#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/tetra/bits_stages_internal.h"
#include "coppice/cuda/tetra/refinement_stages_internal.h"
#include "coppice/tetra/march/kernel/cut_kernel.h"
#include "coppice/tetra/march/kernel/fan_kernel.h"
#include "coppice/tetra/march/kernel/fold_kernel.h"
#include "coppice/tetra/march/samples_view.h"

// Kernels that move vertices back which cannot stay on the surface.

namespace coppice::cuda {

/// Intersections of the surface with fine tetrahedra, by their number.
struct FineCrossings {
    DeviceRefinement refinement;
    tetra_kernel::SamplesView samples;
    std::span<const tetra_kernel::Cut> table;  ///< kCuts

    COPPICE_HOST_DEVICE std::uint32_t tetra(std::uint32_t i) const { return refinement.tetra_index(i); }
    COPPICE_HOST_DEVICE std::uint32_t fine(std::uint32_t i) const { return refinement.fine_index(i); }
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
    std::span<std::uint64_t> marks;  ///< a bit for each
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        if (crossings.cut(i).size > 0) set_bit(marks, i);
    }
};

/// Marks the fine tetrahedra in some coarse ones again.
struct MarkCrossedIn {
    FineCrossings crossings;
    std::span<const std::uint32_t> tetra;  ///< coarse tetrahedra
    std::span<std::uint64_t> marks;        ///< a bit for each fine tetrahedron
    COPPICE_HOST_DEVICE void operator()(std::uint32_t k) const {
        const std::uint32_t i = crossings.refinement.fine_tetra(tetra[crossings.tetra(k)], crossings.fine(k));
        if (crossings.cut(i).size > 0) {
            set_bit(marks, i);
        } else {
            reset_bits(marks[i / 64], std::uint64_t{1} << (i % 64));
        }
    }
};

/// Marks the vertex that moved farthest of a fine tetrahedron that was inverted or became too flat.
struct FindFold {
    DeviceRefinement refinement;
    tetra_kernel::SamplesView samples;
    std::span<std::uint64_t> marks;  ///< a bit for each fine vertex

    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const RefinementView& view = refinement.view;
        const std::uint32_t t = refinement.tetra_index(i);
        const auto& corners = view.pattern(t).tetra[refinement.fine_index(i)];
        std::array<std::uint32_t, 4> vertex{};
        std::array<float, 4> way{};
        for (std::size_t k = 0; k < 4; ++k) {
            vertex[k] = view.vertex(t, corners[k]);
            if (samples.moved.test(vertex[k])) way[k] = samples.way[samples.placed.rank(vertex[k])];
        }
        if (tetra_kernel::two_longest(way) <= tetra_kernel::harmless_way(view.traits[t].width)) return;
        tetra_kernel::Corners now;
        for (std::size_t k = 0; k < 4; ++k) {
            now[k] = Vec3d(samples.moved.test(vertex[k]) ? samples.place[samples.placed.rank(vertex[k])]
                                                         : view.position(t, corners[k]));
        }
        const double whole =
            tetra_kernel::tetra_volume(tetra_kernel::get_corners(view.positions.data(), view.elements[t]));
        if (!tetra_kernel::is_flat(now, whole / static_cast<double>(1u << (3 * view.levels)))) return;
        const std::uint32_t worst = tetra_kernel::farthest(vertex, way);
        set_bit(marks, worst);
    }
};

/// Checks only the fine tetrahedra in some coarse ones.
struct FindFoldIn {
    FindFold find;
    std::span<const std::uint32_t> tetra;  ///< coarse tetrahedra
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const DeviceRefinement& r = find.refinement;
        find(r.fine_tetra(tetra[r.tetra_index(i)], r.fine_index(i)));
    }
};

/// Adds the triangle of a fine tetrahedron to the fans of its vertices on the surface. Their order is
/// arbitrary and has no effect.
struct ListFans {
    FineCrossings crossings;
    std::span<const std::uint32_t> crossed;   ///< fine tetrahedra
    std::span<std::uint32_t> size;            ///< of each fan, by rank
    std::span<tetra_kernel::ListedFan> fans;  ///< the first kMax triangles of each

    COPPICE_HOST_DEVICE void operator()(std::uint32_t listed) const {
        using tetra_kernel::ListedFan;
        const std::uint32_t i = crossed[listed];
        const tetra_kernel::Cut& cut = crossings.cut(i);
        const auto is_vertex = [&](std::uint32_t k) { return cut.corners[k] >= tetra_kernel::kCutVertex; };
        // Only cuts with three corners have corners at vertices: one corner is inside and the others are cut
        // off.
        if (cut.size != 3 || !(is_vertex(0) || is_vertex(1) || is_vertex(2))) return;
        const RefinementView& view = crossings.refinement.view;
        const std::uint32_t t = crossings.tetra(i);
        const PatternView& pattern = view.pattern(t);
        const std::uint32_t fine = crossings.fine(i);
        std::array<std::uint32_t, 3> vertex{};
        std::array<ListedFan::Key, 3> key{};
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint8_t c = cut.corners[k];
            if (is_vertex(k)) {
                vertex[k] = view.vertex(t, pattern.tetra[fine][c - tetra_kernel::kCutVertex]);
                key[k] = ListedFan::make_key(vertex[k], vertex[k]);
            } else {
                const auto& ends = pattern.edges[pattern.tetra_edges[fine][c]];
                key[k] = ListedFan::make_key(view.vertex(t, ends[0]), view.vertex(t, ends[1]));
            }
        }
        for (std::uint32_t k = 0; k < 3; ++k) {
            if (!is_vertex(k)) continue;
            const std::uint32_t rank = crossings.samples.placed.rank(vertex[k]);
            const std::uint32_t at = add_to(size[rank], 1u);
            if (at >= ListedFan::kMax) continue;
            const auto next = key[(k + 1) % 3], last = key[(k + 2) % 3];
            if (view.traits[t].mirrored) {
                fans[rank].segments[at] = {last, next};
            } else {
                fans[rank].segments[at] = {next, last};
            }
        }
    }
};

/// Determines the configuration of every fan.
struct JudgeFan {
    std::span<const std::uint32_t> size;
    std::span<const tetra_kernel::ListedFan> fans;
    std::span<tetra_kernel::Fan> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const { out[i] = fans[i].judge(size[i]); }
};

/// Calls use(coarse tetrahedron, local vertex) for those that contain a fine vertex, ascending.
template <class Use>
COPPICE_HOST_DEVICE void visit_coarse_around(const DeviceRefinement& refinement, std::uint32_t vertex,
                                             const Use& use) {
    const RefinementView& view = refinement.view;
    const FinePlace place = view.vertices.place(vertex);
    const OwnedElement owner = refinement.owner(place);
    if (owner.group == TetraPattern::kInside) {
        use(owner.tetra, view.pattern(owner.tetra).first_vertex[owner.group] + place.index);
        return;
    }
    const TetraElements& elements = view.elements[owner.tetra];
    const std::uint32_t least = lowest_corner(owner.group), v = elements[least];
    const VertexStars& stars = refinement.stars;
    for (std::uint32_t q = stars.first[v]; q < stars.first[v + 1]; ++q) {
        const std::uint32_t t = stars.corners[q] / 4;
        const std::uint32_t there = SharedAbove::find(elements, least, view.elements[t], stars.corners[q] % 4)
                                        .corners_there(owner.group);
        if (there != 0) use(t, view.pattern(t).first_vertex[group_of_corners(there)] + place.index);
    }
}

/// Calls use(coarse tetrahedron, local fine tetrahedron, local vertex) for the fine tetrahedra that contain a
/// fine vertex.
template <class Use>
COPPICE_HOST_DEVICE void visit_fine_around(const DeviceRefinement& refinement, std::uint32_t vertex,
                                           const Use& use) {
    visit_coarse_around(refinement, vertex, [&](std::uint32_t t, std::uint32_t local) {
        const PatternView& pattern = refinement.view.pattern(t);
        for (std::uint32_t k = pattern.first_around[local]; k < pattern.first_around[local + 1]; ++k)
            use(t, pattern.around[k], local);
    });
}

/// The triangles around vertices on the surface, with unique keys.
struct ExactFans {
    using Key = std::uint64_t;
    using Segment = tetra_kernel::LinkSegment<Key>;
    FineCrossings crossings;

    /// Calls use(segment) for each triangle.
    template <class Use>
    COPPICE_HOST_DEVICE void visit(std::uint32_t vertex, const Use& use) const {
        const RefinementView& view = crossings.refinement.view;
        const DeviceRefinement& refinement = crossings.refinement;
        visit_fine_around(refinement, vertex, [&](std::uint32_t t, std::uint32_t fine, std::uint32_t local) {
            const auto& corners = view.pattern(t).tetra[fine];
            const tetra_kernel::Cut& cut = crossings.cut(refinement.fine_tetra(t, fine));
            for (std::uint32_t k = 0; k < cut.size; ++k) {
                const std::uint32_t c = cut.corners[k];
                if (c < tetra_kernel::kCutVertex || corners[c - tetra_kernel::kCutVertex] != local) continue;
                // A cut polygon with a corner at a vertex is a triangle: one corner is inside and the others
                // are cut off.
                const Key next = key(t, fine, cut.corners[(k + 1) % 3]);
                const Key last = key(t, fine, cut.corners[(k + 2) % 3]);
                use(view.traits[t].mirrored ? Segment{last, next} : Segment{next, last});
            }
        });
    }

  private:
    COPPICE_HOST_DEVICE Key key(std::uint32_t t, std::uint32_t fine, std::uint32_t corner) const {
        const RefinementView& view = crossings.refinement.view;
        const PatternView& pattern = view.pattern(t);
        std::uint32_t a = 0, b = 0;
        if (corner >= tetra_kernel::kCutVertex) {
            a = b = view.vertex(t, pattern.tetra[fine][corner - tetra_kernel::kCutVertex]);
        } else {
            const auto& ends = pattern.edges[pattern.tetra_edges[fine][corner]];
            a = view.vertex(t, ends[0]);
            b = view.vertex(t, ends[1]);
        }
        return Key{std::min(a, b)} << 32 | std::max(a, b);
    }
};

/// Counts the triangles.
struct CountFan {
    ExactFans fans;
    std::span<const std::uint32_t> vertex;
    std::span<std::uint32_t> count;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        std::uint32_t found = 0;
        fans.visit(vertex[i], [&](const ExactFans::Segment&) { ++found; });
        count[i] = found;
    }
};

/// Determines the fan of a vertex, and marks it if it cannot stay.
struct SettleFan {
    ExactFans fans;
    std::span<const std::uint32_t> vertex;
    std::span<const std::uint32_t> first;
    std::span<ExactFans::Segment> segments;  ///< memory for all triangles
    std::span<tetra_kernel::Fan> fan;        ///< by rank
    std::span<std::uint64_t> marks;          ///< a bit for each fine vertex
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        std::uint32_t at = first[i];
        fans.visit(vertex[i], [&](const ExactFans::Segment& s) { segments[at++] = s; });
        const auto judged =
            tetra_kernel::judge_fan<ExactFans::Key>(segments.subspan(first[i], at - first[i]));
        fan[fans.crossings.samples.placed.rank(vertex[i])] = judged;
        if (judged == tetra_kernel::Fan::non_manifold) set_bit(marks, vertex[i]);
    }
};

/// Marks vertices with unknown fans.
struct MarkUnknown {
    std::span<const tetra_kernel::Fan> fan;  ///< by rank
    std::span<const std::uint32_t> vertex;   ///< by rank
    std::span<std::uint64_t> marks;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t rank) const {
        if (fan[rank] == tetra_kernel::Fan::unknown) set_bit(marks, vertex[rank]);
    }
};

/// Moves a vertex back to its original position.
struct PutBack {
    std::span<const std::uint32_t> vertex;
    tetra_kernel::BitsView above, held;
    std::span<std::uint64_t> inside, on, moved;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const std::uint32_t v = vertex[i];
        const std::uint64_t bit = std::uint64_t{1} << (v % 64);
        reset_bits(on[v / 64], bit);
        reset_bits(moved[v / 64], bit);
        if (above.test(v) || held.test(v)) set_bits(inside[v / 64], bit);
    }
};

/// Clears the fans of vertices that were moved back.
struct ForgetFan {
    std::span<const std::uint32_t> vertex;
    tetra_kernel::RankedView placed;
    std::span<tetra_kernel::Fan> fan;  ///< by rank
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        fan[placed.rank(vertex[i])] = tetra_kernel::Fan::none;
    }
};

/// Marks the coarse tetrahedra around vertices.
struct MarkAround {
    DeviceRefinement refinement;
    std::span<const std::uint32_t> vertex;
    std::span<std::uint64_t> marks;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        visit_coarse_around(refinement, vertex[i],
                            [&](std::uint32_t t, std::uint32_t) { set_bit(marks, t); });
    }
};

/// Marks the vertices on the surface that share a fine tetrahedron with others.
struct MarkNeighbours {
    DeviceRefinement refinement;
    tetra_kernel::BitsView on;
    std::span<const std::uint32_t> vertex;
    std::span<std::uint64_t> marks;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const RefinementView& view = refinement.view;
        visit_fine_around(refinement, vertex[i], [&](std::uint32_t t, std::uint32_t fine, std::uint32_t) {
            for (const auto local : view.pattern(t).tetra[fine]) {
                const std::uint32_t v = view.vertex(t, local);
                if (v != vertex[i] && on.test(v)) set_bit(marks, v);
            }
        });
    }
};

}  // namespace coppice::cuda
