#pragma once

#include <utility>
#include <vector>

#include "coppice/base/rotation.h"
#include "coppice/edit/editable_tree.h"

namespace coppice::edit_internal {

/// Similarity transformation of a branch: rotation and scaling about `from`, which moves to `to`. A negative
/// factor mirrors.
struct Motion {
    Vec3 from;
    Vec3d to;
    Rotation turn;
    double factor = 1;

    friend bool operator==(const Motion&, const Motion&) = default;
};

/// Returns the image of p. A single function, so that redoing a motion is bit-identical.
Vec3 moved(const Motion& motion, Vec3 p);
/// Returns the preimage of p, up to rounding.
Vec3 moved_back(const Motion& motion, Vec3 p);

}  // namespace coppice::edit_internal

namespace coppice {

struct EditableTree::Moves {
    std::vector<edit_internal::Motion> motions;
    std::vector<std::pair<StableId, std::uint32_t>>
        followers;  ///< nodes, and the index of the motion that moved each

    void keep_followed(const Nodes& before, const EditableTree& tree);
};

}  // namespace coppice
