#include "coppice/field/contact_lists.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"
#include "coppice/field/collect_lists_internal.h"
#include "coppice/field/list_kernel.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {
namespace {

constexpr std::size_t kContactListsGrain = 128;
// Maximum size of regions searched together, in diagonals of the first one's box.
constexpr float kLongestRun = 2;

/// Determines the tubes that blend with each other.
class TubeRelations {
  public:
    explicit TubeRelations(std::span<const NodeId> parent) : parent_(parent), end_(subtree_ends(parent)) {}

    bool related(std::uint32_t a, std::uint32_t b) const { return are_related(kin(a), kin(b)); }

  private:
    TubeRelation kin(std::uint32_t tube) const { return {tube, end_[tube], parent_[tube]}; }

    std::span<const NodeId> parent_;
    std::vector<std::uint32_t> end_;
};

/// Returns the segment of a node; the segment of a root has no length.
Segment make_line(const Skeleton& skeleton, NodeId n) {
    if (!skeleton.is_root(n)) return skeleton.segment(n);
    return {skeleton.position(n), skeleton.position(n), skeleton.radius(n), skeleton.radius(n)};
}

/// The segments inside each tube.
using Contents = CompressedRows<std::uint32_t>;
Contents group_by_tube(const TubeTree& tubes) {
    return compress_rows<std::uint32_t>(tubes.tree.size(), [&](const auto& put) {
        for (std::uint32_t s = 0; s < tubes.tube.size(); ++s) {
            if (const NodeId t = tubes.tube[s]) put(t.index(), s);
        }
    });
}

std::vector<SegmentSupport> tube_supports(const Skeleton& tree, const Contents& contents,
                                          std::span<const SegmentSupport> segments, const Context& ctx) {
    std::vector<SegmentSupport> out(tree.size());
    parallel_for(ctx, tree.size(), kContactListsGrain * 16, [&](std::size_t i) {
        const NodeId n(static_cast<std::uint32_t>(i));
        out[i] = tube_support(contents[i], segments, make_line(tree, n));
    });
    return out;
}

/// Returns the capsules of competing segments, by child node.
std::vector<SegmentSupport> competitor_capsules(const Skeleton& skeleton, const Context& ctx) {
    std::vector<SegmentSupport> capsules(skeleton.size());
    parallel_for(ctx, skeleton.size(), kContactListsGrain * 16, [&](std::size_t i) {
        const NodeId n(static_cast<std::uint32_t>(i));
        capsules[i] = competitor_capsule(make_line(skeleton, n));
    });
    return capsules;
}

/// The tubes near a region that are added to its own through joins.
class JoinedTubes {
  public:
    /// `near`: per region the tubes that are connected to it without joins.
    JoinedTubes(const TubeTree& tubes, const TubeRelations& relations,
                std::span<const SegmentSupport> supports, std::span<const FieldRegion> regions,
                const CandidateLists& near, const Context& ctx) {
        if (tubes.joins.empty()) return;
        const CompressedRows<NodeId> across = tubes_across(tubes);
        std::vector<FieldRegion> begun;  // the starts of the floods beyond the joins
        std::vector<std::uint32_t> region;
        std::vector<NodeId> seeds;
        for (std::uint32_t r = 0; r < regions.size(); ++r) {
            seeds.clear();
            for (std::uint64_t k = near.first[r]; k < near.first[r + 1]; ++k) {
                const auto beyond = across[near.segments[k]];
                seeds.insert(seeds.end(), beyond.begin(), beyond.end());
            }
            sort_unique(seeds);
            const Box3& box = regions[r].box;
            for (const NodeId seed : seeds) {
                if (!may_touch(supports[seed.index()], box, box.center(), 0.5f * box.diagonal())) continue;
                begun.push_back({box, seed});
                region.push_back(r);
            }
        }
        found_ = find_candidates(
            tubes.tree, supports, begun,
            [&](std::size_t i, NodeId t) { return relations.related(t.index(), begun[i].seed.index()); },
            ctx);
        of_region_ = group_by(region, regions.size());
    }

    /// Adds the tubes of a region to a sorted list, which remains sorted.
    void add(std::uint32_t region, std::vector<std::uint32_t>& tubes) const {
        if (of_region_.items.empty()) return;
        for (const std::uint32_t i : of_region_[region]) {
            tubes.insert(tubes.end(), found_.segments.begin() + static_cast<std::ptrdiff_t>(found_.first[i]),
                         found_.segments.begin() + static_cast<std::ptrdiff_t>(found_.first[i + 1]));
        }
        if (!of_region_[region].empty()) sort_unique(tubes);
    }

