#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/measure/sides.h"
#include "coppice/measure/vertex_places.h"
#include "coppice/mesh/mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// How densely a surface covers branches of like thickness.
struct DensityClass {
    double radius = 0;           ///< [units] maximum of the class; its minimum is half of that
    double length = 0;           ///< [radii] of the axes in it
    std::uint64_t vertices = 0;  ///< closest to an axis in it
    double percent = 0;          ///< of all vertices

    /// Vertices for each radius of length; 0 for none.
    double per_radius() const { return length > 0 ? static_cast<double>(vertices) / length : 0; }
    friend bool operator==(const DensityClass&, const DensityClass&) = default;  ///< member by member
};

/// How edges run along branches, and how densely.
struct EdgeFlowReport {
    /// Regular vertices (see VertexPlaces) farther than two radii from every node with three neighbours.
    std::uint64_t vertices = 0;
    /// Of those: on a closed loop of edges that runs once round the axis, straight on through vertices of
    /// four faces.
    std::uint64_t on_rings = 0;
    std::vector<DensityClass> classes;  ///< by radius, largest first, without empty ones

    /// 100 for no vertices.
    double on_rings_percent() const {
        return vertices > 0 ? 100.0 * static_cast<double>(on_rings) / static_cast<double>(vertices) : 100;
    }
    friend bool operator==(const EdgeFlowReport&, const EdgeFlowReport&) = default;  ///< member by member
};

/// Follows all loops of edges of a valid mesh. `sides` and `places` must be those of the mesh along this
/// skeleton. O(n + k log k), n vertices near k nodes; the same for any number of threads.
EdgeFlowReport edge_flow(const PolygonMesh& mesh, const Buffer<Side>& sides, const Skeleton& skeleton,
                         const CapsuleTree& capsules, const VertexPlaces& places, const Context& ctx = {});

/// Calls visit(name, number) for every member, in order.
/// @{
template <class Visitor>
void visit_figures(const DensityClass& c, Visitor&& visit) {
    visit("radius", c.radius);
    visit("length_radii", c.length);
    visit("vertices", c.vertices);
    visit("vertices_percent", c.percent);
    visit("per_radius", c.per_radius());
}
template <class Visitor>
void visit_figures(const EdgeFlowReport& r, Visitor&& visit) {
    visit("vertices", r.vertices);
    visit("on_rings", r.on_rings);
    visit("on_rings_percent", r.on_rings_percent());
}
/// @}

}  // namespace coppice
