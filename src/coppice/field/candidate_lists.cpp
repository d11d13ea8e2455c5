#include "coppice/field/candidate_lists.h"

#include <algorithm>
#include <cstddef>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/field/collect_lists_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {
namespace {

constexpr std::size_t kCandidateListsGrain = 256;  // regions per task
constexpr std::size_t kHub = 64;  // minimum number of children, exclusive, for which a node gets a box tree
constexpr std::uint64_t kMaxEntries = std::uint64_t{1} << 20;
constexpr std::uint64_t kMinLimit = 256;
// Multiple of the longest list: maximum number of touching segments that are examined per box.
constexpr std::size_t kLooked = 4;

/// A box tree of the children of a node with many children.
class Hub {
  public:
    Hub(const Skeleton& skeleton, NodeId node, std::span<const SegmentSupport> supports, const Context& ctx)
        : node_(node), boxes_(compute_boxes(skeleton.children(node), supports, child_), ctx) {}

    NodeId node() const { return node_; }

    /// Calls visit(child) for all children with overlapping boxes, until it returns false.
    template <class Visit>
    void query(const Box3& box, const Visit& visit) const {
        boxes_.visit_overlapping(box, [&](std::uint32_t i) { return visit(child_[i]); });
    }

  private:
    static std::vector<Box3> compute_boxes(std::span<const NodeId> children,
                                           std::span<const SegmentSupport> supports,
                                           std::vector<NodeId>& listed) {
        std::vector<Box3> boxes;
        for (const NodeId c : children) {
            if (supports[c.index()].box.empty()) continue;
            listed.push_back(c);
            boxes.push_back(supports[c.index()].box);
        }
        return boxes;
    }

    NodeId node_;
    std::vector<NodeId> child_;
    BoxTree boxes_;
};

/// Flood fill of the tree from a seed. A tree has no cycles, so storing the previous segment is sufficient.
class Flood {
  public:
    Flood(const Skeleton& skeleton, std::span<const SegmentSupport> supports, std::span<const Hub> hubs,
          const MayCount& may_count)
        : skeleton_(skeleton), supports_(supports), hubs_(hubs), may_count_(may_count) {}

    /// Appends the segments of the region with this number to `out`, sorted.
    void run(std::size_t number, const FieldRegion& region, std::vector<std::uint32_t>& out) {
        number_ = number;
        NodeId seed = region.seed;
        if (skeleton_.is_root(seed) && !skeleton_.is_tip(seed)) seed = skeleton_.leader(seed);
        box_ = region.box;
        center_ = box_.empty() ? skeleton_.position(seed) : box_.center();
        half_diagonal_ = 0.5f * box_.diagonal();
        first_ = out.size();
        queue_.clear();
        accept(seed, out);
        queue_.push_back({seed, seed});
        if (!skeleton_.is_root(seed)) queue_.push_back({skeleton_.parent(seed), seed});
        for (std::size_t i = 0; i < queue_.size() && !full(out); ++i) visit(queue_[i], out);
        std::sort(out.begin() + static_cast<std::ptrdiff_t>(first_), out.end());
    }

  private:
    struct Step {
        NodeId node;
        NodeId segment;  ///< through which the node was reached
    };

    bool full(const std::vector<std::uint32_t>& out) const { return out.size() - first_ >= kLongestList; }
    static void accept(NodeId segment, std::vector<std::uint32_t>& out) { out.push_back(segment.index()); }

    bool touches(NodeId segment) const {
        return may_touch(supports_[segment.index()], box_, center_, half_diagonal_) &&
               (!may_count_ || may_count_(number_, segment));
    }

    void visit(Step step, std::vector<std::uint32_t>& out) {
        const NodeId v = step.node;
        if (v != step.segment && !skeleton_.is_root(v) && touches(v)) {
            accept(v, out);
            queue_.push_back({skeleton_.parent(v), v});
        }
        const auto consider = [&](NodeId c) {
            if (full(out)) return false;
            if (c != step.segment && touches(c)) {
                accept(c, out);
                queue_.push_back({c, c});
            }
            return true;
        };
        const auto children = skeleton_.children(v);
        if (children.size() > kHub) {
            const auto hub = std::lower_bound(hubs_.begin(), hubs_.end(), v,
                                              [](const Hub& h, NodeId n) { return h.node() < n; });
            hub->query(box_, consider);
        } else {
            for (const NodeId c : children) {
                if (!consider(c)) return;
            }
        }
    }