  private:
    // Per tube at a join: one of the tubes that begin or end on the other side of it.
    static CompressedRows<NodeId> tubes_across(const TubeTree& tubes) {
        const Skeleton& tree = tubes.tree;
        return compress_rows<NodeId>(tree.size(), [&](const auto& put) {
            for (const NodeJoin& join : tubes.joins) {
                const NodeId leader = tree.leader(join.node);
                put(join.end.index(), leader ? leader : join.node);
                put(join.node.index(), join.end);
                for (const NodeId c : tree.children(join.node)) put(c.index(), join.end);
            }
        });
    }

    CandidateLists found_;                     // per flood
    CompressedRows<std::uint32_t> of_region_;  // the floods of each region
};

/// Finds competing segments for runs of regions that are close to each other, with one search per run.
class CompetitorSearch {
  public:
    CompetitorSearch(const Skeleton& skeleton, std::span<const FieldRegion> regions,
                     std::span<const NodeId> tube, const CandidateLists& own, const Context& ctx)
        : skeleton_(skeleton),
          regions_(regions),
          tube_(tube),
          own_(own),
          capsules_(competitor_capsules(skeleton, ctx)),
          tree_(compute_boxes(capsules_), ctx) {}

    /// Calls put(region, segment) for regions in order, with sorted segments.
    template <class Put>
    void run(IndexRange range, const Put& put) const {
        std::vector<std::uint32_t> near;
        std::vector<Box3> boxes;
        std::vector<Ranked> found;
        for (std::size_t begin = range.begin; begin < range.end;) {
            Box3 all = regions_[begin].box;
            std::size_t end = end_of_run(begin, range.end, all);
            gather(all, near);
            if (near.size() == kMaxNear && end > begin + 1) {
                end = begin + 1;  // too many for the whole run
                gather(regions_[begin].box, near);
            }
            boxes.clear();
            for (const std::uint32_t s : near) boxes.push_back(capsules_[s].box);
            for (std::size_t r = begin; r < end; ++r) {
                filter(static_cast<std::uint32_t>(r), near, boxes, found);
                for (const Ranked& competitor : found) put(static_cast<std::uint32_t>(r), competitor.second);
            }
            begin = end;
        }
    }

  private:
    /// Signed distance to a surface, negative inside; its segment.
    using Ranked = std::pair<float, std::uint32_t>;

    static std::vector<Box3> compute_boxes(std::span<const SegmentSupport> capsules) {
        std::vector<Box3> boxes;
        boxes.reserve(capsules.size());
        for (const SegmentSupport& c : capsules) boxes.push_back(c.box);
        return boxes;
    }
    // Regions are in the order of the tree, so that consecutive ones are mostly close in space.
    std::size_t end_of_run(std::size_t begin, std::size_t limit, Box3& all) const {
        const float longest = kLongestRun * all.diagonal();
        std::size_t end = begin + 1;
        for (; end < limit; ++end) {
            Box3 more = all;
            more.extend(regions_[end].box);
            if (!(more.diagonal() <= longest)) break;
            all = more;
        }
        return end;
    }
    // Collects the segments that touch a box, sorted.
    void gather(const Box3& box, std::vector<std::uint32_t>& near) const {
        near.clear();
        if (!box.empty()) tree_.visit_overlapping(box, [&](std::uint32_t s) { return add(s, near); });
        std::sort(near.begin(), near.end());
    }
    // Returns false if the maximum number is reached.
    bool add(std::uint32_t segment, std::vector<std::uint32_t>& near) const {
        const NodeId n(segment);
        if (tube_[segment] && (!skeleton_.is_root(n) || skeleton_.is_tip(n))) near.push_back(segment);
        return near.size() < kMaxNear;
    }
    void filter(std::uint32_t region, std::span<const std::uint32_t> near, std::span<const Box3> boxes,
                std::vector<Ranked>& found) const {
        found.clear();
        const Box3& box = regions_[region].box;
        if (box.empty()) return;
        const Vec3 center = box.center();
        const float half_diagonal = 0.5f * box.diagonal();
        const std::uint32_t* own = own_.segments.data() + own_.first[region];
        const std::uint32_t* const last = own_.segments.data() + own_.first[region + 1];
        for (std::size_t k = 0; k < near.size(); ++k) {
            if (!overlap(boxes[k], box)) continue;
            const std::uint32_t s = near[k];
            while (own != last && *own < s) ++own;
            if (own != last && *own == s) continue;
            if (may_touch(capsules_[s], box, center, half_diagonal)) found.emplace_back(0.0f, s);
        }
        if (found.size() > kMaxCompetitors) keep_nearest(center, found);
    }
    void keep_nearest(Vec3 p, std::vector<Ranked>& found) const {
        for (auto& [away, s] : found) away = clearance(capsules_[s], p);
        std::nth_element(found.begin(), found.begin() + kMaxCompetitors, found.end());
        found.resize(kMaxCompetitors);
        std::sort(found.begin(), found.end(),
                  [](const Ranked& a, const Ranked& b) { return a.second < b.second; });
    }
    // Without branch instructions, because most boxes miss in unpredictable ways.
    static bool overlap(const Box3& a, const Box3& b) {
        return (a.low.x <= b.high.x) & (b.low.x <= a.high.x) & (a.low.y <= b.high.y) & (b.low.y <= a.high.y) &
               (a.low.z <= b.high.z) & (b.low.z <= a.high.z);
    }

