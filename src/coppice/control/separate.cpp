#include "coppice/control/separate.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/parallel.h"
#include "coppice/base/segment_distance.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {
namespace {

constexpr std::size_t kGrain = 4096;
constexpr int kPasses = 12;
// Two segments are neighbours while the way between them is shorter than this many times the sum of their
// radii ...
constexpr float kNeighbours = 5;
// ... and a search for that way ends after so many nodes.
constexpr int kMostSteps = 64;
// Branches are pushed apart to this share of the sum of their radii: contact does the rest.
constexpr float kApart = 0.9f;
// A bend fades out within this many times the push, along the branch.
constexpr float kFade = 2.5f;
// With more crossings than a few and than one in so many nodes a skeleton is a tangle: branches that bend
// apart meet the next ones, and none lies where it was given.
constexpr std::size_t kTangle = 50;
constexpr std::size_t kFewCrossings = 8;
constexpr std::size_t kMostPerGroup = 64 * BoxTree::kWidth;
// Looks at so many pairs of boxes at most: per group, or on average where that is more.
constexpr std::size_t kLooksPerGroup = std::size_t{1} << 14;
constexpr std::size_t kLooks = std::size_t{1} << 28;
// So many nodes bend along at most.
constexpr int kMostBent = 4096;
// A branch thicker than this many times the other does not give way at all.
constexpr float kStands = 2;

struct Pair {
    NodeId a, b;
};

class Separation {
  public:
    Separation(const Skeleton& s, float depth, const Context& ctx)
        : s_(s),
          depth_(depth),
          ctx_(ctx),
          position_(s.positions().begin(), s.positions().end()),
          push_(s.size()) {}

    SeparateResult run() && {
        std::uint32_t crossings = 0, moved = 0;
        std::vector<Pair> pairs = find_pairs();
        crossings = static_cast<std::uint32_t>(pairs.size());
        if (pairs.empty() || is_tangle(pairs)) return {s_, crossings, 0};
        for (int pass = 0; pass < kPasses && !pairs.empty() && !is_tangle(pairs); ++pass) {
            ctx_.throw_if_cancelled();
            for (const Pair& p : pairs) push_apart(p);
            apply();
            pairs = find_pairs();
        }
        for (const NodeId n : nodes(s_)) moved += position_[n.index()] != s_.position(n);
        return {Skeleton({s_.parents().begin(), s_.parents().end()}, std::move(position_),
                         {s_.radii().begin(), s_.radii().end()}, s_.origin()),
                crossings, moved};
    }

  private:
    bool is_tangle(const std::vector<Pair>& pairs) const {
        return pairs.size() > std::max(kFewCrossings, s_.size() / kTangle);
    }

    struct Closest {
        Vec3d on_a, on_b;
        double at_a, at_b;  ///< parameters along the segments
        float radius_a, radius_b;
    };

    Closest closest(const Pair& p) const {
        const auto end = [&](NodeId n) { return Vec3d(position_[n.index()]); };
        const Vec3d a0 = end(s_.parent(p.a)), a1 = end(p.a), b0 = end(s_.parent(p.b)), b1 = end(p.b);
        const ClosestParameters c = closest_parameters(a0, a1, b0, b1);
        const auto radius = [&](NodeId n, double t) {
            const Segment seg = s_.segment(n);
            return seg.radius_a + static_cast<float>(t) * (seg.radius_b - seg.radius_a);
        };
        return {lerp(a0, a1, c.on_a), lerp(b0, b1, c.on_b), c.on_a, c.on_b,
                radius(p.a, c.on_a),  radius(p.b, c.on_b)};
    }

    // Pairs that cross, in an order that depends on the skeleton alone.
    std::vector<Pair> find_pairs() const {
        std::vector<Box3> boxes(s_.size());
        parallel_for(ctx_, s_.size(), kGrain, [&](std::size_t i) {
            const NodeId n(static_cast<std::uint32_t>(i));
            const Vec3 from = position_[(s_.is_root(n) ? n : s_.parent(n)).index()];
            const float r =
                s_.is_root(n) ? s_.radius(n) : std::max(s_.segment(n).radius_a, s_.segment(n).radius_b);
            boxes[i] = capsule_box(from, position_[i], depth_ * r);
        });
        const BoxTree tree(boxes, ctx_);
        std::vector<std::vector<Pair>> found(tree.group_count());
        const std::size_t most_looks = std::max(kLooksPerGroup, kLooks / found.size());
        parallel_for(ctx_, found.size(), kGrain / BoxTree::kWidth, [&](std::size_t g) {
            std::size_t looks = 0;
            tree.overlaps(static_cast<std::uint32_t>(g), [&](std::uint32_t p, std::uint32_t q) {
                const NodeId a(std::min(tree.item(p), tree.item(q))), b(std::max(tree.item(p), tree.item(q)));
                if (!s_.is_root(a) && !s_.is_root(b) && crosses({a, b})) found[g].push_back({a, b});
                return ++looks < most_looks && found[g].size() < kMostPerGroup;
            });
        });
        std::vector<Pair> pairs;
        for (const auto& f : found) pairs.insert(pairs.end(), f.begin(), f.end());
        std::sort(pairs.begin(), pairs.end(),
                  [](const Pair& x, const Pair& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; });
        return pairs;
    }

