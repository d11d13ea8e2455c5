#include <algorithm>

#include "coppice/base/kernel/segment_distance.h"
#include "coppice/base/parallel.h"
#include "coppice/cage/crossings_internal.h"
#include "coppice/skeleton/segment_cone.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::cage_internal {
namespace {

constexpr std::size_t kCrossingsGrain = 4096;
// Maximum number of checked pairs of boxes: per group, or on average if that is more.
constexpr std::size_t kLooksPerGroup = std::size_t{1} << 12;
constexpr std::size_t kLooks = std::size_t{1} << 24;
constexpr std::size_t kMaxPerGroup = 64 * BoxTree::kWidth;
// Segments of one axis are neighbours if the length between them is less than this many times the sum of
// their radii.
constexpr float kNeighbours = 5;
constexpr int kBisections = 14;

float max_radius(const Segment& s) { return std::max(s.radius_a, s.radius_b); }

class Search {
  public:
    Search(const Skeleton& s, const Axes& axes, const Enclosure& enclosure)
        : s_(s), axes_(axes), enclosure_(enclosure) {}

    void add(NodeId a, NodeId b, std::vector<Crossing>& out) const {
        if (s_.is_root(a) || s_.is_root(b)) return;
        if (axes_.rank(a) < axes_.rank(b)) std::swap(a, b);
        const Segment own = s_.segment(a);
        const SegmentRange parent{s_.segment(b)};
        if (axes_.find_axis(a) == axes_.find_axis(b)) {
            const float way = axes_.arc(a) - axes_.arc(b) - distance(own.a, own.b);
            if (way < kNeighbours * (max_radius(own) + max_radius(parent.segment))) return;
        }
        if (enclosure_.clearance(parent, own, nearest_parameter(own, parent)).gap >= 0) return;
        out.push_back({a, b, is_ordinary(a, b, own, parent)});
    }

  private:
    // Returns whether a lateral is outside a branch that meets its beginning before it has passed that
    // branch's end.
    bool is_ordinary(NodeId a, NodeId b, const Segment& own, const SegmentRange& parent) const {
        const NodeId base = s_.parent(a);
        if (!axes_.is_first(a) || (b != base && s_.parent(b) != base)) return false;
        const float gap = kClear * own.radius_b;
        const Clearance end = enclosure_.clearance(parent, own, 1);
        if (end.gap < gap) return false;
        const auto is_before_end = [&](float t) { return b == base ? t > 0.0f : t < 1.0f; };
        return is_before_end(end.t) ||
               is_before_end(enclosure_.clearance(parent, own, enclosure_.exit(parent, own, 0, 1, gap)).t);
    }

    const Skeleton& s_;
    const Axes& axes_;
    const Enclosure& enclosure_;
};

}  // namespace

Clearance Enclosure::clearance(const SegmentRange& parent, const Segment& own, float at) const {
    const auto cone = round_cone<float>(parent.segment), own_cone = round_cone<float>(own);
    const Vec3 p = own_cone.point(at);
    const auto closest = cone.closest_point_at(std::clamp(cone.line_parameter(p), parent.from, parent.to), p);
    return {closest.distance() - min_distance(closest.radius, own_cone.radius(at)), closest.t,
            closest.offset};
}

float nearest_parameter(const Segment& own, const SegmentRange& parent) {
    const auto cone = round_cone<float>(parent.segment);
    return static_cast<float>(closest_parameters(Vec3d(own.a), Vec3d(own.b), Vec3d(cone.point(parent.from)),
                                                 Vec3d(cone.point(parent.to)))
                                  .on_a);
}

float Enclosure::exit(const SegmentRange& parent, const Segment& own, float in, float out, float gap) const {
    for (int i = 0; i < kBisections; ++i) {
        const float middle = 0.5f * (in + out);
        (clearance(parent, own, middle).gap < gap ? in : out) = middle;
    }
    return out;
}

std::vector<Crossing> find_crossings(const Skeleton& s, const Axes& axes, const Enclosure& enclosure,
                                     const Context& ctx) {
    const Search search(s, axes, enclosure);
    std::vector<Box3> boxes(s.size());
    parallel_for(ctx, s.size(), kCrossingsGrain, [&](std::size_t i) {
        const NodeId n(static_cast<std::uint32_t>(i));
        const NodeId from = s.is_root(n) ? n : s.parent(n);
        const float r = s.is_root(n) ? 0.0f : max_radius(s.segment(n));
        boxes[i] = capsule_box(s.position(from), s.position(n), r);
    });
    const BoxTree tree(boxes, ctx);
    std::vector<std::vector<Crossing>> found(tree.group_count());
    const std::size_t max_looks = std::max(kLooksPerGroup, kLooks / found.size());
    parallel_for(ctx, found.size(), kCrossingsGrain / BoxTree::kWidth, [&](std::size_t g) {
        std::size_t looks = 0;
        tree.overlaps(static_cast<std::uint32_t>(g), [&](std::uint32_t p, std::uint32_t q) {
            search.add(NodeId(tree.item(p)), NodeId(tree.item(q)), found[g]);
            return ++looks < max_looks && found[g].size() < kMaxPerGroup;
        });
    });
    std::vector<Crossing> all;
    for (const auto& f : found) all.insert(all.end(), f.begin(), f.end());
    std::sort(all.begin(), all.end(), [](const Crossing& x, const Crossing& y) {
        return x.segment != y.segment ? x.segment < y.segment : x.parent < y.parent;
    });
    return all;
}

}  // namespace coppice::cage_internal
