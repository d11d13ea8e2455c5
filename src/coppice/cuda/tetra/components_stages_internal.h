#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/cuda/tetra/axes_stages_internal.h"
#include "coppice/cuda/tetra/components_kernel_internal.h"
#include "coppice/cuda/tetra/extract_stages_internal.h"
#include "coppice/tetra/march/closed_components.h"

namespace coppice::cuda {

/// The connected components of a surface.
struct DeviceComponents {
    ComponentOfTriangle of;   ///< of every triangle
    std::uint32_t count = 0;  ///< number of components
};

/// Finds the components of a surface. Waits.
template <class Exec>
DeviceComponents take_apart(Exec& exec, const DeviceSurface& surface) {
    const std::size_t vertices = surface.positions.size();
    const DeviceSets sets{exec.template array<std::uint32_t>(vertices)};
    exec.each("begin sets", vertices, BeginSets{sets});
    exec.each("join triangles", surface.triangles.size(), JoinTriangles{surface.triangles, sets});
    exec.each("flatten sets", vertices, FlattenSets{sets});
    const auto number = exec.template array<std::uint32_t>(vertices + 1);
    exec.each("mark components", vertices, MarkComponents{sets, number});
    const std::uint32_t count = place_counts(exec, number);
    return {{surface.triangles, sets, number}, count};
}

/// The triangles of all components except one, as a mesh without shared vertices, and their components.
/// Waits.
struct OtherTriangles {
    TriMesh mesh;
    std::vector<std::uint32_t> component_of;
};
template <class Exec>
OtherTriangles find_others(Exec& exec, const DeviceSurface& surface, const DeviceComponents& components,
                           std::uint32_t but) {
    const auto marks = no_bits(exec, surface.triangles.size());
    exec.each("mark others", surface.triangles.size(), MarkOthers{components.of, but, marks});
    const auto list = list_bits(exec, marks);
    const auto gathered = exec.template array<ComponentTriangle>(list.size());
    exec.each("gather others", list.size(), GatherOthers{components.of, surface.positions, list, gathered});
    std::vector<ComponentTriangle> found(list.size());
    exec.download(std::span<const ComponentTriangle>(gathered), std::span(found));
    OtherTriangles out;
    for (const ComponentTriangle& t : found) {
        const auto v = static_cast<std::uint32_t>(out.mesh.positions.size());
        out.mesh.positions.insert(out.mesh.positions.end(), t.corners.begin(), t.corners.end());
        out.mesh.triangles.push_back({v, v + 1, v + 2});
        out.component_of.push_back(t.component);
    }
    return out;
}

/// Returns for each component whether it is kept (1) or not (0). The largest one usually is: since every
/// point is enclosed by some component, it is only tested if another one encloses some points. Waits.
template <class Exec>
std::vector<std::uint8_t> kept_components(Exec& exec, const DeviceSurface& surface,
                                          const DeviceComponents& components, std::span<const Vec3> places,
                                          const Context& ctx) {
    const auto size = exec.template array<std::uint32_t>(components.count);
    exec.clear(size);
    exec.each("count components", surface.triangles.size(), CountComponent{components.of, size});
    std::vector<std::uint32_t> sizes(components.count);
    exec.download(std::span<const std::uint32_t>(size), std::span(sizes));
    const auto largest = static_cast<std::uint32_t>(std::ranges::max_element(sizes) - sizes.begin());
    for (const std::uint32_t but : {largest, components.count}) {
        const OtherTriangles others = find_others(exec, surface, components, but);
        std::vector<std::uint8_t> kept =
            enclosing_components(others.mesh, others.component_of, components.count, places, true, ctx);
        if (but == components.count) return kept;
        if (std::ranges::count(kept, 1) > 0) continue;
        kept[largest] = 1;
        return kept;
    }
    return {};
}

/// Removes closed components of a surface that enclose none of these points, and hollows: see drop_parts().
/// Returns the number of removed components. Waits.
template <class Exec>
std::uint64_t drop_parts(Exec& exec, DeviceSurface& surface, std::span<const Vec3> places,
                         const Context& ctx) {
    const DeviceComponents components = take_apart(exec, surface);
    // A surface that encloses all axes has at least one component that is not a hollow.
    if (components.count <= 1) return 0;
    const std::vector<std::uint8_t> kept = kept_components(exec, surface, components, places, ctx);
    const auto dropped = static_cast<std::uint64_t>(std::ranges::count(kept, 0));
    if (dropped == 0) return 0;
    const auto is_kept = exec.upload(std::span<const std::uint8_t>(kept));
    const std::size_t vertices = surface.positions.size(), triangles = surface.triangles.size();
    const auto number = exec.template array<std::uint32_t>(vertices + 1);
    const auto place = exec.template array<std::uint32_t>(triangles + 1);
    exec.each("mark kept", vertices,
              MarkKeptVertices{components.of.sets, components.of.number, is_kept, number});
    exec.each("mark kept", triangles, MarkKept{components.of, is_kept, place});
    const auto positions = exec.template array<Vec3>(place_counts(exec, number));
    const auto out = exec.template array<Triangle>(place_counts(exec, place));
    exec.each("keep vertices", vertices, MoveKept{number, surface.positions, positions});
    exec.each("keep triangles", triangles, KeepTriangles{place, number, surface.triangles, out});
    surface.positions = positions;
    surface.triangles = out;
    return dropped;
}

/// [m] Returns the position of one held vertex of each set of axes: see held_places(); only for sets with a
/// vertex that requested tetrahedra own. Waits.
template <class Exec>
std::vector<Vec3> held_places(Exec& exec, const DeviceHeld& held, const DeviceRefinement& refinement,
                              const tetra_kernel::SamplesView& samples) {
    const auto of_each_set = first_of_sets(exec, held, refinement);
    const auto places = exec.template array<Vec3>(of_each_set.size());
    exec.each("held places", places.size(),
              GatherHeld{held.vertex, of_each_set, refinement, samples, places});
    std::vector<Vec3> out(places.size());
    exec.download(std::span<const Vec3>(places), std::span(out));
    return out;
}

}  // namespace coppice::cuda
