#include "coppice/cage/separate_branches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "coppice/base/kernel/segment_distance.h"
#include "coppice/cage/crotch_internal.h"
#include "coppice/cage/openings_internal.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice {
namespace {

using cage_internal::Crotch;
using cage_internal::crotch;

// A crotch must be within this share of a segment, so that the next ring is beyond it.
constexpr float kCrotchShare = 0.75f;
// A crotch beyond this share of the distance to the leader's next branch node moves the branch to that node.
constexpr float kMoveShare = 1.0f;
// [radii] A branch node is shifted until its crotches are within this distance.
constexpr float kCrotchReach = 1.8f;
// [radii] A shift that leaves the line from the parent by more than this keeps a ring at the node.
constexpr float kCorner = 0.5f;
// Maximum number of times that a node is moved along its chain; then the next node replaces it.
constexpr std::uint8_t kMaxSlides = 64;
// [radii] A shorter leader has no room for a tube between two branch nodes.
constexpr float kShortest = 0.8f;

// [radii] A removed node with this distance from the remaining line is a bend; then a ring follows at the
// second distance.
constexpr float kBend = 0.3f;
constexpr float kRingAfterBend = 2.0f;

// Two branches that leave a root at 110 degrees or more bend there; more than two leave a side of it free if
// none is closer to its middle than 75 degrees, both by the cosine of the angle from there.
constexpr float kPairBends = -0.574f;
constexpr float kLeavesSide = 0.26f;
// [radii] Minimum length of its stem in that case.
constexpr float kShortestStem = 0.25f;

// Number of children of a branch node beyond which no node is moved: the search for pairs is quadratic.
constexpr std::size_t kMaxChildren = 64;
// [radii] Two children are paired if their stem would have this length and extend beyond the other
// crotches.
constexpr float kBundleStem = 1.0f;

class Separation {
  public:
    Separation(const Skeleton& s, std::span<const NodeJoin> joins, const Context& ctx) : s_(s), ctx_(ctx) {
        node_.reserve(s.size() + joins.size() + s.size() / 8);
        for (const NodeId n : nodes(s)) {
            const auto children = s.children(n);
            node_.push_back(
                {s.position(n), s.radius(n), n, s.parent(n), {children.begin(), children.end()}, {}});
        }
        for (const NodeJoin& join : joins) add_joined(join);
    }

    SeparatedSkeleton run() && {
        for (const NodeId n : nodes(s_)) halve_lone_segment(n);
        for (const NodeId n : nodes(s_)) {
            if (n.index() % 4096 == 0) ctx_.throw_if_cancelled();
            resolve(n);
        }
        // Nodes added by `resolve` follow the given ones and may be resolved further.
        for (std::uint32_t i = s_.size(); i < node_.size(); ++i) resolve(NodeId(i));
        for (std::uint32_t i = 0, size = static_cast<std::uint32_t>(node_.size()); i < size; ++i)
            shift(NodeId(i));
        for (std::uint32_t i = s_.size(), size = static_cast<std::uint32_t>(node_.size()); i < size; ++i) {
            if (at(NodeId(i)).joined) divide_if_direct(NodeId(i));
        }
        return finish();
    }

  private:
    struct Node {
        Vec3 position;
        float radius;
        NodeId source;
        NodeId parent;
        std::vector<NodeId> children;
        NodeId dissolved_into;    ///< node of the tube that wraps the segment of a removed node
        NodeId joined;            ///< of two nodes that represent a join, the other one: see add_joined
        bool is_bundle = false;   ///< see bundle_one
        std::uint8_t slides = 0;  ///< number of times it was moved along its chain
    };
    struct View {  // a child as seen from its branch node
        NodeId node;
        Vec3 direction;
        float radius;
        float length;
        bool tip;
    };

    // A tube that ends in a node is a lateral of that node that leads to the beginning of the tube: it is
    // represented by a temporary node.
    void add_joined(const NodeJoin& join) {
        const NodeId from = s_.parent(join.end), m(static_cast<std::uint32_t>(node_.size()));
        node_.push_back({s_.position(from), s_.radius(join.end), join.end, join.node, {}, {}, join.end});
        at(join.end).joined = m;
        kids(join.node).push_back(m);
    }

