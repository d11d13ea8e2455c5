#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/ramification/branches_internal.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::ramification_internal {

/// Skeleton of the tubes between units, rings and ends: a node at the middle of each unit, at each ring of
/// quads after the first subdivision, and at each end.
class TubeTree {
  public:
    /// Range of the quads of a tube along its branch.
    struct Sides {
        double from = 0, to = 0;
    };

    /// Appends the root at a position of a branch.
    NodeId add_root(const Branches& branches, std::uint32_t branch, double at);
    /// Appends the node at a position of a branch at the end of a tube that begins at node `from`.
    NodeId add(const Branches& branches, std::uint32_t branch, NodeId from, double at, Sides sides);

    Skeleton skeleton(Vec3d origin) const;  ///< Returns the skeleton of all nodes.
    /// Returns per node the range of the quads of its tube, in parameters of the axis of the tube.
    std::vector<std::array<float, 2>> sides() const;
    /// Returns per node the node of the branches' skeleton with the segment around the middle of which the
    /// tube is.
    std::vector<NodeId> source(const Branches& branches) const;
    /// Returns per node of the branches' skeleton (`nodes` is their number) the tubes about its segment, in
    /// order.
    CompressedRows<NodeId> wrapping(const Branches& branches, std::uint32_t nodes) const;

  private:
    struct Tube {
        NodeId parent;
        std::uint32_t branch;
        double from, to;  // along the branch
        Sides sides;
        Vec3 position;
        float radius;
    };
    NodeId append(const Path& path, Tube tube);

    std::vector<Tube> tubes_;
};

}  // namespace coppice::ramification_internal
