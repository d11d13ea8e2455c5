#include <algorithm>

#include "coppice/io_skeleton/axes_internal.h"

namespace coppice {

std::vector<SkeletonAxis> find_axes(const Skeleton& skeleton) {
    std::vector<SkeletonAxis> axes, open;
    for (std::uint32_t i = skeleton.size(); i-- > 0;) {
        if (skeleton.is_root(NodeId(i))) open.push_back({NodeId(i)});
    }
    while (!open.empty()) {
        const SkeletonAxis axis = open.back();
        open.pop_back();
        axes.push_back(axis);
        const auto first_new = static_cast<std::ptrdiff_t>(open.size());
        std::uint32_t place = 0;
        for (NodeId n = axis.first; n; n = skeleton.leader(n), ++place) {
            for (const NodeId child : skeleton.children(n)) {
                if (child != skeleton.leader(n)) open.push_back({child, axis.order + 1, place});
            }
        }
        std::reverse(open.begin() + first_new, open.end());
    }
    return axes;
}

bool is_in_order_of_axes(const Skeleton& skeleton, const std::vector<SkeletonAxis>& axes) {
    std::uint32_t next = 0;
    for (const SkeletonAxis& axis : axes) {
        for (NodeId n = axis.first; n; n = skeleton.leader(n)) {
            if (n.index() != next++) return false;
        }
    }
    return true;
}

}  // namespace coppice