    // Two nodes may have at most one tube between them: another gets a ring in its middle.
    void divide_if_direct(NodeId joined) {
        const NodeId end = at(joined).joined, from = at(end).parent, node = at(joined).parent;
        const auto also_ends_there = [&](NodeId c) {
            return c != end && at(c).joined && at(at(c).joined).parent == node;
        };
        const bool is_direct = at(node).parent == from || at(from).parent == node ||
                               std::ranges::any_of(kids(from), also_ends_there);
        if (from == node || !is_direct) return;
        const Vec3 middle = lerp(at(from).position, at(node).position, 0.5f);
        const NodeId m = insert_ring(from, end, middle, at(end).radius);
        std::ranges::replace(kids(from), end, m);
    }

    // The only segment of a tree gets a node in its middle: each end is a separate tube, and may be cut by
    // its own plane.
    void halve_lone_segment(NodeId n) {
        if (!s_.is_root(n) || s_.children(n).size() != 1 || !s_.is_tip(s_.children(n)[0])) return;
        const NodeId tip = s_.children(n)[0];
        const NodeId m = insert_ring(n, tip, lerp(s_.position(n), s_.position(tip), 0.5f),
                                     0.5f * (s_.radius(n) + s_.radius(tip)));
        std::ranges::replace(kids(n), tip, m);
    }

    Node& at(NodeId n) { return node_[n.index()]; }
    const Node& at(NodeId n) const { return node_[n.index()]; }
    std::vector<NodeId>& kids(NodeId n) { return at(n).children; }
    const std::vector<NodeId>& kids(NodeId n) const { return at(n).children; }
    View view(NodeId n, NodeId c) const {
        const Vec3 d = at(c).position - at(n).position;
        return {c, normalized(d), at(c).radius, length(d), is_tip(c) && !at(c).joined};
    }
    bool is_bundle(NodeId n) const { return at(n).is_bundle; }
    // Returns whether the node represents a tube that ends in its parent.
    bool is_joined(NodeId n) const { return n.index() >= s_.size() && at(n).joined; }
    bool is_tip(NodeId n) const { return at(n).children.empty(); }

    NodeId leader(NodeId n) const {
        NodeId best;
        for (const NodeId c : at(n).children) {
            const bool goes_on = best && is_joined(best) != is_joined(c);
            if (!best || (goes_on ? is_joined(best) : at(c).radius > at(best).radius)) best = c;
        }
        return best;
    }

    // Each step removes a node of the skeleton, moves one along its chain, which happens to each at most
    // kMaxSlides times, or removes a child from n, so the number of steps is bounded by the number of nodes.
    void resolve(NodeId n) {
        if (kids(n).size() > kMaxChildren) return;
        while (kids(n).size() > 1 && (absorb_one(n) || advance_one(n) || bundle_one(n))) {
        }
    }

    void adopt(NodeId n, NodeId c) { at(c).parent = n; }

    // Inserts a node between p and its child c; the list of children of p is not updated.
    NodeId insert_ring(NodeId p, NodeId c, Vec3 position, float radius) {
        const NodeId m(static_cast<std::uint32_t>(node_.size()));
        node_.push_back({position, radius, at(c).source, p, {c}, {}});
        adopt(m, c);
        return m;
    }

    // Replaces child c of n by the children of c.
    void dissolve(NodeId n, NodeId c) {
        std::vector<NodeId> grandchildren = std::move(kids(c));
        kids(c).clear();
        for (NodeId& g : grandchildren) g = ring_after_bend(n, c, g);
        const bool goes_on = grandchildren.size() == 1 && !is_joined(grandchildren[0]);
        at(c).dissolved_into = goes_on ? grandchildren[0] : n;
        for (const NodeId g : grandchildren) adopt(n, g);
        auto& list = kids(n);
        const auto place = list.erase(std::find(list.begin(), list.end(), c));
        list.insert(place, grandchildren.begin(), grandchildren.end());
    }

    // [m] Returns the distance of a point from the line between two nodes.
    float distance_from_way(Vec3 p, NodeId n, NodeId g) const {
        const Vec3 from = at(n).position, axis = at(g).position - from;
        return length(p - from - axis * closest_parameter(p, from, axis, 1.0f));
    }

    // Returns whether a tube from n to g would leave out a bend at c.
    bool bends(NodeId n, NodeId c, NodeId g) const {
        return distance_from_way(at(c).position, n, g) > kBend * at(g).radius;
    }

