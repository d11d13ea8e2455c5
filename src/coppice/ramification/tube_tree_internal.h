#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/ramification/branches_internal.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::ramification_internal {

/// The skeleton of the tubes that units, rings and ends leave between them: a node at the middle of each
/// unit, at each ring of quads after the first subdivision, and at each end.
class TubeTree {
  public:
    /// Where the quads of a tube lie along its branch.
    struct Sides {
        double from = 0, to = 0;
    };

    /// Appends the root at a place of a branch.
    NodeId add_root(const Branches& branches, std::uint32_t branch, double at);
    /// Appends the node at a place of a branch, where a tube ends that begins at another.
    NodeId add(const Branches& branches, std::uint32_t branch, NodeId from, double at, Sides sides);

    Skeleton skeleton(Vec3d origin) const;  ///< of all nodes
    /// Per node: between which parameters of its tube's axis the quads lie.
    std::vector<std::array<float, 2>> sides() const;
    /// Per node: the node of the branches' skeleton about whose segment the tube is, at its middle.
    std::vector<NodeId> source(const Branches& branches) const;
    /// Per node of the branches' skeleton, of which there are so many: the tubes about its segment, in order.
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
