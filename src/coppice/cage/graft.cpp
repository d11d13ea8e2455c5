#include "coppice/cage/graft.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/parallel.h"
#include "coppice/cage/axes_internal.h"
#include "coppice/cage/crossings_internal.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice {
namespace {

using cage_internal::Axes;
using cage_internal::Crossing;
using cage_internal::kClear;
using cage_internal::Part;

// A piece shorter than this many radii does not show.
constexpr float kLeastShown = 1.0f;
constexpr float kLeastTip = 0.5f;  // the same for one with a tip
// A piece that enters another branch ends so many of its radii ahead of the bark: its round end reaches it.
constexpr float kEndAhead = 0.5f;
// A branch that enters at a flatter angle, by its cosine, is taken to enter at this one.
constexpr float kFlattest = 0.5f;
// From the place where it leaves a branch, a piece is led back to that branch's axis by at most this many
// times the distance to it: flatter laterals would run inside for long.
constexpr float kLedBack = 1.2f;
// A place on a branch nearer to a node than this many radii is moved there.
constexpr float kSnap = 0.5f;
constexpr float kSame = 1e-4f;    // parameters of one place
constexpr float kSnapEnd = 0.3f;  // the same for the ends of pieces

// So many branches that hide the same place are looked at.
constexpr std::ptrdiff_t kMostHosts = 16;

constexpr std::uint32_t kAxesPerLook = 1024;  // whether the work is cancelled

constexpr std::uint32_t kNone = 0xffffffffu;

struct Spot {  // a point of a branch's axis
    NodeId segment;
    float t = 0;
};

struct Inside {      // a part of an axis that lies in another branch
    float from, to;  ///< [m] along the axis
    NodeId host;
    float host_t;    ///< where on the host it ends
    float approach;  ///< the cosine at which it enters, >= 0
};

struct Piece {  // a part of an axis that shows
    float from, to;
    std::uint32_t attach = kNone;  ///< a place; none: at the beginning of the axis
    std::uint32_t start = kNone;   ///< the place of `from`, where attached
    float resume =
        0;  ///< [m] where the axis lies deep enough in what the piece has met not to show; 0: at its tip
};

struct AxisPlan {
    std::vector<Inside> inside;
    std::vector<Piece> pieces;
};

class Grafting {
  public:
    Grafting(const Skeleton& s, float depth, const Context& ctx)
        : s_(s),
          ctx_(ctx),
          axes_(s),
          inside_(depth),
          crossings_(find_crossings(s, axes_, inside_, ctx)),
          shown_(s.size(), {0.0f, 1.0f}),
          first_crossing_(s.size() + 1, 0),
          plan_of_(axes_.count(), kNone),
          buried_(s.size()),
          head_(s.size(), kNone) {}

    GraftResult run() && {
        std::vector<bool> extraordinary(axes_.count(), false);
        for (const Crossing& c : crossings_) {
            ++first_crossing_[c.junior.index() + 1];
            if (!c.ordinary) extraordinary[axes_.axis_of(c.junior)] = true;
        }
        std::partial_sum(first_crossing_.begin(), first_crossing_.end(), first_crossing_.begin());
        for (std::uint32_t a = 0; a < axes_.count(); ++a) {
            if (a % kAxesPerLook == 0) ctx_.throw_if_cancelled();
            const NodeId base = s_.parent(axes_.nodes_of(a)[0]);
            if (extraordinary[a] || is_buried(base)) lay(a);
        }
        return emit();
    }

  private:
    // ---- axis by axis

    bool is_buried(NodeId n) const { return static_cast<bool>(buried_[n.index()].segment); }

    void lay(std::uint32_t axis) {
        plan_of_[axis] = static_cast<std::uint32_t>(plan_.size());
        AxisPlan plan;
        const auto chain = axes_.nodes_of(axis);
        for (const NodeId n : chain) {
            for (std::uint32_t i = first_crossing_[n.index()]; i < first_crossing_[n.index() + 1]; ++i)
                find_inside(n, crossings_[i].senior, plan.inside);
        }
        std::sort(plan.inside.begin(), plan.inside.end(), [](const Inside& a, const Inside& b) {
            return a.from != b.from ? a.from < b.from : a.to < b.to;
        });
        divide(chain, plan);
        hide(chain, plan);
        plan_.push_back(std::move(plan));
    }

