#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/exec/atomics_internal.h"
#include "coppice/cuda/exec/sets_kernel_internal.h"
#include "coppice/cuda/tetra/bits_stages_internal.h"
#include "coppice/cuda/tetra/refinement_stages_internal.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/tetra/march/kernel/axis_kernel.h"

// Kernels that find the fine vertices that hold axes: see HeldVertices.

namespace coppice::cuda {

/// An axis, and a fine vertex that holds it.
struct HeldBy {
    std::uint32_t vertex;   ///< fine vertex
    std::uint32_t segment;  ///< of the axes
    std::uint64_t away;     ///< [m^2] squared distance from the vertex, as bits, which sort like the number
};

/// Axes in the regions that they pass through.
struct PassingAxes {
    std::array<tetra_kernel::FineLine, 3> lines;  ///< by diagonal
    std::span<const Segment> segments;            ///< [m]
    std::span<const std::uint32_t> region;        ///< of every passing axis
    std::span<const std::uint32_t> segment;       ///< of every passing axis

    /// Calls use(tetrahedron, local vertex, axis) for the vertices that hold an axis in a region's
    /// tetrahedra.
    template <class Use>
    COPPICE_HOST_DEVICE void visit(const DeviceRefinement& refinement, std::uint32_t passing,
                                   const Use& use) const {
        const RefinementView& view = refinement.view;
        const std::uint32_t r = region[passing];
        const Segment& axis = segments[segment[passing]];
        const tetra_kernel::AxisLine line(axis);
        for (std::uint32_t t = refinement.first[r]; t < refinement.first[r + 1]; ++t) {
            const tetra_kernel::Corners corners =
                tetra_kernel::get_corners(view.positions.data(), view.elements[t]);
            if (!tetra_kernel::HeldTetra(corners).is_near(line)) continue;
            tetra_kernel::visit_held(tetra_kernel::WeightFunctions(corners), lines[view.traits[t].diagonal],
                                     axis, [&](std::uint32_t local) { use(t, local, axis); });
        }
    }
};

/// Counts the vertices for each passing axis, with repetitions.
struct CountHeld {
    DeviceRefinement refinement;
    PassingAxes axes;
    std::span<std::uint32_t> count;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        std::uint32_t found = 0;
        axes.visit(refinement, i, [&](std::uint32_t, std::uint32_t, const Segment&) { ++found; });
        count[i] = found;
    }
};

/// Lists the vertices and marks them.
struct ListHeld {
    DeviceRefinement refinement;
    PassingAxes axes;
    std::span<const std::uint32_t> first;
    std::span<HeldBy> list;
    std::span<std::uint64_t> held;  ///< a bit for each fine vertex
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        std::uint32_t at = first[i];
        axes.visit(refinement, i, [&](std::uint32_t t, std::uint32_t local, const Segment& axis) {
            const RefinementView& view = refinement.view;
            const std::uint32_t vertex = view.vertex(t, local);
            const double away = tetra_kernel::squared_distance(axis, Vec3d(view.position(t, local)));
            list[at++] = {vertex, axes.segment[i], std::bit_cast<std::uint64_t>(away)};
            set_bit(held, vertex);
        });
    }
};

/// Finds the distance of the closest axis from each held vertex.
struct FindLeastAway {
    std::span<const HeldBy> list;
    tetra_kernel::RankedView held;
    std::span<std::uint64_t> least;  ///< by rank
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        lower_to(least[held.rank(list[i].vertex)], list[i].away);
    }
};

/// Finds the closest axis; the first of equally close ones.
struct FindNearestAxis {
    std::span<const HeldBy> list;
    tetra_kernel::RankedView held;
    std::span<const std::uint64_t> least;  ///< by rank
    std::span<std::uint32_t> segment;      ///< by rank
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const std::uint32_t rank = held.rank(list[i].vertex);
        if (list[i].away == least[rank]) lower_to(segment[rank], list[i].segment);
    }
};

/// Joins all axes that one vertex holds.
struct JoinAxes {
    std::span<const HeldBy> list;
    tetra_kernel::RankedView held;
    std::span<const std::uint32_t> segment;  ///< by rank
    DeviceSets sets;                         ///< of segments
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        sets.join(list[i].segment, segment[held.rank(list[i].vertex)]);
    }
};

/// Finds, for each set of axes, the first vertex that a requested tetrahedron owns.
struct FindFirstOfSet {
    DeviceRefinement refinement;
    std::span<const std::uint32_t> vertex;   ///< by rank
    std::span<const std::uint32_t> segment;  ///< by rank
    DeviceSets sets;
    std::span<std::uint32_t> first;  ///< rank, by the representative segment of the set
    COPPICE_HOST_DEVICE void operator()(std::uint32_t rank) const {
        if (refinement.owns(vertex[rank])) lower_to(first[sets.find(segment[rank])], rank);
    }
};

/// Marks these vertices.
struct MarkFirstOfSet {
    FindFirstOfSet found;
    std::span<std::uint64_t> marks;  ///< a bit by rank
    COPPICE_HOST_DEVICE void operator()(std::uint32_t rank) const {
        if (found.first[found.sets.find(found.segment[rank])] == rank) set_bit(marks, rank);
    }
};

}  // namespace coppice::cuda
