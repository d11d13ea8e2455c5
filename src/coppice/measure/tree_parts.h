#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A part of a surface that no tree accounts for.
struct LoosePart {
    NodeId node;  ///< the first of those whose segments are nearest to the part: where it tore off
    Vec3d place;  ///< [m] of that node, with the skeleton's origin
    std::uint64_t faces = 0;                                               ///< of the part
    friend bool operator==(const LoosePart&, const LoosePart&) = default;  ///< member by member
};

/// The parts of a surface beside the trees of its skeleton.
struct TreePartsReport {
    static constexpr std::size_t kMostNamed = 5;  ///< parts that are named

    std::uint64_t trees = 0;         ///< of the skeleton
    std::uint64_t parts = 0;         ///< of the surface: faces joined by common vertices
    std::uint64_t loose = 0;         ///< those that no tree accounts for
    std::vector<LoosePart> largest;  ///< of these, by faces

    bool whole() const { return loose == 0; }  ///< nothing is torn off
    friend bool operator==(const TreePartsReport&, const TreePartsReport&) = default;  ///< member by member
};

/// Which parts of a surface belong to which tree. A vertex belongs to the tree whose segment is nearest, in
/// radii; a tree accounts for one part, the one with most of its vertices; trees that have grown together
/// account for one together. Any other part is loose: a branch that was torn off, a hollow, or something that
/// is no branch. Throws nothing for a valid mesh. O(vertices log segments), O(faces) where there is one part.
TreePartsReport tree_parts(const PolygonMesh& mesh, const Skeleton& skeleton, const Context& ctx = {});

/// Calls visit(name, value) for every member, in order.
template <class Visitor>
void visit_figures(const LoosePart& l, Visitor&& visit) {
    visit("node", l.node.index());
    visit("x", l.place.x);
    visit("y", l.place.y);
    visit("z", l.place.z);
    visit("faces", l.faces);
}

}  // namespace coppice
