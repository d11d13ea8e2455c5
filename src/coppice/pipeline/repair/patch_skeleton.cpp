#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "coppice/base/id.h"
#include "coppice/base/sort.h"
#include "coppice/pipeline/repair/removed_rows_internal.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice::pipeline_internal {
namespace {

// [radii] margin of the field's skeleton beyond a cut ring, and its minimum.
constexpr float kMargin = 3.5f;
constexpr float kMinMargin = 2.0f;

// The columns of a skeleton with nodes inserted where cut rings cross its segments.
struct CutSkeleton {
    std::vector<NodeId> parent;
    std::vector<Vec3> position;
    std::vector<float> radius;
    std::vector<TubeRow> tube_row;  // per node: a row that wraps its segment, or none
    std::vector<float> until;

    NodeId append(NodeId from, Vec3 p, float r, TubeRow s, float f = 1) {
        parent.push_back(from);
        position.push_back(p);
        radius.push_back(r);
        tube_row.push_back(s);
        until.push_back(f);
        return NodeId(static_cast<std::uint32_t>(parent.size() - 1));
    }
};

// [radii] A node that is so close to the end of a segment is identified with it.
constexpr float kSameNode = 0.25f;

// Positions of cut rings, as parameters of their tubes' axes.
struct SeamPlace {
    NodeId tube;
    float t;
    bool at_node = false;  // at the beginning of the tube
    friend auto operator<=>(const SeamPlace&, const SeamPlace&) = default;
};

std::vector<SeamPlace> seam_places(std::span<const CutRing> cut_rings, const TubeRows& tube_rows) {
    std::vector<SeamPlace> out;
    for (const CutRing& cut_ring : cut_rings) {
        const TubeRow upper = cut_ring.to_tip ? cut_ring.kept : cut_ring.gone;
        const NodeId t = tube_rows.tube(upper);
        const float at = round_cone<float>(tube_rows.tubes().segment(t)).line_parameter(cut_ring.center);
        out.push_back({t, at, tube_rows.row(upper) == 0});
    }
    std::sort(out.begin(), out.end());
    return out;
}

// Nodes of the field's skeleton near a group of rows: those of its tubes, and all within a margin of them.
class Neighbourhood {
  public:
    explicit Neighbourhood(const Skeleton& s) : s_(s) {}

    void add(NodeId segment) { inside_.push_back(segment); }

