#pragma once

#include <cstdint>
#include <span>

#include "coppice/cuda/tetra/axes_kernel_internal.h"
#include "coppice/tetra/march/march.h"

namespace coppice::cuda {

/// The fine vertices that hold axes, on an executor: see HeldVertices.
struct DeviceHeld {
    CountedBits bits;                        ///< of fine vertices; ranks are by these
    std::span<const std::uint32_t> vertex;   ///< by rank
    std::span<const std::uint32_t> segment;  ///< by rank: the closest of the axes that it holds
    std::span<const Segment> segments;       ///< [m] the axes
    DeviceSets sets;                         ///< sets of connected axes
};

/// Copies axes, and the lists of the regions through which they pass, for an uploaded coarse mesh.
template <class Exec>
PassingAxes upload_axes(Exec& exec, const InsideAxes& axes, const DeviceRefinement& refinement) {
    PassingAxes out;
    if (axes.segments.empty()) return out;
    out.segments = exec.upload(axes.segments);
    const int levels = refinement.view.levels;
    for (std::uint32_t d = 0; d < 3; ++d) {
        const tetra_kernel::FineLineTable table(tetra_pattern(levels, d), d);
        out.lines[d] = table.line();
        out.lines[d].local = exec.upload(out.lines[d].local);
    }
    const auto region = exec.template array<std::uint32_t>(axes.passing.items.size());
    exec.each("passing", refinement.first.size() - 1,
              NoteRows{exec.upload(std::span<const std::uint32_t>(axes.passing.first)), region});
    out.region = region;
    out.segment = exec.upload(std::span<const std::uint32_t>(axes.passing.items));
    return out;
}

/// Finds the closest axis of every held vertex, and the sets of axes that the vertices connect.
template <class Exec>
void find_sets(Exec& exec, std::span<const HeldBy> list, DeviceHeld& out) {
    const tetra_kernel::RankedView& held = out.bits.view;
    const auto least = exec.template array<std::uint64_t>(out.bits.count);
    const auto segment = exec.template array<std::uint32_t>(out.bits.count);
    exec.each("least away", least.size(), Fill<std::uint64_t>{least, ~std::uint64_t{0}});
    exec.each("nearest axes", segment.size(), Fill<std::uint32_t>{segment, ~0u});
    exec.each("least away", list.size(), FindLeastAway{list, held, least});
    exec.each("nearest axes", list.size(), FindNearestAxis{list, held, least, segment});
    out.segment = segment;

    out.sets = {exec.template array<std::uint32_t>(out.segments.size())};
    exec.each("begin sets", out.segments.size(), BeginSets{out.sets});
    exec.each("join axes", list.size(), JoinAxes{list, held, segment, out.sets});
    exec.each("flatten sets", out.segments.size(), FlattenSets{out.sets});
}

/// Returns the ranks of one held vertex of each set of connected axes: the first vertex that requested
/// tetrahedra own. Waits.
template <class Exec>
std::span<const std::uint32_t> first_of_sets(Exec& exec, const DeviceHeld& held,
                                             const DeviceRefinement& refinement) {
    const auto first = exec.template array<std::uint32_t>(held.segments.size());
    exec.each("first of sets", first.size(), Fill<std::uint32_t>{first, ~0u});
    const FindFirstOfSet find_first{refinement, held.vertex, held.segment, held.sets, first};
    exec.each("first of sets", held.bits.count, find_first);
    const auto marks = no_bits(exec, held.bits.count);
    exec.each("first of sets", held.bits.count, MarkFirstOfSet{find_first, marks});
    return list_bits(exec, marks);
}

/// Returns the vertices that hold axes, equal to those of hold_axes() on the CPU. O(passing axes times
/// tetrahedra of a region), which are few. Waits.
template <class Exec>
DeviceHeld hold_axes(Exec& exec, const PassingAxes& axes, const DeviceRefinement& refinement) {
    DeviceHeld out;
    const auto held = no_bits(exec, refinement.vertex_count);
    std::span<const HeldBy> list;
    if (!axes.segments.empty()) {
        const std::size_t passing = axes.segment.size();
        const auto first = exec.template array<std::uint32_t>(passing + 1);
        exec.each("count held", passing, CountHeld{refinement, axes, first});
        const auto found = exec.template array<HeldBy>(place_counts(exec, first));
        exec.each("list held", passing, ListHeld{refinement, axes, first, found, held});
        list = found;
        out.segments = axes.segments;
    }
    out.bits = rank_bits(exec, held);
    out.vertex = list_bits(exec, out.bits);
    if (out.bits.count > 0) find_sets(exec, list, out);
    return out;
}

}  // namespace coppice::cuda