    // If the line from n to g bends at the removed node c, inserts a ring into a long segment; returns its
    // first node.
    NodeId ring_after_bend(NodeId n, NodeId c, NodeId g) {
        const Vec3 rest = at(g).position - at(c).position;
        const float r = at(g).radius, way = length(rest);
        if (c.index() >= s_.size() || at(g).joined || way < 2 * kRingAfterBend * r || !bends(n, c, g))
            return g;
        return insert_ring(n, g, at(c).position + rest * (kRingAfterBend * r / way), r);
    }

    // Merges a child inside the union around n into n.
    bool absorb_one(NodeId n) {
        const NodeId lead = leader(n);
        for (const NodeId c : kids(n)) {
            const View v = view(n, c);
            float inside = kShortest * std::max(v.radius, c == lead ? at(n).radius : 0.0f);
            if (c != lead) inside = std::max(inside, root_distance(n, v) + 0.4f * v.radius);
            if (v.tip) {
                if (!is_swallowed(n, c, lead)) continue;
                kids(n).erase(std::find(kids(n).begin(), kids(n).end(), c));
                at(c).dissolved_into = n;
                ++report_.hidden_tips;
                return true;
            }
            if (v.length >= inside || is_bundle(c) || at(c).joined) continue;
            if (kids(c).size() == 1 && c.index() >= s_.size() && slide(n, c, inside)) return true;
            dissolve(n, c);
            ++report_.merged_nodes;
            return true;
        }
        return false;
    }

    // Returns whether a tip is hardly visible: inside the union, or along its whole length so close to a
    // longer sibling that rays from the sibling's axis reach its visible part.
    bool is_swallowed(NodeId n, NodeId c, NodeId lead) const {
        const View v = view(n, c);
        if (c != lead && v.length + 0.7f * v.radius <= root_distance(n, v)) return true;
        for (const NodeId o : at(n).children) {
            const View s = view(n, o);
            if (o == c || is_bundle(o) || is_joined(o) || s.length < v.length) continue;
            const Vec3 tip = v.direction * v.length;
            const Vec3 off = tip - s.direction * std::clamp(dot(tip, s.direction), 0.0f, s.length);
            if (length_squared(off) < s.radius * s.radius + v.radius * v.radius) return true;
        }
        return false;
    }

    // Returns the distance at which the axis of a child leaves the other branches of n.
    float root_distance(NodeId n, const View& child) const {
        float t = 0;
        for (const NodeId o : at(n).children) {
            if (o == child.node) continue;
            const View other = view(n, o);
            t = std::max(t, axis_exit(other.direction, other.radius, other.length, child.direction));
        }
        if (const NodeId p = at(n).parent) {
            const Vec3 up = at(p).position - at(n).position;
            t = std::max(t, axis_exit(normalized(up), at(n).radius, length(up), child.direction));
        }
        return t;
    }
    static float axis_exit(Vec3 axis, float radius, float length, Vec3 direction) {
        const float c = dot(axis, direction);
        if (c <= 0) return radius;
        return std::min(radius / std::max(std::sqrt(std::max(0.0f, 1 - c * c)), 1e-3f),
                        std::max(radius, length));
    }

    // Moves a branch that separates from the leader only beyond the leader's next node to that node.
    bool advance_one(NodeId n) {
        const NodeId lead = leader(n);
        const View a = view(n, lead);
        for (const NodeId c : kids(n)) {
            if (c == lead) continue;
            const View b = view(n, c);
            const Crotch k = crotch(a.direction, a.radius, b.direction, b.radius);
            const float along_a = k.distance * std::cos(k.angle_a),
                        along_b = k.distance * std::cos(k.angle_b);
            if (along_a > kCrotchShare * a.length && !a.tip && !is_bundle(lead) && !is_joined(lead)) {
                if (kids(lead).size() == 1 && slide(n, lead, along_a / kCrotchShare)) return true;
                if (along_a < kMoveShare * a.length) continue;
                if (!b.tip || dot(at(c).position - at(lead).position, a.direction) > b.radius) {
                    move_on(n, c, lead);
                    return true;
                }
            }
            if (along_b > kCrotchShare * b.length && kids(c).size() == 1 &&
                slide(n, c, along_b / kCrotchShare))
                return true;
        }
        return false;
    }