    const Skeleton& skeleton_;
    std::span<const FieldRegion> regions_;
    std::span<const NodeId> tube_;
    const CandidateLists& own_;
    std::vector<SegmentSupport> capsules_;
    BoxTree tree_;
};

}  // namespace

std::vector<std::uint32_t> subtree_ends(std::span<const NodeId> parent) {
    std::vector<std::uint32_t> end(parent.size());
    for (std::size_t i = end.size(); i-- > 0;) {
        end[i] = std::max(end[i], static_cast<std::uint32_t>(i + 1));
        if (const NodeId p = parent[i]) end[p.index()] = std::max(end[p.index()], end[i]);
    }
    return end;
}

ContactLists find_contacts(const Skeleton& skeleton, std::span<const SegmentSupport> supports,
                           std::span<const FieldRegion> regions, const TubeTree& tubes, const Context& ctx) {
    COPPICE_ASSERT(tubes.tree.size() == regions.size() && tubes.tube.size() == skeleton.size());
    const TubeRelations relations(tubes.tree.parents());
    const Contents contents = group_by_tube(tubes);
    std::vector<FieldRegion> at_tubes(regions.begin(), regions.end());
    for (std::uint32_t r = 0; r < regions.size(); ++r) at_tubes[r].seed = NodeId(r);
    const auto is_own = [&](std::size_t r, NodeId t) {
        return relations.related(t.index(), static_cast<std::uint32_t>(r));
    };
    const std::vector<SegmentSupport> of_tubes = tube_supports(tubes.tree, contents, supports, ctx);
    const CandidateLists near = find_candidates(tubes.tree, of_tubes, at_tubes, is_own, ctx);
    const JoinedTubes joined(tubes, relations, of_tubes, regions, near, ctx);
    ContactLists out;
    out.own = collect_lists(regions.size(), kContactListsGrain, ctx, [&](IndexRange range, const auto& put) {
        std::vector<std::uint32_t> list, tubes_near;
        for (auto r = static_cast<std::uint32_t>(range.begin); r < range.end; ++r) {
            tubes_near.assign(near.segments.begin() + static_cast<std::ptrdiff_t>(near.first[r]),
                              near.segments.begin() + static_cast<std::ptrdiff_t>(near.first[r + 1]));
            joined.add(r, tubes_near);
            const Box3& box = regions[r].box;
            const Vec3 center = box.empty() ? Vec3{} : box.center();
            const float half_diagonal = box.empty() ? 0 : 0.5f * box.diagonal();
            list.clear();
            for (const std::uint32_t t : tubes_near) {
                for (const std::uint32_t s : contents[t]) {
                    const bool touches = t == r || may_touch(supports[s], box, center, half_diagonal);
                    if (touches && list.size() < kLongestList) list.push_back(s);
                }
            }
            std::sort(list.begin(), list.end());
            for (const std::uint32_t s : list) put(r, s);
        }
    });
    const CompetitorSearch search(skeleton, regions, tubes.tube, out.own, ctx);
    out.competitors = collect_lists(regions.size(), kContactListsGrain, ctx,
                                    [&](IndexRange range, const auto& put) { search.run(range, put); });
    return out;
}

}  // namespace coppice
