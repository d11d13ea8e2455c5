#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/tetra/march_kernel.h"
#include "coppice/tetra/march/fan_kernel.h"
#include "coppice/tetra/march/fold_kernel.h"

// The kernels that find which vertices cannot stay on the surface.

namespace coppice::cuda {

/// Marks of a fine tetrahedron that has turned over, or become too flat, the vertex that moved farthest.
struct FindFold {
    DeviceRefinement refinement;
    tetra_kernel::SamplesView samples;
    std::span<std::uint64_t> marks;  ///< a bit for each fine vertex

    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const RefinementView& view = refinement.view;
        const std::uint32_t t = refinement.tetra_of(i);
        const auto& corners = view.pattern(t).tetra[refinement.fine_of(i)];
        std::array<std::uint32_t, 4> vertex{};
        std::array<float, 4> way{};
        for (std::size_t k = 0; k < 4; ++k) {
            vertex[k] = view.vertex(t, corners[k]);
            if (samples.moved.test(vertex[k])) way[k] = samples.way[samples.placed.rank(vertex[k])];
        }
        if (tetra_kernel::two_longest(way) <= tetra_kernel::harmless_way(view.traits[t].width)) return;
        std::array<Vec3d, 4> now, coarse;
        for (std::size_t k = 0; k < 4; ++k) {
            now[k] = Vec3d(samples.moved.test(vertex[k]) ? samples.place[samples.placed.rank(vertex[k])]
                                                         : view.position(t, corners[k]));
            coarse[k] = Vec3d(view.positions[view.parts[t][k]]);
        }
        const double whole = tetra_kernel::tetra_volume(coarse[0], coarse[1], coarse[2], coarse[3]);
        if (!tetra_kernel::is_flat(now, whole / static_cast<double>(1u << (3 * view.levels)))) return;
        const std::uint32_t worst = tetra_kernel::farthest(vertex, way);
        set_bits(marks[worst / 64], std::uint64_t{1} << (worst % 64));
    }
};

/// Lists the triangle of a fine tetrahedron with those vertices of it that lie on the surface. They come in
/// any order, on which nothing depends.
struct ListFans {
    FineCrossings crossings;
    std::span<std::uint32_t> size;            ///< of each fan, by rank
    std::span<tetra_kernel::ListedFan> fans;  ///< the first so many of each

    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        using tetra_kernel::ListedFan;
        const tetra_kernel::Cut& cut = crossings.cut(i);
        const auto is_vertex = [&](std::uint32_t k) { return cut.corners[k] >= tetra_kernel::kCutVertex; };
        // Only those of three corners have some in vertices: one inside and the others are cut off.
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
                key[k] = ListedFan::key_of(vertex[k], vertex[k]);
            } else {
                const auto& ends = pattern.edges[pattern.tetra_edges[fine][c]];
                key[k] = ListedFan::key_of(view.vertex(t, ends[0]), view.vertex(t, ends[1]));
            }
        }
        for (std::uint32_t k = 0; k < 3; ++k) {
            if (!is_vertex(k)) continue;
            const std::uint32_t rank = crossings.samples.placed.rank(vertex[k]);
            const std::uint32_t at = add_to(size[rank], 1u);
            if (at >= ListedFan::kMost) continue;
            const auto next = key[(k + 1) % 3], last = key[(k + 2) % 3];
            if (view.traits[t].mirrored) {
                fans[rank].segments[at] = {last, next};
            } else {
                fans[rank].segments[at] = {next, last};
            }
        }
    }
};

/// Judges every fan.
struct JudgeFan {
    std::span<const std::uint32_t> size;
    std::span<const tetra_kernel::ListedFan> fans;
    std::span<tetra_kernel::Fan> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const { out[i] = fans[i].judge(size[i]); }
};

}  // namespace coppice::cuda