    float start_of(NodeId n) const { return axes_.is_first(n) ? 0 : axes_.arc(s_.parent(n)); }

    Part shown_part(NodeId n) const {
        const auto [from, to] = shown_[n.index()];
        return {s_.segment(n), from, to};
    }
    bool shows_at_all(NodeId n) const { return shown_[n.index()].first < shown_[n.index()].second; }

    void find_inside(NodeId n, NodeId senior, std::vector<Inside>& out) const {
        if (!shows_at_all(senior)) return;
        const Segment own = s_.segment(n);
        const Part host = shown_part(senior);
        const float nearest = cage_internal::Insideness::nearest(own, host);
        if (inside_.see(host, own, nearest).gap >= 0) return;
        const float clear = kClear * own.radius_b;
        const float enter = inside_.see(host, own, 0).gap < 0 ? 0 : inside_.leave(host, own, nearest, 0);
        const float exit =
            inside_.see(host, own, 1).gap < clear ? 1 : inside_.leave(host, own, nearest, 1, clear);
        const float start = start_of(n), size = axes_.arc(n) - start;
        const Vec3 outward = normalized(inside_.see(host, own, enter).across);
        out.push_back({start + enter * size, start + exit * size, senior, inside_.see(host, own, exit).t,
                       std::max(0.0f, -dot(normalized(own.b - own.a), outward))});
    }

    // The parts between the insides that are long enough.
    void divide(std::span<const NodeId> chain, AxisPlan& plan) {
        const float end = axes_.arc(chain.back());
        float from = 0;
        const Inside* left = nullptr;  // from which the piece comes
        auto next = plan.inside.begin();
        const auto last = plan.inside.end();
        while (true) {
            for (; next != last && next->from - from < kLeastShown * radius_on(chain, next->from); ++next) {
                if (next->to < from) continue;
                from = next->to;
                left = &*next;
            }
            const bool is_tip = next == last;
            const float r = radius_on(chain, is_tip ? end : next->from);
            from = snapped(chain, from);
            const float to = is_tip ? end : snapped(chain, end_ahead_of(*next, r));
            const bool is_whole = is_tip && !left && !is_buried(s_.parent(chain[0]));
            if (is_whole || to - from >= (is_tip ? kLeastTip : kLeastShown) * r) {
                const std::uint32_t attach = place_of_piece(chain, from, left);
                plan.pieces.push_back({attach == kNone ? 0 : from, to, attach});
                if (!is_tip) end_at(*next, r, plan.pieces.back());
            }
            if (is_tip) break;
            from = next->to;
            left = &*next++;
        }
    }

    float end_ahead_of(const Inside& in, float radius) const {
        const float host = round_cone<float>(s_.segment(in.host)).radius(in.host_t);
        const float ahead = host + kEndAhead * radius - inside_.least_distance(host, radius);
        return in.from - std::max(0.0f, ahead) / std::max(in.approach, kFlattest);
    }

    void end_at(const Inside& in, float radius, Piece& piece) {
        piece.resume = std::min(in.to, in.from + radius / std::max(in.approach, kFlattest));
        ++report_.cut;
    }

    // Where a piece springs from; none for a lateral that leaves its own trunk in the ordinary way.
    std::uint32_t place_of_piece(std::span<const NodeId> chain, float from, const Inside* left) {
        const NodeId base = s_.parent(chain[0]);
        if (!is_buried(base)) {
            if (!left) return kNone;
            const bool below = left->host == base, beside = s_.parent(left->host) == base;
            const bool in_between = (below && left->host_t > 0) || (beside && left->host_t < 1);
            if (in_between && from <= axes_.arc(chain[0])) return kNone;
        }
        ++report_.grafted;
        return place_on(left ? led_back(chain, from, {left->host, left->host_t}) : buried_[base.index()]);
    }

