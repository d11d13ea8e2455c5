#include <algorithm>

#include "coppice/pipeline/live/affected_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::pipeline_internal {
namespace {

constexpr float kNear = 1.5f;  // [radii] distance within which surfaces may meet

}  // namespace

AffectedNodes affected_nodes(const EditZone& zone, std::uint8_t trusted, std::span<const NodeId> changed,
                             const Touched& touched, const PatchStore& store, const Context& ctx) {
    const Skeleton& part = zone.part;
    const NodeIndex at(part);
    AffectedNodes out{std::vector<std::uint8_t>(part.size(), 0), {}};
    std::vector<Box3> boxes = touched.boxes;
    const auto is_trusted = [&](NodeId n) { return n && zone.level[n.index()] <= trusted; };
    const auto add = [&](NodeId n, bool is_changed) {
        out.is_wanted[n.index()] = is_trusted(n) ? 1 : 0;
        const StableId own = part.stable_id(n);
        store.visit_pieces(own, [&](auto covered, auto needs) {
            if (!is_changed && !std::ranges::binary_search(covered, own)) return;
            for (const StableId id : needs) {
                if (!is_trusted(at[id])) out.missing.push_back(id);
            }
            for (const StableId id : covered) {
                const NodeId m = at[id];
                if (!is_trusted(m) || out.is_wanted[m.index()] != 0) continue;
                out.is_wanted[m.index()] = 1;
                boxes.push_back(box_about(part, m, kNear));
            }
        });
    };
    for (const StableId id : touched.ids) {
        if (at[id]) add(at[id], true);
    }
    for (const NodeId n : changed) {
        boxes.push_back(box_about(part, n, kNear));
        add(n, true);
    }
    while (!boxes.empty()) {
        const BoxTree tree(boxes, ctx);
        boxes.clear();
        for (const NodeId n : nodes(part)) {
            if (out.is_wanted[n.index()] == 0 && tree.meets(box_about(part, n, kNear))) add(n, false);
        }
    }
    return out;
}

}  // namespace coppice::pipeline_internal
