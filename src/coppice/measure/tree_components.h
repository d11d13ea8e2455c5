#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A component of a surface that is not assigned to any tree.
struct LooseComponent {
    NodeId node;  ///< the first node of the segments nearest to the component: where it was detached
    Vec3d place;  ///< [m] position of that node, with the skeleton's origin
    std::uint64_t faces = 0;  ///< number of faces of the component
    friend bool operator==(const LooseComponent&, const LooseComponent&) = default;  ///< member by member
};

/// The components of a surface and the trees of its skeleton.
struct TreeComponentsReport {
    static constexpr std::size_t kMaxNamed = 5;  ///< maximum number of components that are listed

    std::uint64_t trees = 0;  ///< number of trees of the skeleton
    std::uint64_t parts = 0;  ///< number of components of the surface: faces connected by common vertices
    std::uint64_t loose = 0;  ///< number of components that are not assigned to any tree
    std::vector<LooseComponent> largest;  ///< the largest of these, by number of faces

    bool whole() const { return loose == 0; }  ///< no component is detached
    friend bool operator==(const TreeComponentsReport&,
                           const TreeComponentsReport&) = default;  ///< member by member
};

/// Assigns the components of a surface to trees. A vertex belongs to the tree of the nearest segment, in
/// radii; a tree is assigned the component with most of its vertices; trees that have grown together are
/// assigned one component together. Any other component is loose: a detached branch, a cavity, or a component
/// that is not a branch. Does not throw for a valid mesh. O(vertices log segments), O(faces) if there is one
/// component.
TreeComponentsReport compute_tree_components(const PolygonMesh& mesh, const Skeleton& skeleton,
                                             const Context& ctx = {});

/// Calls visit(name, value) for every member, in order.
template <class Visitor>
void visit_figures(const LooseComponent& l, Visitor&& visit) {
    visit("node", l.node.index());
    visit("x", l.place.x);
    visit("y", l.place.y);
    visit("z", l.place.z);
    visit("faces", l.faces);
}

}  // namespace coppice