    // A node instead of a place next to it.
    float snapped(std::span<const NodeId> chain, float arc) const {
        const Spot spot = spot_at(chain, arc);
        const float near = kSnapEnd * round_cone<float>(s_.segment(spot.segment)).radius(spot.t);
        const float start = start_of(spot.segment), end = axes_.arc(spot.segment);
        if (arc - start < near) return start;
        return end - arc < near ? end : arc;
    }
    float radius_on(std::span<const NodeId> chain, float arc) const {
        const Spot spot = spot_at(chain, arc);
        return round_cone<float>(s_.segment(spot.segment)).radius(spot.t);
    }
    // The first node at or below a place, or the last one.
    std::span<const NodeId>::iterator below(std::span<const NodeId> chain, float arc) const {
        return std::lower_bound(chain.begin(), chain.end() - 1, arc,
                                [&](NodeId n, float a) { return axes_.arc(n) < a; });
    }
    Spot spot_at(std::span<const NodeId> chain, float arc) const {
        const NodeId n = *below(chain, arc);
        const float start = start_of(n);
        return {n, std::clamp((arc - start) / std::max(axes_.arc(n) - start, 1e-30f), 0.0f, 1.0f)};
    }
    Vec3 point_at(Spot spot) const {
        const Segment g = s_.segment(spot.segment);
        return lerp(g.a, g.b, spot.t);
    }

    // Follows a piece backward from where it leaves its host, as if it came straight from the host's axis.
    Spot led_back(std::span<const NodeId> chain, float from, Spot spot) const {
        const Spot out = spot_at(chain, from);
        const Segment own = s_.segment(out.segment), host = s_.segment(spot.segment);
        const Vec3 along = normalized(host.b - host.a), direction = normalized(own.b - own.a);
        const float d = distance(point_at(out), point_at(spot));
        const float c = dot(along, direction);
        const float way = c / std::max(std::sqrt(std::max(0.0f, 1 - c * c)), 1e-3f);
        return moved(spot, -d * std::clamp(way, -kLedBack, kLedBack), axes_.rank(out.segment));
    }

    // Along the axis, within what shows of it and comes before the given rank.
    Spot moved(Spot spot, float by, std::uint32_t rank) const {
        while (true) {
            const float size = axes_.arc(spot.segment) - start_of(spot.segment);
            const float at = spot.t * size + by;
            const auto [from, to] = shown_[spot.segment.index()];
            NodeId next;
            if (at < 0 && from <= 0 && !axes_.is_first(spot.segment)) next = s_.parent(spot.segment);
            if (at > size && to >= 1) next = axes_.next(spot.segment);
            if (!next || axes_.rank(next) >= rank || !shows_at_all(next))
                return {spot.segment, std::clamp(at / std::max(size, 1e-30f), from, to)};
            by = at < 0 ? at : at - size;
            spot = {next, at < 0 ? 1.0f : 0.0f};
        }
    }

    // ---- places: nodes, and cuts of segments

    struct Cut {
        Spot spot;
        std::uint32_t next;  ///< of the same segment
    };

    // A node or cut that is near, or a new cut.
    std::uint32_t place_on(Spot spot) {
        const NodeId n = spot.segment;
        const float size = axes_.arc(n) - start_of(n);
        float nearest = kSnap * round_cone<float>(s_.segment(n)).radius(spot.t);
        std::uint32_t place = kNone;
        const auto consider = [&](float t, std::uint32_t p) {
            const float off = std::abs(t - spot.t) * size;
            if (off <= nearest) {
                nearest = off;
                place = p;
            }
        };
        const auto [from, to] = shown_[n.index()];
        if (from <= 0) consider(0, s_.parent(n).index());
        if (to >= 1) consider(1, n.index());
        for (std::uint32_t c = head_[n.index()]; c != kNone; c = cut_[c].next) {
            if (cut_[c].spot.t >= from - kSame && cut_[c].spot.t <= to + kSame)
                consider(cut_[c].spot.t, s_.size() + c);
        }
        return place != kNone ? place : add_cut(spot);
    }

