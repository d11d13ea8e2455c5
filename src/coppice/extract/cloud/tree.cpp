#include <utility>

#include "coppice/base/id.h"
#include "coppice/extract/cloud/tree_internal.h"

namespace coppice::extract_internal {

void keep_nodes(CloudTree& tree, std::span<const std::uint8_t> kept, bool hand_down) {
    std::vector<std::uint32_t> image(tree.size());
    CloudTree out;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const std::uint32_t parent = tree.parent[n] == kNoIndex ? kNoIndex : image[tree.parent[n]];
        image[n] = parent;
        if (!kept[n]) continue;
        image[n] = out.add(parent, tree.position[n], tree.radius[n], tree.fixed[n]);
        out.weight.back() = tree.weight[n];
        out.residual.back() = tree.residual[n];
    }
    for (std::uint32_t& n : tree.node_of_point) {
        if (n != kNoIndex) n = kept[n] || hand_down ? image[n] : kNoIndex;
    }
    out.node_of_point = std::move(tree.node_of_point);
    tree = std::move(out);
}

}  // namespace coppice::extract_internal
