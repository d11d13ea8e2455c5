#include <algorithm>
#include <cmath>
#include <utility>

#include "coppice/base/kernel/round_cone.h"
#include "coppice/base/parallel.h"
#include "coppice/pipeline/deform/skin_internal.h"

namespace coppice::pipeline_internal {
namespace {

constexpr float kWindow = 1.2f;        // [radii] to both sides
constexpr float kParentWindow = 0.5f;  // [radii of the parent branch] minimum window at a lateral
constexpr float kLongestBegin = 0.9f;  // maximum share of a lateral's first segment with its parent
constexpr std::size_t kMaxShares = 24;
constexpr std::size_t kSkinGrain = 4096;

// Returns the share of a triangular window of half width 1 that is below x.
float part_below(float x) {
    if (x <= -1) return 0;
    if (x >= 1) return 1;
    return x < 0 ? 0.5f * (1 + x) * (1 + x) : 1 - 0.5f * (1 - x) * (1 - x);
}

class Shares {
  public:
    void add(NodeId segment, float share) {
        if (!(share > 0)) return;
        for (std::size_t i = 0; i < count_; ++i) {
            if (share_[i].second != segment.index()) continue;
            share_[i].first += share;
            return;
        }
        if (count_ < kMaxShares) share_[count_++] = {share, segment.index()};
    }
    Influence largest() {
        // Of equal weights the lower segment, independent of their order.
        std::sort(share_.begin(), share_.begin() + static_cast<std::ptrdiff_t>(count_),
                  [](const auto& a, const auto& b) {
                      return a.first != b.first ? a.first > b.first : a.second < b.second;
                  });
        Influence out{};
        float sum = 0;
        for (std::size_t i = 0; i < out.segment.size(); ++i) {
            out.segment[i] = share_[i < count_ ? i : 0].second;
            out.weight[i] = i < count_ ? share_[i].first : 0;
            sum += out.weight[i];
        }
        for (float& w : out.weight) w /= sum;
        return out;
    }