    std::uint32_t add_cut(Spot spot) {
        if (spot.t <= 0 && !axes_.is_first(spot.segment)) return s_.parent(spot.segment).index();
        if (spot.t >= 1) return spot.segment.index();
        for (std::uint32_t c = head_[spot.segment.index()]; c != kNone; c = cut_[c].next) {
            if (std::abs(cut_[c].spot.t - spot.t) < kSame) return s_.size() + c;
        }
        const auto c = static_cast<std::uint32_t>(cut_.size());
        cut_.push_back({spot, head_[spot.segment.index()]});
        head_[spot.segment.index()] = c;
        return s_.size() + c;
    }

    // Cuts the axis where pieces begin and end, and notes what shows and which nodes do not.
    void hide(std::span<const NodeId> chain, AxisPlan& plan) {
        for (const NodeId n : chain) shown_[n.index()] = {1.0f, 0.0f};
        for (Piece& p : plan.pieces) {
            if (p.attach != kNone) p.start = place_at(chain, p.from);
            place_at(chain, p.to);
            if (p.resume > p.to) place_at(chain, p.resume);
            for (auto n = below(chain, p.from); n != chain.end() && start_of(*n) < p.to; ++n) {
                const float start = start_of(*n), size = std::max(axes_.arc(*n) - start, 1e-30f);
                auto& [from, to] = shown_[n->index()];
                from = std::min(from, std::max(0.0f, (p.from - start) / size));
                to = std::max(to, std::min(1.0f, (p.to - start) / size));
            }
        }
        for (const NodeId n : chain) {
            if (shows(plan, axes_.arc(n))) continue;
            buried_[n.index()] = host_of(plan, chain, axes_.arc(n));
            ++report_.buried;
        }
    }

    std::uint32_t place_at(std::span<const NodeId> chain, float arc) {
        const Spot spot = spot_at(chain, arc);
        if (spot.t <= 0) return s_.parent(spot.segment).index();
        return add_cut(spot);
    }

    // The last piece that begins at or before a place; null where none does.
    static const Piece* piece_at(const AxisPlan& plan, float arc) {
        const auto after = std::upper_bound(plan.pieces.begin(), plan.pieces.end(), arc,
                                            [](float a, const Piece& p) { return a < p.from; });
        return after == plan.pieces.begin() ? nullptr : &*std::prev(after);
    }
    static bool shows(const AxisPlan& plan, float arc) {
        const Piece* const piece = piece_at(plan, arc);
        return piece && arc <= piece->to;
    }
    // Whether a place lies in the little that is left out where a piece ends.
    static bool is_left_out(const AxisPlan& plan, float arc) {
        const Piece* const piece = piece_at(plan, arc);
        return piece && piece->to <= arc && arc <= piece->resume;
    }

    // The nearest point of the branch that hides a point of an axis; none where nothing does.
    Spot host_of(const AxisPlan& plan, std::span<const NodeId> chain, float arc) const {
        const auto after = std::upper_bound(plan.inside.begin(), plan.inside.end(), arc,
                                            [](float a, const Inside& in) { return a < in.from; });
        const auto first = after - std::min(after - plan.inside.begin(), kMostHosts);
        const auto last = after + std::min<std::ptrdiff_t>(plan.inside.end() - after, 1);
        if (first == last) return buried_[s_.parent(chain[0]).index()];
        const auto off = [&](const Inside& in) { return std::max({in.from - arc, arc - in.to, 0.0f}); };
        const NodeId host = std::min_element(first, last, [&](const Inside& a, const Inside& b) {
                                return off(a) < off(b);
                            })->host;
        const Spot own = spot_at(chain, arc);
        return {host, inside_.see(shown_part(host), s_.segment(own.segment), own.t).t};
    }

    // ---- the skeleton with its cuts, and the tree of tubes

