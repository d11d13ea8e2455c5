#include <cmath>

#include "coppice/base/parallel.h"
#include "coppice/pipeline/cut_field_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {
namespace {

constexpr float kReach = 3;  // [radii] from its center a cut is felt; the line ends before
constexpr std::size_t kCutFieldGrain = 256;
// The slope with which the quartic kernel's value^(2/5) falls at the surface, per radius: where plane and
// bark meet, distances are guessed alike on both.
constexpr float kSlope = 1.6f;

}  // namespace

bool ends_flat(const Skeleton& skeleton, NodeId node, const ControlOptions& ends) {
    if (skeleton.is_root(node)) return ends.base == BaseShape::flat && skeleton.children(node).size() == 1;
    return ends.tips == TipShape::flat && skeleton.is_tip(node);
}

CutField::CutField(FieldRef field, const Skeleton& skeleton, const ControlOptions& ends,
                   std::span<const Box3> regions, const Context& ctx)
    : field_(field) {
    const auto add = [&](NodeId end, NodeId inward) {
        const Vec3 axis = skeleton.position(end) - skeleton.position(inward);
        const float l = length(axis);
        if (l > 0) cuts_.push_back({skeleton.position(end), axis / l, skeleton.radius(end)});
    };
    for (const NodeId n : nodes(skeleton)) {
        if (ends_flat(skeleton, n, ends))
            add(n, skeleton.is_root(n) ? skeleton.leader(n) : skeleton.parent(n));
    }
    if (cuts_.empty()) return;
    std::vector<Box3> boxes;
    for (const Cut& c : cuts_) boxes.push_back(capsule_box(c.center, c.center, kReach * c.radius));
    const BoxTree tree(boxes, ctx);
    of_region_.resize(regions.size());
    parallel_for(ctx, regions.size(), kCutFieldGrain, [&](std::size_t r) {
        tree.visit_overlapping(regions[r], [&](std::uint32_t cut) { of_region_[r].push_back(cut); });
    });
}

void CutField::sample(std::uint32_t region, std::span<const Vec3> points, std::span<FieldSample> out) const {
    field_.sample(region, points, out);
    if (of_region_.empty()) return;
    for (const std::uint32_t k : of_region_[region]) {
        const Cut& cut = cuts_[k];
        const float scale = kSlope / cut.radius;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Vec3 w = points[i] - cut.center;
            if (length_squared(w) > kReach * kReach * cut.radius * cut.radius) continue;
            const float g = std::max(1 - scale * dot(w, cut.outward), 0.0f), root = std::sqrt(g);
            const float value = level() * g * g * root;
            if (value < out[i].value) out[i] = {value, -2.5f * level() * scale * g * root * cut.outward};
        }
    }
}

}  // namespace coppice