    const Skeleton& skeleton_;
    std::span<const SegmentSupport> supports_;
    std::span<const Hub> hubs_;
    const MayCount& may_count_;
    std::size_t number_ = 0;
    Box3 box_;
    Vec3 center_;
    float half_diagonal_ = 0;
    std::size_t first_ = 0;
    std::vector<Step> queue_;
};

std::vector<Hub> find_hubs(const Skeleton& skeleton, std::span<const SegmentSupport> supports,
                           const Context& ctx) {
    std::vector<Hub> hubs;
    for (const NodeId n : nodes(skeleton)) {
        if (skeleton.children(n).size() > kHub) hubs.emplace_back(skeleton, n, supports, ctx);
    }
    return hubs;
}

/// Keeps the segments with the smallest clearance to p.
void keep_nearest(std::span<const SegmentSupport> supports, Vec3 p, std::size_t count,
                  std::vector<std::uint32_t>& list) {
    std::vector<std::pair<float, std::uint32_t>> ranked;
    for (const std::uint32_t s : list) ranked.emplace_back(clearance(supports[s], p), s);
    std::nth_element(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(count), ranked.end());
    for (std::size_t k = 0; k < count; ++k) list[k] = ranked[k].second;
    list.resize(count);
}

}  // namespace

std::size_t longest_list(std::size_t regions) {
    return std::max<std::size_t>(kMinLimit, kMaxEntries / std::max<std::size_t>(regions, 1));
}

CandidateLists find_candidates(const Skeleton& skeleton, std::span<const SegmentSupport> supports,
                               std::span<const FieldRegion> regions, const Context& ctx) {
    return find_candidates(skeleton, supports, regions, MayCount(), ctx);
}

CandidateLists find_candidates(const Skeleton& skeleton, std::span<const SegmentSupport> supports,
                               std::span<const FieldRegion> regions, const MayCount& may_count,
                               const Context& ctx) {
    COPPICE_ASSERT(supports.size() == skeleton.size());
    COPPICE_ASSERT(std::all_of(regions.begin(), regions.end(), [&](const FieldRegion& r) {
        return r.seed && r.seed.index() < skeleton.size();
    }));
    const std::vector<Hub> hubs = find_hubs(skeleton, supports, ctx);
    const std::size_t count = regions.size();
    return collect_lists(count, kCandidateListsGrain, ctx, [&](IndexRange range, const auto& put) {
        Flood flood(skeleton, supports, hubs, may_count);
        std::vector<std::uint32_t> list;
        for (std::size_t i = range.begin; i < range.end; ++i) {
            list.clear();
            flood.run(i, regions[i], list);
            for (const std::uint32_t segment : list) put(i, segment);
        }
    });
}

CandidateLists find_touching(std::span<const SegmentSupport> supports, std::span<const Box3> regions,
                             const Context& ctx) {
    std::vector<Box3> boxes;
    std::vector<std::uint32_t> segments;
    for (std::uint32_t s = 0; s < supports.size(); ++s) {
        if (!(supports[s].radius > 0)) continue;
        boxes.push_back(supports[s].box);
        segments.push_back(s);
    }
    const BoxTree tree(boxes, ctx);
    const std::size_t limit = longest_list(regions.size());
    return collect_lists(regions.size(), kCandidateListsGrain, ctx, [&](IndexRange range, const auto& put) {
        std::vector<std::uint32_t> list;
        for (std::size_t i = range.begin; i < range.end; ++i) {
            const Vec3 center = regions[i].center();
            const float half_diagonal = 0.5f * regions[i].diagonal();
            list.clear();
            tree.visit_overlapping(regions[i], [&](std::uint32_t item) {
                const std::uint32_t s = segments[item];
                if (may_touch(supports[s], regions[i], center, half_diagonal)) list.push_back(s);
                return list.size() < kLooked * limit;
            });
            if (list.size() > limit) keep_nearest(supports, center, limit, list);
            std::sort(list.begin(), list.end());
            for (const std::uint32_t s : list) put(i, s);
        }
    });
}

}  // namespace coppice
