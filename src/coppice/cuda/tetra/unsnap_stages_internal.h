#pragma once

#include <cstdint>
#include <span>

#include "coppice/cuda/tetra/samples_stages_internal.h"
#include "coppice/cuda/tetra/unsnap_kernel_internal.h"

// Moves vertices back in the same rounds as unsnap_vertices() on the CPU: the vertices of a round depend only
// on the previous round, not on an order.

namespace coppice::cuda {

/// Moves vertices back to their original positions.
template <class Exec>
void put_back(Exec& exec, std::span<const std::uint32_t> vertices, const DeviceSamples& samples) {
    exec.each("put back", vertices.size(),
              PutBack{vertices, samples.above, samples.view.held, samples.inside, samples.on, samples.moved});
}

/// Returns the coarse tetrahedra around vertices, ascending. Waits.
template <class Exec>
std::span<const std::uint32_t> tetra_around(Exec& exec, const DeviceRefinement& refinement,
                                            std::span<const std::uint32_t> vertices) {
    const auto marks = no_bits(exec, refinement.tetra.size());
    exec.each("tetrahedra around", vertices.size(), MarkAround{refinement, vertices, marks});
    return list_bits(exec, marks);
}

/// Runs a kernel for every fine tetrahedron in some coarse ones.
template <class Exec, class Kernel>
void each_fine(Exec& exec, const char* name, const DeviceRefinement& refinement,
               std::span<const std::uint32_t> tetra, const Kernel& kernel) {
    exec.each(name, tetra.size() << 3 * refinement.view.levels, kernel);
}

/// Moves vertices back until no fine tetrahedron is inverted or flat; returns the number of rounds. Waits.
template <class Exec>
int unfold(Exec& exec, const DeviceRefinement& refinement, const DeviceSamples& samples) {
    const auto marks = no_bits(exec, refinement.vertex_count);
    const FindFold find{refinement, samples.view, marks};
    exec.each("folds", refinement.tetra_count, find);
    for (int rounds = 0;; ++rounds) {
        const auto mark = exec.mark();
        const std::span<const std::uint32_t> folds = list_bits(exec, marks);
        if (folds.empty()) return rounds;
        put_back(exec, folds, samples);
        exec.clear(marks);
        const std::span<const std::uint32_t> tetra = tetra_around(exec, refinement, folds);
        each_fine(exec, "folds", refinement, tetra, FindFoldIn{find, tetra});
        exec.rewind(mark);
    }
}

/// Result of moving vertices back.
struct Unsnapped {
    std::span<tetra_kernel::Fan> fans;  ///< by rank in `placed`
    std::span<std::uint64_t> crossed;   ///< a bit for each fine tetrahedron that the surface crosses
    int rounds = 0;  ///< number of rounds that moved vertices back, each near those of the previous one
};

/// Determines the fans of vertices on the surface as far as ListedFan can, by rank. Waits.
template <class Exec>
void find_fans(Exec& exec, const FineCrossings& crossings, const Unsnapped& out) {
    const auto mark = exec.mark();
    const auto crossed = list_bits(exec, out.crossed);
    const auto size = exec.template array<std::uint32_t>(out.fans.size());
    const auto fans = exec.template array<tetra_kernel::ListedFan>(out.fans.size());
    exec.clear(size);
    exec.each("list fans", crossed.size(), ListFans{crossings, crossed, size, fans});
    exec.each("judge fans", fans.size(), JudgeFan{size, fans, out.fans});
    exec.rewind(mark);
}

/// Marks the crossed tetrahedra, and determines the fans of vertices as far as ListedFan can. Waits.
template <class Exec>
Unsnapped begin_fans(Exec& exec, const FineCrossings& crossings, std::size_t placed_count) {
    const std::uint32_t tetra = crossings.refinement.tetra_count;
    const Unsnapped out{exec.template array<tetra_kernel::Fan>(placed_count), no_bits(exec, tetra), 0};
    exec.each("mark crossed", tetra, MarkCrossed{crossings, out.crossed});
    find_fans(exec, crossings, out);
    return out;
}

/// Determines the exact fans of vertices, and marks those that cannot stay. Waits.
template <class Exec>
void settle(Exec& exec, const ExactFans& exact, std::span<const std::uint32_t> vertices,
            std::span<tetra_kernel::Fan> fans, std::span<std::uint64_t> marks) {
    const auto first = exec.template array<std::uint32_t>(vertices.size() + 1);
    exec.each("count fans", vertices.size(), CountFan{exact, vertices, first});
    const auto segments = exec.template array<ExactFans::Segment>(place_counts(exec, first));
    exec.each("settle fans", vertices.size(), SettleFan{exact, vertices, first, segments, fans, marks});
}

/// Moves vertices back until no fine tetrahedron is inverted or flat, and the triangles around each vertex on
/// the surface form one closed fan, or there are no triangles. Waits.
template <class Exec>
Unsnapped unsnap(Exec& exec, const FineCrossings& crossings, const DeviceSamples& samples) {
    const DeviceRefinement& refinement = crossings.refinement;
    const int unfolded = unfold(exec, refinement, samples);
    Unsnapped out = begin_fans(exec, crossings, samples.placed_count);
    out.rounds = unfolded;
    const auto open = no_bits(exec, refinement.vertex_count), back = no_bits(exec, refinement.vertex_count);
    const auto placed = list_bits(exec, CountedBits{samples.view.placed, samples.placed_count});
    exec.each("unknown fans", placed.size(), MarkUnknown{out.fans, placed, open});
    for (;; ++out.rounds) {
        const auto mark = exec.mark();
        settle(exec, ExactFans{crossings}, list_bits(exec, open), out.fans, back);
        const std::span<const std::uint32_t> vertices = list_bits(exec, back);
        if (vertices.empty()) return out;
        put_back(exec, vertices, samples);
        // Vertices that are moved back can only change the fans of their neighbours, and invert tetrahedra
        // around them.
        exec.each("forget fans", vertices.size(), ForgetFan{vertices, samples.view.placed, out.fans});
        exec.clear(open);
        exec.clear(back);
        exec.each("neighbours", vertices.size(), MarkNeighbours{refinement, samples.view.on, vertices, open});
        const std::span<const std::uint32_t> tetra = tetra_around(exec, refinement, vertices);
        each_fine(exec, "folds", refinement, tetra, FindFoldIn{{refinement, samples.view, back}, tetra});
        each_fine(exec, "mark crossed", refinement, tetra, MarkCrossedIn{crossings, tetra, out.crossed});
        exec.rewind(mark);
    }
}

}  // namespace coppice::cuda
