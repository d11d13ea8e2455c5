#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/cuda/tetra/extract_kernel_internal.h"
#include "coppice/cuda/tetra/samples_stages_internal.h"
#include "coppice/cuda/tetra/unsnap_stages_internal.h"

namespace coppice::cuda {

/// A surface on an executor.
struct DeviceSurface {
    std::span<const Vec3> positions;      ///< [m]
    std::span<const Triangle> triangles;  ///< counter-clockwise seen from outside
};

/// The vertices of a surface: first those that were moved onto it, then those of cut edges.
struct SurfaceVertices {
    CountedBits moved;                          ///< of fine vertices
    CountedBits cuts;                           ///< of fine edges
    std::span<const std::uint32_t> moved_list;  ///< list of these vertices
    std::span<const std::uint32_t> cut_list;    ///< list of these edges
    std::span<const Vec3> position;             ///< [m] of all vertices
};

/// Numbers and positions the vertices of the surface in these fine tetrahedra, in the order of FineNumbers.
/// Waits.
template <class Exec, class Field>
SurfaceVertices place_vertices(Exec& exec, const FineCrossings& crossings,
                               std::span<const std::uint32_t> crossed, const SnapField<Field>& at,
                               int refinements) {
    const DeviceRefinement& refinement = crossings.refinement;
    const auto moved = no_bits(exec, refinement.vertex_count), cuts = no_bits(exec, refinement.edge_count);
    exec.each("mark corners", crossed.size(), MarkCorners{crossings, crossed, moved, cuts});
    SurfaceVertices out;
    out.moved = rank_bits(exec, moved);
    out.cuts = rank_bits(exec, cuts);
    out.moved_list = list_bits(exec, out.moved);
    out.cut_list = list_bits(exec, out.cuts);
    const auto position = exec.template array<Vec3>(std::size_t{out.moved.count} + out.cuts.count);
    exec.each("place moved", out.moved.count, PlaceMoved{crossings.samples, out.moved_list, position});
    exec.each("place cuts", out.cuts.count,
              PlaceCut<Field>{refinement, at.field, at.profile, crossings.samples, refinements, out.cut_list,
                              position.subspan(out.moved.count)});
    out.position = position;
    return out;
}

/// Creates the surface in these fine tetrahedra, in their order. Waits.
template <class Exec>
DeviceSurface write_triangles(Exec& exec, const FineCrossings& crossings,
                              std::span<const std::uint32_t> crossed, const SurfaceVertices& vertices) {
    const auto first = exec.template array<std::uint32_t>(crossed.size() + 1);
    exec.each("count triangles", crossed.size(), CountTriangles{crossings, crossed, first});
    const auto triangles = exec.template array<Triangle>(place_counts(exec, first));
    exec.each("triangles", crossed.size(),
              WriteTriangles{crossings, crossed, first, vertices.moved.view, vertices.cuts.view,
                             vertices.moved.count, vertices.position, triangles});
    return {vertices.position, triangles};
}

/// Returns the positions of the vertices of a surface in the refined mesh. Waits.
template <class Exec>
std::vector<SurfacePlace> name_vertices(Exec& exec, const DeviceRefinement& refinement,
                                        const SurfaceVertices& vertices) {
    const auto places = exec.template array<SurfacePlace>(vertices.position.size());
    exec.each("name vertices", places.size(),
              NameVertices{refinement, vertices.moved_list, vertices.cut_list, places});
    std::vector<SurfacePlace> out(places.size());
    exec.download(std::span<const SurfacePlace>(places), std::span(out));
    return out;
}

}  // namespace coppice::cuda