    struct Made {  // a node of the new skeleton
        NodeId parent;
        NodeId segment;  ///< of the given skeleton, on which it lies
        float arc;
        Vec3 position;
        float radius;
        NodeId attached;  ///< for the first node of a piece that springs from another branch
        NodeId in_tree;   ///< the nearest node of the tree of tubes at or above this one
    };

    GraftResult emit() {
        make_nodes();
        for (std::uint32_t a = 0; a < axes_.count(); ++a) {
            if (plan_of_[a] == kNone) continue;
            for (const Piece& p : plan_[plan_of_[a]].pieces) {
                if (p.start != kNone) at(new_id_[p.start]).attached = new_id_[p.attach];
            }
        }
        for (std::size_t i = 0; i < made_.size(); ++i) {
            Made& m = made_[i];
            const bool is_root = !m.parent;
            const bool in_tree = is_root || m.attached || shows(m);
            m.in_tree = in_tree ? NodeId(static_cast<std::uint32_t>(i)) : at(m.parent).in_tree;
        }
        return number_tubes();
    }

    Made& at(NodeId n) { return made_[n.index()]; }
    const Made& at(NodeId n) const { return made_[n.index()]; }

    // Where the segment of a new node begins along the axis.
    float start_of(const Made& m) const {
        const Made& p = at(m.parent);
        return p.segment == m.segment ? p.arc : start_of(m.segment);
    }
    float middle_of(const Made& m) const { return 0.5f * (start_of(m) + m.arc); }
    bool shows(const Made& m) const {
        const std::uint32_t plan = plan_of_[axes_.axis_of(m.segment)];
        return plan == kNone || shows(plan_[plan], middle_of(m));
    }

    void make_nodes() {
        new_id_.resize(s_.size() + cut_.size());
        made_.reserve(new_id_.size());
        std::vector<std::uint32_t> cuts;
        for (const NodeId n : nodes(s_)) {
            NodeId above = s_.is_root(n) ? NodeId::none() : new_id_[s_.parent(n).index()];
            cuts.clear();
            for (std::uint32_t c = head_[n.index()]; c != kNone; c = cut_[c].next) cuts.push_back(c);
            std::sort(cuts.begin(), cuts.end(),
                      [&](std::uint32_t a, std::uint32_t b) { return cut_[a].spot.t < cut_[b].spot.t; });
            const auto make = [&](std::uint32_t place, float arc, Vec3 position, float radius) {
                new_id_[place] = NodeId(static_cast<std::uint32_t>(made_.size()));
                made_.push_back({above, n, arc, position, radius, {}, {}});
                above = new_id_[place];
            };
            for (const std::uint32_t c : cuts) {
                const auto g = round_cone<float>(s_.segment(n));
                const float t = cut_[c].spot.t, start = start_of(n);
                make(s_.size() + c, start + t * (axes_.arc(n) - start), g.point(t), g.radius(t));
            }
            make(n.index(), axes_.arc(n), s_.position(n), s_.radius(n));
        }
    }

    // Ranks fall from a tube to its parent, so that the tubes form a tree.
    NodeId parent_tube(const Made& m) const {
        const bool falls = m.attached && (!at(m.attached).parent ||
                                          axes_.rank(at(m.attached).segment) < axes_.rank(m.segment));
        return at(falls ? m.attached : m.parent).in_tree;
    }

    // The new node whose segment holds a spot.
    NodeId node_below(Spot spot) const {
        NodeId best = new_id_[spot.segment.index()];
        float nearest = 1;
        for (std::uint32_t c = head_[spot.segment.index()]; c != kNone; c = cut_[c].next) {
            const float t = cut_[c].spot.t;
            if (t >= spot.t && t <= nearest) {
                nearest = t;
                best = new_id_[s_.size() + c];
            }
        }
        return best;
    }

