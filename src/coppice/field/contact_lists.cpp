#include "coppice/field/contact_lists.h"

#include <algorithm>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {
namespace {

constexpr std::size_t kGrain = 128;
// Beyond this many radii a rival's field is too weak to push back.
constexpr float kRivalReach = 1.15f;

/// Depth-first order makes a subtree a range of tubes.
class Kinship {
  public:
    explicit Kinship(const TubeTree& tubes) : tubes_(tubes), end_(tubes.parent.size()) {
        for (std::size_t i = end_.size(); i-- > 0;) {
            end_[i] = std::max(end_[i], static_cast<std::uint32_t>(i + 1));
            if (const NodeId p = tubes.parent[i]) end_[p.index()] = std::max(end_[p.index()], end_[i]);
        }
    }

    bool related(std::uint32_t segment, std::uint32_t region) const {
        const std::uint32_t t = tubes_.tube[segment].index();
        return contains(t, region) || contains(region, t) ||
               (tubes_.parent[t] && tubes_.parent[t] == tubes_.parent[region]);
    }

  private:
    bool contains(std::uint32_t above, std::uint32_t below) const {
        return above <= below && below < end_[above];
    }

    const TubeTree& tubes_;
    std::vector<std::uint32_t> end_;
};

std::vector<Box3> segment_boxes(const Skeleton& skeleton, const Context& ctx) {
    std::vector<Box3> boxes(skeleton.size());
    parallel_for(ctx, skeleton.size(), kGrain * 16, [&](std::size_t i) {
        const NodeId n(static_cast<std::uint32_t>(i));
        const NodeId from = skeleton.is_root(n) ? n : skeleton.parent(n);
        const float r = skeleton.is_root(n)
                            ? skeleton.radius(n)
                            : std::max(skeleton.segment(n).radius_a, skeleton.segment(n).radius_b);
        boxes[i] = capsule_box(skeleton.position(from), skeleton.position(n), kRivalReach * r);
    });
    return boxes;
}

/// Concatenates per-region lists found in parallel.
template <class Find>
CandidateLists collect(std::size_t regions, const Context& ctx, const Find& find) {
    std::vector<std::vector<std::uint32_t>> part((regions + kGrain - 1) / kGrain);
    std::vector<std::uint64_t> count(regions);
    parallel_for_ranges(ctx, regions, kGrain, [&](IndexRange range) {
        auto& list = part[range.begin / kGrain];
        for (std::size_t r = range.begin; r < range.end; ++r) {
            const std::size_t before = list.size();
            find(static_cast<std::uint32_t>(r), list);
            count[r] = list.size() - before;
        }
    });
    CandidateLists out;
    out.first.assign(regions + 1, 0);
    for (std::size_t r = 0; r < regions; ++r) out.first[r + 1] = out.first[r] + count[r];
    out.segments.reserve(out.first.back());
    for (const auto& list : part) out.segments.insert(out.segments.end(), list.begin(), list.end());
    return out;
}

}  // namespace

ContactLists find_contacts(const Skeleton& skeleton, const CandidateLists& candidates,
                           std::span<const FieldRegion> regions, const TubeTree& tubes, const Context& ctx) {
    COPPICE_ASSERT(tubes.parent.size() == regions.size() && tubes.tube.size() == skeleton.size());
    const Kinship kinship(tubes);
    ContactLists out;
    out.own = collect(regions.size(), ctx, [&](std::uint32_t r, std::vector<std::uint32_t>& list) {
        for (std::uint64_t k = candidates.first[r]; k < candidates.first[r + 1]; ++k) {
            if (kinship.related(candidates.segments[k], r)) list.push_back(candidates.segments[k]);
        }
    });
    const BoxTree tree(segment_boxes(skeleton, ctx), ctx);
    out.rivals = collect(regions.size(), ctx, [&](std::uint32_t r, std::vector<std::uint32_t>& list) {
        const Box3& box = regions[r].box;
        if (box.empty()) return;
        const auto first = static_cast<std::ptrdiff_t>(list.size());
        const double touching = 0.5;
        tree.search([&](std::uint32_t level,
                        std::uint32_t i) { return tree.level(level)[i].overlaps(box) ? 0.0 : 1.0; },
                    touching,
                    [&](std::uint32_t segment) {
                        const NodeId n(segment);
                        if (skeleton.is_root(n) && !skeleton.is_tip(n)) return;
                        if (!kinship.related(segment, r)) list.push_back(segment);
                    });
        std::sort(list.begin() + first, list.end());
    });
    return out;
}

}  // namespace coppice
