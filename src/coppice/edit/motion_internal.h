#pragma once

#include <utility>
#include <vector>

#include "coppice/base/rotation.h"
#include "coppice/edit/editable_tree.h"

namespace coppice::edit_internal {

/// What moves a branch as a whole: it is turned and scaled about a place, which goes to another one. A factor
/// below 0 mirrors.
struct Motion {
    Vec3 from;
    Vec3d to;
    Rotation turn;
    double factor = 1;

    friend bool operator==(const Motion&, const Motion&) = default;
};

/// Where p goes. One function, so that doing it again gives the same bits.
Vec3 moved(const Motion& motion, Vec3 p);
/// Where p was, about: rounding took the rest.
Vec3 moved_back(const Motion& motion, Vec3 p);

}  // namespace coppice::edit_internal

namespace coppice {

struct EditableTree::Moves {
    std::vector<edit_internal::Motion> motions;
    std::vector<std::pair<StableId, std::uint32_t>> followers;  ///< nodes, and by which motion they moved

    void keep_followed(const Nodes& before, const EditableTree& tree);
};

}  // namespace coppice
