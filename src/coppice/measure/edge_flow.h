#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/measure/vertex_places.h"
#include "coppice/mesh/half_edges.h"
#include "coppice/mesh/mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// The density of a surface on branches of similar thickness.
struct DensityClass {
    double radius = 0;           ///< [units] maximum of the class; its minimum is half of that
    double length = 0;           ///< [radii] of the axes in the class
    std::uint64_t vertices = 0;  ///< number of vertices closest to an axis in the class
    double percent = 0;          ///< of all vertices

    /// Returns the number of vertices per radius of length; 0 if there is no length.
    double per_radius() const { return length > 0 ? static_cast<double>(vertices) / length : 0; }
    friend bool operator==(const DensityClass&, const DensityClass&) = default;  ///< member by member
};

/// Statistics of how edges follow branches, and of the vertex density.
struct EdgeFlowReport {
    /// Regular vertices (see VertexPlaces) farther than two radii from every node with three neighbours.
    std::uint64_t vertices = 0;
    /// Of those: vertices on a closed loop of edges that winds once around the axis and is straight at
    /// vertices of four faces.
    std::uint64_t on_rings = 0;
    std::vector<DensityClass> classes;  ///< by radius, largest first, without empty classes

    /// 100 if there are no vertices.
    double on_rings_percent() const {
        return vertices > 0 ? 100.0 * static_cast<double>(on_rings) / static_cast<double>(vertices) : 100;
    }
    friend bool operator==(const EdgeFlowReport&, const EdgeFlowReport&) = default;  ///< member by member
};

/// Follows all loops of edges of a valid mesh. `edges` and `places` must be computed from the mesh and this
/// skeleton. O(n + k log k) for n vertices near k nodes. The result does not depend on the number of threads.
EdgeFlowReport edge_flow(const PolygonMesh& mesh, const HalfEdges& edges, const Skeleton& skeleton,
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
