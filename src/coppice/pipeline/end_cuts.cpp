#include "coppice/base/parallel.h"
#include "coppice/pipeline/end_cuts_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {
namespace {

constexpr std::size_t kEndCutsGrain = 256;

}  // namespace

bool ends_flat(const Skeleton& skeleton, NodeId node, const ControlOptions& ends) {
    if (skeleton.is_root(node)) return ends.base == BaseShape::flat && skeleton.children(node).size() == 1;
    return ends.tips == TipShape::flat && skeleton.is_tip(node);
}

EndCuts end_cuts(const Skeleton& skeleton, const ControlOptions& ends, std::span<const Box3> regions,
                 const Context& ctx) {
    EndCuts out;
    const auto add = [&](NodeId end, NodeId inward) {
        const Vec3 axis = skeleton.position(end) - skeleton.position(inward);
        const float l = length(axis);
        if (l > 0) out.cuts.push_back({skeleton.position(end), axis / l, skeleton.radius(end)});
    };
    for (const NodeId n : nodes(skeleton)) {
        if (ends_flat(skeleton, n, ends))
            add(n, skeleton.is_root(n) ? skeleton.leader(n) : skeleton.parent(n));
    }
    if (out.cuts.empty()) return out;
    std::vector<Box3> boxes;
    for (const tetra_kernel::EndCut& c : out.cuts)
        boxes.push_back(capsule_box(c.center, c.center, tetra_kernel::EndCut::kReach * c.radius));
    const BoxTree tree(boxes, ctx);
    std::vector<std::vector<std::uint32_t>> felt(regions.size());
    parallel_for(ctx, regions.size(), kEndCutsGrain, [&](std::size_t r) {
        tree.visit_overlapping(regions[r], [&](std::uint32_t cut) { felt[r].push_back(cut); });
    });
    out.of_region = compress_rows<std::uint32_t>(regions.size(), [&](const auto& put) {
        for (std::size_t r = 0; r < felt.size(); ++r) {
            for (const std::uint32_t cut : felt[r]) put(r, cut);
        }
    });
    return out;
}

}  // namespace coppice
