#pragma once

#include <cstdint>
#include <span>

#include "coppice/cuda/tetra/extract_kernel.h"
#include "coppice/cuda/tetra/samples_stages.h"
#include "coppice/cuda/tetra/unsnap_stages.h"

namespace coppice::cuda {

/// A surface on an executor.
struct DeviceSurface {
    std::span<const Vec3> positions;      ///< [m]
    std::span<const Triangle> triangles;  ///< counter-clockwise seen from outside
    std::uint32_t crossed = 0;            ///< fine tetrahedra that it passes through
};

/// How vertices of a surface are numbered: those that were moved onto it first.
struct SurfaceVertices {
    std::span<const std::uint32_t> placed;  ///< number by rank in `placed`, and one more
    std::uint32_t placed_count = 0;         ///< of those in use
    tetra_kernel::RankedView cuts;          ///< of fine edges: rank is number less placed_count
    std::span<const Vec3> position;         ///< [m] of all
};

/// Numbers and places the vertices of a surface in these fine tetrahedra. Waits.
template <class Exec, class Field>
SurfaceVertices place_vertices(Exec& exec, const FineCrossings& crossings,
                               std::span<const std::uint32_t> crossed, const SnapField<Field>& at,
                               int refinements, std::span<const tetra_kernel::Fan> fans) {
    const DeviceRefinement& refinement = crossings.refinement;
    SurfaceVertices out;
    const auto placed = exec.template array<std::uint32_t>(fans.size() + 1);
    exec.each("mark moved", fans.size(), MarkUsed{fans, placed});
    out.placed_count = place_counts(exec, placed);
    out.placed = placed;
    const auto marks = no_bits(exec, refinement.edge_count);
    exec.each("mark cuts", crossed.size(), MarkCuts{crossings, crossed, marks});
    const CountedBits ranked = rank_bits(exec, marks);
    out.cuts = ranked.view;
    const auto cuts = list_bits(exec, ranked);
    const auto position = exec.template array<Vec3>(std::size_t{out.placed_count} + ranked.count);
    exec.each("place moved", fans.size(), PlaceMoved{placed, crossings.samples.place, position});
    exec.each("place cuts", cuts.size(),
              PlaceCut<Field>{refinement, at.field, at.profile, crossings.samples, refinements, cuts,
                              position.subspan(out.placed_count)});
    out.position = position;
    return out;
}

/// The surface that the signs make: vertices moved onto it first, then those of cut edges in the order of
/// FineNumbers; triangles by fine tetrahedron. Waits.
template <class Exec, class Field>
DeviceSurface extract(Exec& exec, const FineCrossings& crossings, const SnapField<Field>& at, int refinements,
                      const Unsnapped& unsnapped) {
    const auto crossed = list_bits(exec, unsnapped.crossed);
    const SurfaceVertices vertices =
        place_vertices(exec, crossings, crossed, at, refinements, unsnapped.fans);
    const auto first = exec.template array<std::uint32_t>(crossed.size() + 1);
    exec.each("count triangles", crossed.size(), CountTriangles{crossings, crossed, first});
    const auto triangles = exec.template array<Triangle>(place_counts(exec, first));
    exec.each("triangles", crossed.size(),
              WriteTriangles{crossings, crossed, first, vertices.cuts, vertices.placed, vertices.placed_count,
                             vertices.position, triangles});
    return {vertices.position, triangles, static_cast<std::uint32_t>(crossed.size())};
}

}  // namespace coppice::cuda
