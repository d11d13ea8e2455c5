#include <algorithm>
#include <unordered_map>

#include "coppice/base/sort.h"
#include "coppice/pipeline/knots/knots_internal.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice::pipeline_internal {
namespace {

// How far the field's skeleton is taken beyond a seam, and how far it has to reach, in radii.
constexpr float kMargin = 3.5f;
constexpr float kWideMargin = 8.0f;
constexpr float kLeastMargin = 2.0f;

// The columns of a skeleton with nodes put where seams cross its segments.
struct CutSkeleton {
    std::vector<NodeId> parent;
    std::vector<Vec3> position;
    std::vector<float> radius;
    std::vector<Slice> slice;  // per node: one that wraps its segment, or none
    std::vector<float> until;

    NodeId append(NodeId from, Vec3 p, float r, Slice s, float f = 1) {
        parent.push_back(from);
        position.push_back(p);
        radius.push_back(r);
        slice.push_back(s);
        until.push_back(f);
        return NodeId(static_cast<std::uint32_t>(parent.size() - 1));
    }
};

// A node that is so near to the end of a segment, in radii, is the same.
constexpr float kSameNode = 0.25f;

// Where seams lie, as parameters of their tubes' axes.
struct SeamPlace {
    NodeId tube;
    float t;
    bool at_node = false;  // where the tube begins
    friend auto operator<=>(const SeamPlace&, const SeamPlace&) = default;
};

std::vector<SeamPlace> seam_places(std::span<const Seam> seams, const Slices& slices) {
    std::vector<SeamPlace> out;
    for (const Seam& seam : seams) {
        const Slice upper = seam.to_tip ? seam.kept : seam.gone;
        const NodeId t = slices.tube(upper);
        const float at = round_cone<float>(slices.tubes().segment(t)).line_parameter(seam.center);
        out.push_back({t, at, slices.row(upper) == 0});
    }
    std::sort(out.begin(), out.end());
    return out;
}

// Nodes of the field's skeleton near a group of slices: those of its tubes, and all within a margin of them.
class Neighbourhood {
  public:
    explicit Neighbourhood(const Skeleton& s) : s_(s) {}

    void add(NodeId segment) { inside_.push_back(segment); }

    // The segments, parents first, with so many radii beyond.
    std::vector<NodeId> with_margin(float margin) && {
        std::sort(inside_.begin(), inside_.end());
        for (const NodeId n : inside_) {
            reach(n, margin * s_.radius(n));
            if (!s_.is_root(n)) reach(s_.parent(n), margin * s_.segment(n).radius_a);
        }
        while (!queue_.empty()) {
            const NodeId n = queue_.back();
            queue_.pop_back();
            const float way = left_[n.index()];
            for_each_segment_at(s_, n, [&](NodeId segment) {
                inside_.push_back(segment);
                const NodeId other = other_end(s_, segment, n);
                reach(other, way - distance(s_.position(n), s_.position(other)));
            });
        }
        sort_unique(inside_);
        return std::move(inside_);
    }

  private:
    void reach(NodeId n, float way) {
        const auto [at, is_new] = left_.try_emplace(n.index(), way);
        if (way <= 0 || (!is_new && way <= at->second)) return;
        at->second = way;
        queue_.push_back(n);
    }

    const Skeleton& s_;
    std::vector<NodeId> inside_;
    std::unordered_map<std::uint32_t, float> left_;  // [m] way that may be gone beyond a node
    std::vector<NodeId> queue_;
};

// Where seams cut a segment of some tubes, as parameters of it, ascending; and 1, where it ends.
std::vector<float> cuts_of(const BasicRoundCone<float>& segment, std::span<const NodeId> wrapping,
                           const Skeleton& tubes, std::span<const SeamPlace> places) {
    std::vector<float> cuts;
    for (const NodeId tube : wrapping) {
        if (tubes.is_root(tube)) continue;
        const auto axis = round_cone<float>(tubes.segment(tube));
        const float t0 = axis.line_parameter(segment.a), t1 = axis.line_parameter(segment.b());
        auto p = std::lower_bound(places.begin(), places.end(), SeamPlace{tube, -1e30f});
        for (; p != places.end() && p->tube == tube; ++p) {
            const float f = (p->t - t0) / (t1 - t0);
            const float end = p->at_node ? kSameNode * segment.radius(0.5f) / length(segment.axis) : 0;
            if (f > end && f < 1 - end) cuts.push_back(f);
        }
    }
    std::sort(cuts.begin(), cuts.end());
    cuts.push_back(1);
    return cuts;
}

// Of the tubes about a segment the one about a point of it, or none.
NodeId tube_at(std::span<const NodeId> wrapping, const Skeleton& tubes, Vec3 p) {
    for (const NodeId tube : wrapping) {
        const bool is_last = tube == wrapping.back();
        if (is_last || round_cone<float>(tubes.segment(tube)).line_parameter(p) <= 1) return tube;
    }
    return NodeId::none();
}

// Marks what no tube wraps beside segments that go as going too.
void spread_to_bare(const Skeleton& s, std::span<const Slice> slice, std::vector<std::uint8_t>& gone) {
    const auto any_gone = [&](std::span<const NodeId> all) {
        return std::any_of(all.begin(), all.end(), [&](NodeId n) { return gone[n.index()] != 0; });
    };
    const auto is_bare = [&](NodeId n) { return !s.is_root(n) && slice[n.index()] == Slices::kNone; };
    for (std::uint32_t i = s.size(); i-- > 0;) {
        if (is_bare(NodeId(i)) && any_gone(s.children(NodeId(i)))) gone[i] = 1;
    }
    for (const NodeId n : nodes(s)) {
        if (is_bare(n) && (gone[s.parent(n).index()] != 0 || any_gone(s.children(s.parent(n)))))
            gone[n.index()] = 1;
    }
}

}  // namespace