    // Moves a node in the middle of a chain along the chain until it is `away` from n; a node that would be
    // too close to the next one, or was moved too often, is replaced by it. Returns false, without changes,
    // if the chain bends there.
    bool slide(NodeId n, NodeId c, float away) {
        const NodeId next = kids(c)[0];
        const Vec3 rest = at(next).position - at(c).position;
        const float room = length(rest), missing = 1.02f * away - distance(at(n).position, at(c).position);
        const float step = std::max(missing, 0.05f * at(c).radius);
        const bool fits = missing + at(c).radius <= room && step < room;
        if (fits && at(c).slides < kMaxSlides) {
            at(c).position += rest * (step / room);
            ++at(c).slides;
        } else if (bends(n, c, next)) {
            return false;
        } else {
            dissolve(n, c);
            ++report_.merged_nodes;
        }
        return true;
    }

    // Inserts a ring so that a branch that is moved from n to its leader keeps its axis from the point where
    // it becomes visible; none if the line from the leader is close enough to the axis.
    NodeId ring_on_axis(NodeId n, NodeId c, NodeId lead) {
        const View a = view(n, lead), b = view(n, c);
        const float r = b.radius, abreast = a.length / std::max(dot(a.direction, b.direction), 0.1f);
        const float way = std::max(root_distance(n, b) + 1.5f * r, abreast);
        if (way + kRingAfterBend * r > b.length) return NodeId::none();
        const Vec3 place = at(n).position + b.direction * way;
        if (distance_from_way(place, lead, c) < kBend * r) return NodeId::none();
        return insert_ring(lead, c, place, r);
    }

    void move_on(NodeId n, NodeId c, NodeId lead) {
        const Vec3 axis = normalized(at(lead).position - at(n).position);
        const NodeId on_axis = ring_on_axis(n, c, lead);
        kids(n).erase(std::find(kids(n).begin(), kids(n).end(), c));
        kids(lead).push_back(on_axis ? on_axis : c);
        adopt(lead, kids(lead).back());
        ++report_.shifted_nodes;
        if (on_axis) return;
        const float ahead = dot(at(c).position - at(lead).position, axis);
        if (ahead < 0.5f * at(c).radius && !is_tip(c)) dissolve(lead, c);
    }

    // Returns the distance of the crotch of two children, at most the distance at which their ends separate.
    float crotch_distance(const View& a, const View& b, const Crotch& k) const {
        float d = k.distance;
        for (const auto& [v, angle] : {std::pair{a, k.angle_a}, std::pair{b, k.angle_b}}) {
            const float off = v.length * std::sin(angle);
            const float end =
                v.length * std::cos(angle) + std::sqrt(std::max(0.0f, v.radius * v.radius - off * off));
            if (d * std::cos(angle) > v.length) d = std::min(d, end);
        }
        return d;
    }
    static Vec3 crotch_direction(const View& a, const View& b, const Crotch& k) {
        const Vec3 across =
            normalized(b.direction - a.direction * dot(a.direction, b.direction), perpendicular(a.direction));
        return a.direction * std::cos(k.angle_a) + across * std::sin(k.angle_a);
    }

    // Moves two children that separate from each other later than from the rest to a node of their own.
    bool bundle_one(NodeId n) {
        const auto& list = kids(n);
        if (list.size() < 3) return false;
        std::vector<View> v;
        for (const NodeId c : list) v.push_back(view(n, c));
        float best = 0, second = 0;
        std::size_t best_i = 0, best_j = 0;
        for (std::size_t i = 0; i < v.size(); ++i) {
            for (std::size_t j = i + 1; j < v.size(); ++j) {
                const float d = crotch_distance(
                    v[i], v[j], crotch(v[i].direction, v[i].radius, v[j].direction, v[j].radius));
                if (d > best) {
                    second = best;
                    best = d;
                    best_i = i;
                    best_j = j;
                } else {
                    second = std::max(second, d);
                }
            }
        }
        const View &a = v[best_i], &b = v[best_j];
        const float r = std::max(a.radius, b.radius);
        const float way = best - kCrotchReach * r;
        if (way < std::max(kBundleStem * r, second)) return false;
        const Vec3 direction = crotch_direction(a, b, crotch(a.direction, a.radius, b.direction, b.radius));
        const NodeId m(static_cast<std::uint32_t>(node_.size()));
        node_.push_back({at(n).position + direction * std::min(way, 0.6f * std::min(a.length, b.length)),
                         r,
                         at(a.radius >= b.radius ? a.node : b.node).source,
                         n,
                         {a.node, b.node},
                         {},
                         {},
                         true});
        auto& rest = kids(n);
        std::erase_if(rest, [&](NodeId c) { return c == a.node || c == b.node; });
        rest.push_back(m);
        adopt(m, a.node);
        adopt(m, b.node);
        ++report_.paired_nodes;
        return true;
    }