  private:
    std::array<std::pair<float, std::uint32_t>, kMaxShares> share_;
    std::size_t count_ = 0;
};

BasicRoundCone<float> compute_cone(const Skeleton& s, NodeId n) {
    const Segment g = s.segment(n);
    return round_cone(g.a, g.b, g.radius_a, g.radius_b);
}

}  // namespace

AxisWindow::AxisWindow(const Skeleton& skeleton) : skeleton_(skeleton), length_(skeleton.size()) {
    for (const NodeId n : nodes(skeleton)) {
        if (!skeleton.is_root(n))
            length_[n.index()] = distance(skeleton.position(n), skeleton.position(skeleton.parent(n)));
    }
}

bool AxisWindow::is_lateral(NodeId n) const {
    return skeleton_.parent(n) && skeleton_.leader(skeleton_.parent(n)) != n;
}

// [m] Returns the parameter from which a segment moves by itself.
float AxisWindow::begin(NodeId n) const {
    if (!is_lateral(n)) return 0;
    return std::min(skeleton_.radius(skeleton_.parent(n)), kLongestBegin * length_[n.index()]);
}

Influence AxisWindow::at(NodeId n, Vec3 point) const {
    Shares shares;
    if (skeleton_.is_root(n)) {
        shares.add(n, 1);
        return shares.largest();
    }
    const auto closest = compute_cone(skeleton_, n).closest_point(point);
    float half = kWindow * closest.radius;
    if (is_lateral(n)) half = std::max(half, kParentWindow * begin(n));
    const float here = closest.t * length_[n.index()];
    const auto below = [&](float x) { return part_below((x - here) / half); };
    // Towards the tip, then from here towards the root; positions are measured from the beginning of n.
    float low = begin(n), high = length_[n.index()];
    shares.add(n, below(high) - below(low));
    NodeId last = n;
    while (below(high) < 1) {
        const NodeId next = skeleton_.leader(last);
        if (!next) break;
        shares.add(next, below(high + length_[next.index()]) - below(high));
        high += length_[next.index()];
        last = next;
    }
    shares.add(last, 1 - below(high));
    NodeId first = n;
    while (below(low) > 0) {
        const NodeId parent = skeleton_.parent(first);
        if (skeleton_.is_root(parent)) break;
        const float own = length_[parent.index()] - begin(parent);
        shares.add(parent, below(low) - below(low - own));
        low -= own;
        first = parent;
    }
    if (is_lateral(first) && skeleton_.is_root(skeleton_.parent(first)))
        first = skeleton_.leader(skeleton_.parent(first));
    shares.add(first, below(low));
    return shares.largest();
}

NodeId AxisWindow::nearest_adjacent(NodeId n, Vec3 point) const {
    if (skeleton_.is_root(n) && skeleton_.is_tip(n)) return n;
    NodeId best;
    float least = 0;
    const auto look = [&](NodeId m) {
        if (!m || skeleton_.is_root(m)) return;
        const float rho = compute_cone(skeleton_, m).closest_point(point).relative_squared();
        if (best && !(rho < least)) return;
        best = m;
        least = rho;
    };
    look(n);
    look(skeleton_.parent(n));
    for (const NodeId c : skeleton_.children(n)) look(c);
    return best;
}

std::vector<SegmentMove> segment_moves(const Skeleton& rest, const Skeleton& now,
                                       std::span<const Rotation> turns) {
    std::vector<SegmentMove> moves(rest.size());
    for (const NodeId n : nodes(rest)) {
        SegmentMove& move = moves[n.index()];
        const NodeId start = rest.is_root(n) ? n : rest.parent(n);
        move.from = rest.position(start);
        move.to = now.position(start);
        move.growth = 0.5f * (now.radius(n) / rest.radius(n) + now.radius(start) / rest.radius(start));
        const Vec3d way = Vec3d(rest.position(n)) - Vec3d(move.from);
        const Vec3d way_now = Vec3d(now.position(n)) - Vec3d(move.to);
        Rotation turn = turns[n.index()];
        if (length_squared(way) > 0 && length_squared(way_now) > 0)
            turn = unit(rotation_between(turn(way), way_now) * turn);
        const double stretch = length_squared(way) > 0 ? length(way_now) / length(way) : 1;
        const Vec3d axis = normalized(way);
        const std::array<Vec3d, 3> unit_vectors{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
        for (std::size_t k = 0; k < 3; ++k)
            move.along[k] = Vec3(turn(unit_vectors[k] + axis * ((stretch - 1) * dot(axis, unit_vectors[k]))));
        move.turn = {static_cast<float>(turn.w), static_cast<float>(turn.v.x), static_cast<float>(turn.v.y),
                     static_cast<float>(turn.v.z)};
    }
    return moves;
}

Vec3 moved(const SegmentMove& m, Vec3 p) {
    const Vec3 v = p - m.from;
    return m.to + m.along[0] * v.x + m.along[1] * v.y + m.along[2] * v.z;
}

void deform_points(std::span<const Influence> influences, std::span<const SegmentMove> moves,
                   std::span<const Vec3> rest_anchors, std::span<const Vec3> rest_positions,
                   std::span<Vec3> anchors, std::span<Vec3> positions, const Context& ctx) {
    parallel_for(ctx, influences.size(), kSkinGrain, [&](std::size_t v) {
        const Influence& by = influences[v];
        const Vec3 anchor = rest_anchors[v];
        const std::array<float, 4>& first = moves[by.segment[0]].turn;
        Vec3 place;
        std::array<float, 4> turn{};
        float growth = 0;
        for (std::size_t i = 0; i < by.segment.size() && by.weight[i] > 0; ++i) {
            const SegmentMove& m = moves[by.segment[i]];
            place += moved(m, anchor) * by.weight[i];
            growth += m.growth * by.weight[i];
            float same = 0;
            for (std::size_t k = 0; k < 4; ++k) same += m.turn[k] * first[k];
            const float signed_weight = same < 0 ? -by.weight[i] : by.weight[i];
            for (std::size_t k = 0; k < 4; ++k) turn[k] += m.turn[k] * signed_weight;
        }
        const float square = turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2] + turn[3] * turn[3];
        const float scale = square > 0 ? 2 / square : 0;
        const Vec3 axis{turn[1], turn[2], turn[3]};
        const Vec3 offset = rest_positions[v] - anchor;
        const Vec3 t = cross(axis, offset);
        anchors[v] = place;
        positions[v] = place + (offset + (t * turn[0] + cross(axis, t)) * scale) * growth;
    });
}

}  // namespace coppice::pipeline_internal