    bool crosses(const Pair& p) const {
        if (s_.parent(p.a) == s_.parent(p.b) || s_.parent(p.b) == p.a) return false;
        const Closest c = closest(p);
        const float sum = c.radius_a + c.radius_b;
        return distance(c.on_a, c.on_b) < depth_ * sum && !neighbours(p, kNeighbours * sum);
    }

    // Whether the way along the skeleton from one segment to the other, themselves left out, is shorter than
    // the limit.
    bool neighbours(const Pair& p, float limit) const {
        NodeId a = p.a, b = p.b;
        float way = 0;
        for (int step = 0; step < kMostSteps; ++step) {
            if (a == b) return true;
            // Parents precede children, so the later of the two cannot be above the other.
            NodeId& later = a > b ? a : b;
            if (s_.is_root(later)) return false;
            if (later != p.a && later != p.b) {
                way += distance(s_.position(later), s_.position(s_.parent(later)));
                if (way > limit) return false;
            }
            later = s_.parent(later);
        }
        return false;
    }

    void push_apart(const Pair& p) {
        const Closest c = closest(p);
        const Vec3d between = c.on_b - c.on_a;
        const auto gap = static_cast<float>(length(between));
        const float missing = kApart * (c.radius_a + c.radius_b) - gap;
        if (missing <= 0) return;
        // Axes that meet are pushed apart across both.
        const Vec3d across =
            cross(Vec3d(position_[p.a.index()]) - c.on_a, Vec3d(position_[p.b.index()]) - c.on_b);
        const Vec3 direction(gap > 1e-3f * (c.radius_a + c.radius_b) ? normalized(between)
                                                                     : normalized(across));
        float share_a = c.radius_b / (c.radius_a + c.radius_b);
        if (c.radius_a > kStands * c.radius_b) share_a = 0;
        if (c.radius_b > kStands * c.radius_a) share_a = 1;
        bend(p.a, c.at_a, direction * (-share_a * missing));
        bend(p.b, c.at_b, direction * ((1 - share_a) * missing));
    }

    // Pushes the segment above n at parameter t, and less what is farther away along the skeleton.
    void bend(NodeId n, double t, Vec3 push) {
        const float size = length(push);
        if (size == 0) return;
        const auto l = static_cast<double>(distance(s_.position(n), s_.position(s_.parent(n))));
        const auto nearer = static_cast<float>(l * std::min(t, 1 - t));
        const float reach = kFade * size + nearer;
        struct Visit {
            NodeId node, from;
            float way;
        };
        std::vector<Visit> stack{{n, s_.parent(n), static_cast<float>(l * (1 - t)) - nearer},
                                 {s_.parent(n), n, static_cast<float>(l * t) - nearer}};
        for (int visits = 0; visits < kMostBent && !stack.empty(); ++visits) {
            const Visit v = stack.back();
            stack.pop_back();
            const float weight = 1 - std::max(v.way, 0.0f) / reach;
            if (weight <= 0) continue;
            if (!s_.is_root(v.node) && weight * size > length(push_[v.node.index()]))
                push_[v.node.index()] = push * weight;
            const auto go = [&](NodeId to) {
                if (to && to != v.from) {
                    stack.push_back({to, v.node, v.way + distance(s_.position(to), s_.position(v.node))});
                }
            };
            go(s_.parent(v.node));
            for (const NodeId c : s_.children(v.node)) go(c);
        }
    }

    void apply() {
        for (std::uint32_t i = 0; i < s_.size(); ++i) {
            position_[i] += push_[i];
            push_[i] = {};
        }
    }

    const Skeleton& s_;
    const float depth_;
    const Context& ctx_;
    std::vector<Vec3> position_;
    std::vector<Vec3> push_;
};

}  // namespace

SeparateResult separate_crossings(const Skeleton& skeleton, float depth, const Context& ctx) {
    if (depth <= 0 || skeleton.size() < 3) return {skeleton, 0, 0};
    return Separation(skeleton, depth, ctx).run();
}

}  // namespace coppice