    // The tree of tubes before it is numbered: by new node, none for those that are not in it.
    struct TubeTree {
        std::vector<NodeId> parent, roots;
        CompressedRows<NodeId> children;
    };
    TubeTree tube_tree() const {
        TubeTree tree{std::vector<NodeId>(made_.size()), {}, {}};
        for (std::uint32_t i = 0; i < made_.size(); ++i) {
            const Made& m = made_[i];
            if (m.in_tree != NodeId(i)) continue;
            if (!m.parent) {
                tree.roots.push_back(NodeId(i));
            } else {
                tree.parent[i] = parent_tube(m);
            }
        }
        tree.children = compress_rows<NodeId>(made_.size(), [&](const auto& put) {
            for (std::uint32_t i = 0; i < made_.size(); ++i) {
                if (tree.parent[i]) put(tree.parent[i].index(), NodeId(i));
            }
        });
        return tree;
    }

    GraftResult number_tubes() const {
        const TubeTree tree = tube_tree();
        std::vector<NodeId> stack(tree.roots.rbegin(), tree.roots.rend());
        std::vector<NodeId> parent, source, id(made_.size());
        std::vector<Vec3> position;
        std::vector<float> radius;
        while (!stack.empty()) {
            const NodeId n = stack.back();
            stack.pop_back();
            const Made& m = at(n);
            const auto children = tree.children[n.index()];
            id[n.index()] = NodeId(static_cast<std::uint32_t>(parent.size()));
            parent.push_back(m.parent ? id[tree.parent[n.index()].index()] : NodeId::none());
            source.push_back(m.attached && !children.empty() ? children[0] : n);
            position.push_back(m.position);
            radius.push_back(m.radius);
            stack.insert(stack.end(), children.rbegin(), children.rend());
        }
        Skeleton tubes(std::move(parent), std::move(position), std::move(radius), s_.origin());
        return {new_skeleton(), std::move(tubes), std::move(source), tubes_of_segments(id), report_};
    }

    Skeleton new_skeleton() const {
        std::vector<NodeId> parent;
        std::vector<Vec3> position;
        std::vector<float> radius;
        for (const Made& m : made_) {
            parent.push_back(m.parent);
            position.push_back(m.position);
            radius.push_back(m.radius);
        }
        return {std::move(parent), std::move(position), std::move(radius), s_.origin()};
    }

    std::vector<NodeId> tubes_of_segments(std::span<const NodeId> id) const {
        std::vector<NodeId> tube(made_.size());
        for (std::size_t i = 0; i < made_.size(); ++i) {
            const Made& m = made_[i];
            if (m.in_tree.index() == i) {
                tube[i] = id[i];
                continue;
            }
            const std::uint32_t axis = axes_.axis_of(m.segment);
            const AxisPlan& plan = plan_[plan_of_[axis]];
            if (is_left_out(plan, middle_of(m))) continue;
            const Spot host = host_of(plan, axes_.nodes_of(axis), middle_of(m));
            const Made& holder = host.segment ? at(node_below(host)) : at(m.parent);
            tube[i] = id[holder.in_tree.index()];
        }
        return tube;
    }

    const Skeleton& s_;
    const Context& ctx_;
    const Axes axes_;
    const cage_internal::Insideness inside_;
    const std::vector<Crossing> crossings_;
    std::vector<std::pair<float, float>>
        shown_;                                  ///< the range of a segment that shows; empty when from >= to
    std::vector<std::uint32_t> first_crossing_;  ///< by junior
    std::vector<std::uint32_t> plan_of_;         ///< by axis
    std::vector<AxisPlan> plan_;
    std::vector<Spot> buried_;  ///< by node: where in another branch it lies
    std::vector<Cut> cut_;
    std::vector<std::uint32_t> head_;  ///< by segment: its newest cut
    std::vector<Made> made_;
    std::vector<NodeId> new_id_;  ///< by place
    GraftReport report_;
};

}  // namespace

GraftResult graft_branches(const Skeleton& skeleton, float depth, const Context& ctx) {
    if (depth > 0 && skeleton.size() > 2) return Grafting(skeleton, depth, ctx).run();
    std::vector<NodeId> same;
    for (const NodeId n : nodes(skeleton)) same.push_back(n);
    return {skeleton, skeleton, same, same, {}};
}

}  // namespace coppice