    // Adds the segments within this number of radii.
    void extend(float radii) {
        sort_unique(inside_);
        for (const NodeId n : inside_) {
            reach(n, radii * s_.radius(n));
            if (!s_.is_root(n)) reach(s_.parent(n), radii * s_.segment(n).radius_a);
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
    }

    // Adds adjacent segments until there are this many.
    void extend_to(std::size_t count) {
        std::unordered_set<std::uint32_t> found;
        for (const NodeId n : inside_) found.insert(n.index());
        for (std::size_t i = 0; i < inside_.size() && inside_.size() < count; ++i) {
            const NodeId n = inside_[i];
            const auto add = [&](NodeId segment) {
                if (found.insert(segment.index()).second) inside_.push_back(segment);
            };
            for_each_segment_at(s_, n, add);
            if (!s_.is_root(n)) for_each_segment_at(s_, s_.parent(n), add);
        }
        sort_unique(inside_);
    }

    // The segments, parents first.
    std::vector<NodeId> segments() && { return std::move(inside_); }

  private:
    void reach(NodeId n, float way) {
        const auto [at, is_new] = left_.try_emplace(n.index(), way);
        if (way <= 0 || (!is_new && way <= at->second)) return;
        at->second = way;
        queue_.push_back(n);
    }

    const Skeleton& s_;
    std::vector<NodeId> inside_;
    std::unordered_map<std::uint32_t, float> left_;  // [m] remaining distance beyond a node
    std::vector<NodeId> queue_;
};

// Returns the parameters at which cut rings cut a segment of some tubes, ascending; and 1, its end.
std::vector<float> compute_cuts(const BasicRoundCone<float>& segment, std::span<const NodeId> wrapping,
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

// Of the tubes around a segment the one around a point of it, or none.
NodeId tube_at(std::span<const NodeId> wrapping, const Skeleton& tubes, Vec3 p) {
    for (const NodeId tube : wrapping) {
        const bool is_last = tube == wrapping.back();
        if (is_last || round_cone<float>(tubes.segment(tube)).line_parameter(p) <= 1) return tube;
    }
    return NodeId::none();
}

// Marks segments without a tube that are adjacent to removed segments as removed too.
void spread_to_bare(const Skeleton& s, std::span<const TubeRow> tube_row, std::vector<std::uint8_t>& gone) {
    const auto any_gone = [&](std::span<const NodeId> all) {
        return std::any_of(all.begin(), all.end(), [&](NodeId n) { return gone[n.index()] != 0; });
    };
    const auto is_bare = [&](NodeId n) { return !s.is_root(n) && tube_row[n.index()] == kNoIndex; };
    for (std::uint32_t i = s.size(); i-- > 0;) {
        if (is_bare(NodeId(i)) && any_gone(s.children(NodeId(i)))) gone[i] = 1;
    }
    for (const NodeId n : nodes(s)) {
        if (is_bare(n) && (gone[s.parent(n).index()] != 0 || any_gone(s.children(s.parent(n)))))
            gone[n.index()] = 1;
    }
}

}  // namespace

PatchSkeletons::PatchSkeletons(const QuadBuild& build, const TubeRows& tube_rows)
    : build_(build), tube_rows_(tube_rows) {
    wrapped_ = compress_rows<std::uint32_t>(build.tubes.size(), [&](const auto& put) {
        for (std::uint32_t n = 0; n < build.wrapping.size(); ++n) {
            for (const NodeId tube : build.wrapping[n]) put(tube.index(), n);
        }
    });
}

std::vector<NodeId> PatchSkeletons::segments_near(const RowGroup& group, float margin,
                                                  std::size_t count) const {
    Neighbourhood near(build_.skeleton);
    for (std::size_t i = 0; i < group.tube_rows.size(); ++i) {
        const NodeId tube = tube_rows_.tube(group.tube_rows[i]);
        if (i > 0 && tube_rows_.tube(group.tube_rows[i - 1]) == tube) continue;
        near.add(build_.cage.region_node[tube.index()]);  // in case it wraps no segment
        for (const std::uint32_t n : wrapped_[tube.index()]) near.add(NodeId(n));
    }
    near.extend(margin);
    near.extend_to(count);
    return std::move(near).segments();
}

std::vector<NodeId> PatchSkeletons::needed(const RowGroup& group) const {
    return segments_near(group, kMinMargin, 0);
}

NodeId PatchSkeleton::node_at(NodeId segment, float t) const {
    const auto at = std::lower_bound(cuts.begin(), cuts.end(), segment,
                                     [](const Cut& c, NodeId n) { return c.segment < n; });
    if (at == cuts.end() || at->segment != segment) return NodeId::none();
    std::uint32_t node = at->first;
    while (node + 1 < at->first + at->count && until[node] < t) ++node;
    return NodeId(node);
}

PatchSkeleton PatchSkeletons::of(const RowGroup& group, std::size_t count) const {
    const Skeleton& s = build_.skeleton;
    const std::vector<NodeId> segments = segments_near(group, kMargin, count);
    const std::vector<SeamPlace> places = seam_places(group.cut_rings, tube_rows_);

    CutSkeleton cut;
    std::vector<PatchSkeleton::Cut> cuts;
    std::unordered_map<std::uint32_t, NodeId> place;
    const auto find_root = [&](NodeId n) {
        const auto at = place.find(n.index());
        if (at != place.end()) return at->second;
        // The root of a section; a single lateral there keeps its own radius.
        float widest = 0;
        for (const NodeId c : s.children(n)) {
            if (std::binary_search(segments.begin(), segments.end(), c))
                widest = std::max(widest, s.segment(c).radius_a);
        }
        return place[n.index()] = cut.append(NodeId::none(), s.position(n), widest, kNoIndex);
    };
    for (const NodeId n : segments) {
        const std::span<const NodeId> wrapping = build_.wrapping[n.index()];
        if (s.is_root(n)) {
            if (s.is_tip(n) && !wrapping.empty())
                place[n.index()] =
                    cut.append(NodeId::none(), s.position(n), s.radius(n), tube_rows_.last(wrapping.back()));
            continue;
        }
        NodeId from = find_root(s.parent(n));
        const auto first = static_cast<std::uint32_t>(cut.parent.size());
        const auto segment = round_cone<float>(s.segment(n));
        float begin = 0;
        for (const float f : compute_cuts(segment, wrapping, tube_rows_.tubes(), places)) {
            const Vec3 middle = segment.point((begin + f) / 2);
            const NodeId tube = tube_at(wrapping, tube_rows_.tubes(), middle);
            const TubeRow tube_row = tube ? tube_rows_.near(tube, middle) : kNoIndex;
            from = f == 1 ? cut.append(from, s.position(n), s.radius(n), tube_row)
                          : cut.append(from, segment.point(f), segment.radius(f), tube_row, f);
            begin = f;
        }
        cuts.push_back({n, first, from.index() + 1 - first});
        place[n.index()] = from;
    }
    Skeleton skeleton(std::move(cut.parent), std::move(cut.position), std::move(cut.radius), s.origin());
    std::vector<std::uint8_t> gone(skeleton.size(), 0);
    for (std::size_t i = 0; i < gone.size(); ++i) {
        gone[i] = cut.tube_row[i] != kNoIndex &&
                  std::binary_search(group.tube_rows.begin(), group.tube_rows.end(), cut.tube_row[i]);
    }
    spread_to_bare(skeleton, cut.tube_row, gone);
    std::vector<std::uint8_t> margin(gone.size());
    for (std::size_t i = 0; i < gone.size(); ++i) margin[i] = gone[i] == 0 && cut.tube_row[i] != kNoIndex;
    return {std::move(cuts), std::move(cut.until), std::move(skeleton), std::move(cut.tube_row),
            std::move(margin)};
}

}  // namespace coppice::pipeline_internal
