#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/exec/atomics_internal.h"
#include "coppice/cuda/exec/sets_kernel_internal.h"
#include "coppice/cuda/tetra/bits_stages_internal.h"
#include "coppice/cuda/tetra/refinement_stages_internal.h"
#include "coppice/mesh/mesh.h"

// Kernels that separate a surface into connected components, and remove some of them.

namespace coppice::cuda {

/// Joins the vertices of every triangle.
struct JoinTriangles {
    std::span<const Triangle> triangles;
    DeviceSets sets;  ///< of vertices
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const Triangle& t = triangles[i];
        sets.join(t[0], t[1]);
        sets.join(t[0], t[2]);
    }
};

/// Marks the representative vertices of components.
struct MarkComponents {
    DeviceSets sets;
    std::span<std::uint32_t> count;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t v) const { count[v] = sets.parent[v] == v ? 1 : 0; }
};

/// Computes the component of every triangle.
struct ComponentOfTriangle {
    std::span<const Triangle> triangles;
    DeviceSets sets;
    std::span<const std::uint32_t> number;  ///< of the component, by its representative vertex

    COPPICE_HOST_DEVICE std::uint32_t component(std::uint32_t i) const {
        return number[sets.parent[triangles[i][0]]];
    }
};

/// Counts the triangles of every component.
struct CountComponent {
    ComponentOfTriangle of;
    std::span<std::uint32_t> size;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const { add_to(size[of.component(i)], 1u); }
};

/// Marks the triangles of all components except one.
struct MarkOthers {
    ComponentOfTriangle of;
    std::uint32_t component;
    std::span<std::uint64_t> marks;  ///< a bit for each triangle
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        if (of.component(i) != component) set_bit(marks, i);
    }
};

/// The corners of a triangle, and its component.
struct ComponentTriangle {
    std::array<Vec3, 3> corners;  ///< [m]
    std::uint32_t component;
};

/// Gathers these triangles.
struct GatherOthers {
    ComponentOfTriangle of;
    std::span<const Vec3> position;
    std::span<const std::uint32_t> list;  ///< triangles
    std::span<ComponentTriangle> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const Triangle& t = of.triangles[list[i]];
        out[i] = {{position[t[0]], position[t[1]], position[t[2]]}, of.component(list[i])};
    }
};

/// Marks the triangles of components that are kept.
struct MarkKept {
    ComponentOfTriangle of;
    std::span<const std::uint8_t> kept;  ///< by component
    std::span<std::uint32_t> count;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        count[i] = kept[of.component(i)] != 0 ? 1 : 0;
    }
};

/// Marks their vertices.
struct MarkKeptVertices {
    DeviceSets sets;
    std::span<const std::uint32_t> number;  ///< see ComponentOfTriangle
    std::span<const std::uint8_t> kept;     ///< by component
    std::span<std::uint32_t> count;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t v) const {
        count[v] = kept[number[sets.parent[v]]] != 0 ? 1 : 0;
    }
};

/// Compacts the kept vertices.
struct MoveKept {
    std::span<const std::uint32_t> number;  ///< with one additional element
    std::span<const Vec3> from;
    std::span<Vec3> to;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t v) const {
        if (number[v] != number[v + 1]) to[number[v]] = from[v];
    }
};

/// Compacts the kept triangles.
struct KeepTriangles {
    std::span<const std::uint32_t> place;   ///< with one additional element
    std::span<const std::uint32_t> number;  ///< of vertices
    std::span<const Triangle> from;
    std::span<Triangle> to;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        if (place[i] == place[i + 1]) return;
        const Triangle& t = from[i];
        to[place[i]] = {number[t[0]], number[t[1]], number[t[2]]};
    }
};

/// [m] Computes the position of the vertex for each set of axes.
struct GatherHeld {
    std::span<const std::uint32_t> held;         ///< fine vertices, by rank
    std::span<const std::uint32_t> of_each_set;  ///< ranks
    DeviceRefinement refinement;
    tetra_kernel::SamplesView samples;
    std::span<Vec3> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t i) const {
        const std::uint32_t v = held[of_each_set[i]];
        if (samples.moved.test(v)) {
            out[i] = samples.place[samples.placed.rank(v)];
            return;
        }
        const FinePlace place = refinement.view.vertices.place(v);
        const OwnedElement owner = refinement.owner(place);
        out[i] = refinement.view.position(
            owner.tetra, refinement.view.pattern(owner.tetra).first_vertex[owner.group] + place.index);
    }
};

}  // namespace coppice::cuda