    // Shifts a branch node so that rays from it reach its close crotches.
    void shift(NodeId n) {
        if (kids(n).size() < 2 || kids(n).size() > kMaxChildren) return;
        const View a = view(n, leader(n));
        Vec3 sum;
        int count = 0;
        for (const NodeId c : kids(n)) {
            if (c == a.node) continue;
            const View b = view(n, c);
            const Crotch k = crotch(a.direction, a.radius, b.direction, b.radius);
            float longest = std::numeric_limits<float>::infinity();
            for (const View& v : {a, b})
                longest = std::min(longest, v.tip ? v.length : kCrotchShare * v.length);
            const float beyond =
                std::min(crotch_distance(a, b, k), longest) - kCrotchReach * std::max(a.radius, b.radius);
            if (beyond <= 0) continue;
            sum += crotch_direction(a, b, k) * beyond;
            ++count;
        }
        Vec3 by;
        if (count > 0)
            by = sum * (room_to_shift(n, sum / static_cast<float>(count)) / static_cast<float>(count));
        if (!at(n).parent) return shift_root(n, by);
        if (count == 0) return;
        // A stem that continues stays straight.
        if (dot(way_in(n), a.direction) > cage_internal::kMinCosine) by = a.direction * dot(by, a.direction);
        if (turns(n, by)) {
            push_ahead(n, by);
        } else {
            at(n).position += by;
        }
    }

    // Returns the direction from the parent.
    Vec3 way_in(NodeId n) const { return normalized(at(n).position - at(at(n).parent).position); }

    // Returns whether the line from the parent to the shifted node would cut a corner of the skeleton.
    bool turns(NodeId n, Vec3 by) const {
        const Vec3 in = way_in(n);
        return length(by - in * dot(by, in)) > kCorner * at(n).radius;
    }

    // If no branch leaves a root on one side, the tree gets a stem, at least as long as the shift, which is
    // closed there. Otherwise the root is unchanged: a ring between two branches, or more around a ball.
    void shift_root(NodeId n, Vec3 by) {
        const bool is_pair = kids(n).size() == 2;
        const auto [side, nearest] = is_pair ? side_against(n) : free_side(n);
        if (nearest > (is_pair ? kPairBends : kLeavesSide)) return;
        const float shortest = kShortestStem * at(n).radius;
        push_ahead(n, length(by) < shortest ? side * -shortest : by);
        if (is_ball(s_, n)) at(kids(n)[0]).radius = at(n).radius;
    }

    // A direction, and the maximum cosine of its angle to a branch.
    struct Side {
        Vec3 direction;
        float nearest;
    };
    Side find_side(NodeId n, Vec3 direction) const {
        float nearest = -1;
        for (const NodeId c : kids(n)) nearest = std::max(nearest, dot(view(n, c).direction, direction));
        return {direction, nearest};
    }
    Side side_against(NodeId n) const {
        Vec3 sum;
        for (const NodeId c : kids(n)) sum += view(n, c).direction;
        return length_squared(sum) > 0 ? find_side(n, -normalized(sum)) : Side{{}, 1};
    }
    // Returns the direction of many that is farthest from all branches.
    Side free_side(NodeId n) const {
        Side best = side_against(n);
        const auto look = [&](Vec3 direction) {
            const Side side = find_side(n, direction);
            if (side.nearest < best.nearest) best = side;
        };
        for (const NodeId c : kids(n)) look(-view(n, c).direction);
        for (const float x : {-1.0f, 0.0f, 1.0f}) {
            for (const float y : {-1.0f, 0.0f, 1.0f}) {
                for (const float z : {-1.0f, 0.0f, 1.0f}) {
                    const Vec3 d{x, y, z};
                    if (length_squared(d) > 0) look(normalized(d));
                }
            }
        }
        return best;
    }