KnotSkeletons::KnotSkeletons(const TubeMap& map, const Slices& slices) : map_(map), slices_(slices) {
    wrapped_ = compress_rows<std::uint32_t>(map.tubes.size(), [&](const auto& put) {
        for (std::uint32_t n = 0; n < map.wrapping.size(); ++n) {
            for (const NodeId tube : map.wrapping[n]) put(tube.index(), n);
        }
    });
}

std::vector<NodeId> KnotSkeletons::segments_near(const KnotGroup& group, float margin) const {
    Neighbourhood near(map_.skeleton);
    for (std::size_t i = 0; i < group.slices.size(); ++i) {
        const NodeId tube = slices_.tube(group.slices[i]);
        if (i > 0 && slices_.tube(group.slices[i - 1]) == tube) continue;
        near.add(map_.source[tube.index()]);  // should it wrap none
        for (const std::uint32_t n : wrapped_[tube.index()]) near.add(NodeId(n));
    }
    return std::move(near).with_margin(margin);
}

std::vector<NodeId> KnotSkeletons::needed(const KnotGroup& group) const {
    return segments_near(group, kLeastMargin);
}

NodeId KnotSkeleton::node_at(NodeId segment, float t) const {
    const auto at = std::lower_bound(cuts.begin(), cuts.end(), segment,
                                     [](const Cut& c, NodeId n) { return c.segment < n; });
    if (at == cuts.end() || at->segment != segment) return NodeId::none();
    std::uint32_t node = at->first;
    while (node + 1 < at->first + at->count && until[node] < t) ++node;
    return NodeId(node);
}

KnotSkeleton KnotSkeletons::of(const KnotGroup& group, bool wide) const {
    const Skeleton& s = map_.skeleton;
    const std::vector<NodeId> segments = segments_near(group, wide ? kWideMargin : kMargin);
    const std::vector<SeamPlace> places = seam_places(group.seams, slices_);

    CutSkeleton cut;
    std::vector<KnotSkeleton::Cut> cuts;
    std::unordered_map<std::uint32_t, NodeId> place;
    const auto root_of = [&](NodeId n) {
        const auto at = place.find(n.index());
        if (at != place.end()) return at->second;
        // The root of a piece; a lateral alone there keeps the radius of its own.
        float widest = 0;
        for (const NodeId c : s.children(n)) {
            if (std::binary_search(segments.begin(), segments.end(), c))
                widest = std::max(widest, s.segment(c).radius_a);
        }
        return place[n.index()] = cut.append(NodeId::none(), s.position(n), widest, Slices::kNone);
    };
    for (const NodeId n : segments) {
        const std::span<const NodeId> wrapping = map_.wrapping[n.index()];
        if (s.is_root(n)) {
            if (s.is_tip(n) && !wrapping.empty())
                place[n.index()] =
                    cut.append(NodeId::none(), s.position(n), s.radius(n), slices_.last(wrapping.back()));
            continue;
        }
        NodeId from = root_of(s.parent(n));
        const auto first = static_cast<std::uint32_t>(cut.parent.size());
        const auto segment = round_cone<float>(s.segment(n));
        float begin = 0;
        for (const float f : cuts_of(segment, wrapping, slices_.tubes(), places)) {
            const Vec3 middle = segment.point((begin + f) / 2);
            const NodeId tube = tube_at(wrapping, slices_.tubes(), middle);
            const Slice slice = tube ? slices_.near(tube, middle) : Slices::kNone;
            from = f == 1 ? cut.append(from, s.position(n), s.radius(n), slice)
                          : cut.append(from, segment.point(f), segment.radius(f), slice, f);
            begin = f;
        }
        cuts.push_back({n, first, from.index() + 1 - first});
        place[n.index()] = from;
    }
    Skeleton skeleton(std::move(cut.parent), std::move(cut.position), std::move(cut.radius), s.origin());
    std::vector<std::uint8_t> gone(skeleton.size(), 0);
    for (std::size_t i = 0; i < gone.size(); ++i) {
        gone[i] = cut.slice[i] != Slices::kNone &&
                  std::binary_search(group.slices.begin(), group.slices.end(), cut.slice[i]);
    }
    spread_to_bare(skeleton, cut.slice, gone);
    std::vector<std::uint8_t> margin(gone.size());
    for (std::size_t i = 0; i < gone.size(); ++i) margin[i] = gone[i] == 0 && cut.slice[i] != Slices::kNone;
    return {std::move(cuts), std::move(cut.until), std::move(skeleton), std::move(cut.slice),
            std::move(margin)};
}

}  // namespace coppice::pipeline_internal
