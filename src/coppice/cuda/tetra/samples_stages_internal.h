#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/cuda/tetra/samples_kernel_internal.h"

namespace coppice::cuda {

/// Properties of every fine vertex, on an executor, and the data that changes when vertices are moved back.
struct DeviceSamples {
    tetra_kernel::SamplesView view;
    tetra_kernel::BitsView above;  ///< vertices with a height above 0
    /// Words of the bits in `view`.
    /// @{
    std::span<std::uint64_t> inside, on, moved;
    /// @}
    std::uint32_t placed_count = 0;  ///< number of vertices in `placed`
};

/// Returns the vertices to move onto the surface.
template <class Exec, class Field>
std::span<const SnappedVertex> find_near(Exec& exec, const DeviceRefinement& refinement,
                                         const SnapField<Field>& at, tetra_kernel::BitsView held,
                                         std::span<float> height, std::span<std::uint64_t> above,
                                         std::span<std::uint64_t> shallow, std::span<std::uint64_t> placed) {
    const std::uint32_t count = refinement.ordered_count;
    const auto target = exec.template array<Vec3>(count);
    const auto marks = no_bits(exec, count);
    exec.each("field", count, SampleFine<Field>{refinement, at, held, height, above, shallow, target, marks});
    const auto near = list_bits(exec, marks);
    const auto moved = exec.template array<SnappedVertex>(near.size());
    exec.each("second step", near.size(), FindPlace<Field>{refinement, at, near, target, moved, placed});
    return moved;
}

/// Samples all fine vertices, and moves those near the surface onto it and held ones towards their axes, as
/// sample_vertices() does on the CPU. Waits.
template <class Exec, class Field>
DeviceSamples sample_vertices(Exec& exec, const DeviceRefinement& refinement, const SnapField<Field>& at,
                              const DeviceHeld& held) {
    const std::size_t count = refinement.vertex_count;
    const auto height = exec.template array<float>(count);
    // Vertices without tetrahedra are not sampled.
    exec.each("heights", refinement.view.positions.size(), Fill<float>{height, -1.0f});
    const auto above = no_bits(exec, count), shallow = no_bits(exec, count), placed = no_bits(exec, count);
    const tetra_kernel::BitsView is_held{held.bits.view.words};
    const std::span<const SnappedVertex> near =
        find_near(exec, refinement, at, is_held, height, above, shallow, placed);

    const auto all_weak = exec.template array<tetra_kernel::WeakVertex>(held.bits.count);
    const auto first_weak = exec.template array<std::uint32_t>(held.bits.count + std::size_t{1});
    const auto moved = exec.template array<SnappedVertex>(held.bits.count);
    exec.each(
        "move held", held.bits.count,
        MoveShallow<Field>{refinement, at, held, {shallow}, height, all_weak, first_weak, moved, placed});
    const auto weak = exec.template array<tetra_kernel::WeakVertex>(place_counts(exec, first_weak));
    exec.each("list weak", held.bits.count, ListWeak{first_weak, all_weak, weak});

    const CountedBits ranked = rank_bits(exec, placed);
    const auto place = exec.template array<Vec3>(ranked.count);
    const auto way = exec.template array<float>(ranked.count);
    exec.each("note places", near.size(), NotePlaces{near, ranked.view, place, way});
    exec.each("note places", moved.size(), NotePlaces{moved, ranked.view, place, way});

    DeviceSamples out;
    out.inside = exec.template array<std::uint64_t>(placed.size());
    out.on = exec.template array<std::uint64_t>(placed.size());
    out.moved = exec.template array<std::uint64_t>(placed.size());
    exec.each("note sides", placed.size(),
              NoteSides{{above}, is_held, {placed}, out.inside, out.on, out.moved});
    out.above = {above};
    out.placed_count = ranked.count;
    out.view = {height, {out.inside}, {out.on}, is_held, {out.moved}, ranked.view, place, way, weak};
    return out;
}

/// Returns faces of the hull with vertices on both sides, ascending, of requested tetrahedra. Waits.
template <class Exec>
std::vector<TetraFace> open_faces(Exec& exec, const DeviceRefinement& refinement,
                                  const DeviceSamples& samples) {
    const std::size_t faces = 4 * refinement.tetra.size();
    const auto marks = no_bits(exec, faces);
    exec.each("open faces", faces, MarkOpenFaces{refinement, samples.view.inside, marks});
    const std::span<const std::uint32_t> list = list_bits(exec, marks);
    std::vector<std::uint32_t> found(list.size());
    exec.download(list, std::span(found));
    std::vector<TetraFace> out;
    for (const std::uint32_t i : found) {
        if (refinement.is_own(i / 4)) out.push_back({i / 4, i % 4});
    }
    return out;
}

}  // namespace coppice::cuda