    // The node remains as a ring, and a new one gets its branches.
    void push_ahead(NodeId n, Vec3 by) {
        const NodeId m(static_cast<std::uint32_t>(node_.size()));
        node_.push_back({at(n).position + by, at(leader(n)).radius, at(leader(n)).source, n, {}, {}});
        std::swap(kids(m), kids(n));
        for (const NodeId c : kids(m)) adopt(m, c);
        kids(n).push_back(m);
    }

    // Returns the maximum share of a shift for which the line from the node to every child still leaves the
    // union through that child's tube.
    float room_to_shift(NodeId n, Vec3 by) const {
        float share = 1;
        for (const NodeId c : at(n).children) {
            const View v = view(n, c);
            const float root = root_distance(n, v);
            if (root >= v.length) continue;
            const float off = length(by - v.direction * dot(by, v.direction));
            const float left_over = off * (1 - root / v.length);
            if (left_over > 0.4f * v.radius) share = std::min(share, 0.4f * v.radius / left_over);
        }
        return share;
    }

    SeparatedSkeleton finish() const {
        std::vector<NodeId> parent, source;
        std::vector<Vec3> position;
        std::vector<float> radius;
        std::vector<NodeId> new_id(node_.size());
        std::vector<std::pair<NodeId, NodeId>> stack;  // node, new parent
        for (std::uint32_t i = s_.size(); i-- > 0;) {
            if (s_.is_root(NodeId(i))) stack.push_back({NodeId(i), NodeId::none()});
        }
        while (!stack.empty()) {
            const auto [n, p] = stack.back();
            stack.pop_back();
            if (is_joined(n)) continue;
            const NodeId id(static_cast<std::uint32_t>(parent.size()));
            new_id[n.index()] = id;
            parent.push_back(p);
            source.push_back(at(n).source);
            position.push_back(at(n).position);
            radius.push_back(at(n).radius);
            const auto& list = at(n).children;
            for (auto c = list.rbegin(); c != list.rend(); ++c) stack.push_back({*c, id});
        }
        std::vector<NodeJoin> joins = find_joins(new_id, parent, position);
        std::vector<NodeId> tube(s_.size());
        for (const NodeId n : nodes(s_)) {
            NodeId t = n;
            while (at(t).dissolved_into) t = at(t).dissolved_into;
            tube[n.index()] = new_id[t.index()];
        }
        std::vector<NodeId> round_roots;
        for (const NodeId n : nodes(s_)) {
            if (s_.is_root(n) && s_.children(n).size() > 1 && kids(n).size() == 1)
                round_roots.push_back(new_id[n.index()]);
        }
        return {Skeleton(std::move(parent), std::move(position), std::move(radius), s_.origin()),
                std::move(source),
                std::move(tube),
                std::move(round_roots),
                std::move(joins),
                report_};
    }

    // Returns the joins of the new nodes and moves their ends to the joined nodes. A tube requires a ring
    // between two branch nodes, otherwise it is left unchanged.
    std::vector<NodeJoin> find_joins(std::span<const NodeId> new_id, std::span<const NodeId> parent,
                                     std::vector<Vec3>& position) const {
        std::vector<NodeJoin> out;
        for (const Node& n : node_) {
            if (!n.joined || !is_tip(n.joined) || n.joined.index() >= s_.size()) continue;
            const NodeId end = new_id[n.joined.index()], node = new_id[n.parent.index()];
            const auto& siblings = kids(n.parent);
            const bool is_lone =
                !at(n.parent).parent && std::ranges::all_of(siblings, [&](NodeId c) { return is_joined(c); });
            if (!end || parent[end.index()] == node || is_lone) continue;
            out.push_back({end, node});
            position[end.index()] = position[node.index()];
        }
        std::ranges::sort(out, {}, &NodeJoin::end);
        return out;
    }

    const Skeleton& s_;
    const Context& ctx_;
    std::vector<Node> node_;
    SeparationReport report_;
};

}  // namespace

SeparatedSkeleton separate_branches(const Skeleton& skeleton, std::span<const NodeJoin> joins,
                                    const Context& ctx) {
    return Separation(skeleton, joins, ctx).run();
}

}  // namespace coppice
