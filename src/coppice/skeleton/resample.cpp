#include "coppice/skeleton/resample.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/skeleton/chains_internal.h"
#include "coppice/skeleton/segment_cone.h"
#include "coppice/skeleton/simplify_chain.h"

namespace coppice {
namespace {

/// Kept nodes and their positions.
struct Choice {
    std::vector<bool> kept;
    std::vector<Vec3> position;
};

// [radius] maximum shift of the surface by removing a node that is too close to another one
constexpr double kMaxShift = 0.1;

void simplify(const Skeleton& s, NodeId anchor, const std::vector<NodeId>& chain, const ResampleOptions& o,
              Choice& choice, ResampleReport& report) {
    if (chain.size() == 1) return;
    const bool leads = s.leader(anchor) == chain.front();
    std::vector<ChainPoint> points{
        {Vec3d(s.position(anchor)), s.segment(chain.front()).radius_a, anchor.index()}};
    for (const NodeId n : chain) points.push_back({Vec3d(s.position(n)), s.radius(n), n.index()});
    const double spacing = o.min_spacing;
    const SimplifiedChain kept = simplify_chain(
        std::move(points), {o.tolerance, spacing, leads, leads ? 0 : spacing * s.radius(anchor),
                            std::max<double>(o.tolerance, kMaxShift)});
    report.moved += kept.moved;
    for (std::size_t i = 1; i + 1 < kept.points.size(); ++i) {
        choice.kept[kept.points[i].node] = true;
        choice.position[kept.points[i].node] = Vec3(kept.points[i].position);
    }
}

/// [Zhu2015] 3.1. The condition of the paper on the angle applies to its difference from a straight line.
void thin_chain(const Skeleton& s, NodeId anchor, const std::vector<NodeId>& chain, const ResampleOptions& o,
                Choice& choice) {
    NodeId before = anchor;
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        const Vec3d in(s.position(chain[i]) - s.position(before));
        const Vec3d out(s.position(chain[i + 1]) - s.position(chain[i]));
        const double shortest = std::min(length(in), length(out));
        const bool straight = turn(in, out) < o.zhu_angle;
        if (straight || shortest < static_cast<double>(o.zhu_spacing) * s.radius(chain[i])) continue;
        choice.kept[chain[i].index()] = true;
        before = chain[i];
    }
}

NodeId first_kept(const Skeleton& s, const std::vector<bool>& kept, NodeId n) {
    while (!kept[n.index()]) n = s.children(n).front();
    return n;
}

/// Keeps the first nodes of all children where removing nodes would change the leader.
void keep_leaders(const Skeleton& s, std::vector<bool>& kept) {
    for (const NodeId n : nodes(s)) {
        if (s.children(n).size() < 2) continue;
        const NodeId leader = s.leader(n);
        const float radius = s.radius(first_kept(s, kept, leader));
        const bool stays = std::ranges::all_of(s.children(n), [&](NodeId c) {
            const float r = s.radius(first_kept(s, kept, c));
            return c == leader || r < radius || (r == radius && leader < c);
        });
        if (stays) continue;
        for (const NodeId c : s.children(n)) kept[c.index()] = true;
    }
}

ResampleResult choose_nodes(const Skeleton& s, const ResampleOptions& options) {
    Choice choice{std::vector<bool>(s.size()), {s.positions().begin(), s.positions().end()}};
    ResampleReport report;
    for (const NodeId n : nodes(s)) choice.kept[n.index()] = !is_chain_node(s, n);
    for_each_chain(s, [&](NodeId anchor, const std::vector<NodeId>& chain) {
        if (options.method == ResampleMethod::zhu) {
            thin_chain(s, anchor, chain, options, choice);
        } else {
            simplify(s, anchor, chain, options, choice, report);
        }
    });
    keep_leaders(s, choice.kept);
    const bool all = std::ranges::find(choice.kept, false) == choice.kept.end();
    if (all && report.moved == 0) return {s, report, all_nodes(s)};
    Subset subset = take_nodes(s, choice.kept, choice.position, s.radii());
    report.removed = s.size() - subset.skeleton.size();
    return {std::move(subset.skeleton), report, std::move(subset.new_of_old)};
}

/// A node to be inserted on a segment.
struct Ring {
    double t;  ///< fraction of the length
    double radius;
};

/// Part of a segment, divided into sections of equal length in local radii.
struct EvenRings {
    double first = 0, last = 1;  // fractions of the length
    std::uint32_t parts = 1;

    /// Returns the begin of section i on a segment with this ratio of the radii at its ends.
    double begin(std::uint32_t i, double ratio) const {
        const double share = static_cast<double>(i) / parts;
        if (std::abs(ratio - 1) < kNoTaper) return first + (last - first) * share;
        const double r0 = 1 + (ratio - 1) * first, r1 = 1 + (ratio - 1) * last;
        return (r0 * std::pow(r1 / r0, share) - 1) / (ratio - 1);
    }

    static constexpr double kNoTaper = 1e-3;
};

class Splitter {
  public:
    Splitter(const Skeleton& s, const ResampleOptions& options)
        : s_(s), o_(options), max_length_(options.max_length), sharp_(s.size()) {
        const double budget = 2.0 * s.size() + 10'000;
        double wanted = 0;
        for (const NodeId n : nodes(s)) {
            sharp_[n.index()] = turns_sharply(n);
            if (!s.is_root(n)) wanted += relative_length(n) / max_length_;
        }
        if (wanted > budget) max_length_ *= wanted / budget;
    }

    /// `result` must contain the skeleton passed to the constructor.
    void run(ResampleResult& result) const {
        std::vector<NodeId> parent, new_index(s_.size());
        std::vector<Vec3> position;
        std::vector<float> radius;
        parent.reserve(s_.size());
        position.reserve(s_.size());
        radius.reserve(s_.size());
        for (const NodeId n : nodes(s_)) {
            NodeId from = s_.is_root(n) ? NodeId::none() : new_index[s_.parent(n).index()];
            const auto add = [&](Vec3 p, float r) {
                parent.push_back(from);
                position.push_back(p);
                radius.push_back(r);
                from = NodeId(static_cast<std::uint32_t>(radius.size() - 1));
            };
            if (!s_.is_root(n)) {
                const Segment g = s_.segment(n);
                for (const Ring& ring : rings(n)) {
                    add(lerp(g.a, g.b, static_cast<float>(ring.t)), static_cast<float>(ring.radius));
                    ++result.report.inserted;
                }
            }
            add(s_.position(n), s_.radius(n));
            new_index[n.index()] = from;
        }
        for (NodeId& n : result.new_of_old) n = new_index[n.index()];
        result.skeleton = Skeleton(std::move(parent), std::move(position), std::move(radius), s_.origin());
    }

  private:
    // Length in local radii: the integral of 1 / radius along the segment.
    double relative_length(NodeId n) const {
        const Segment g = s_.segment(n);
        const double a = g.radius_a, ratio = g.radius_b / a;
        const double mean = std::abs(ratio - 1) < EvenRings::kNoTaper ? 0.5 * a * (1 + ratio)
                                                                      : a * (ratio - 1) / std::log(ratio);
        return distance(Vec3d(g.a), Vec3d(g.b)) / mean;
    }

    // Returns whether a node gets rings. Besides sharp turns these are balls and roots at which branches
    // separate before the ring, and tips of long segments: long faces before a tip would pull the surface
    // back.
    bool turns_sharply(NodeId n) const {
        constexpr double kLongBeforeTip = 12;                          // [radius]
        if (o_.bend_angle >= std::numbers::pi_v<float>) return false;  // rings are disabled
        if (s_.is_root(n)) return s_.children(n).size() > 1 && (is_ball(s_, n) || parts_widely(n));
        if (s_.is_tip(n)) return length_before_tip(n) > kLongBeforeTip * s_.radius(n);
        if (!is_chain_node(s_, n)) return false;
        const Vec3 in = s_.position(n) - s_.position(s_.parent(n));
        const Vec3 out = s_.position(s_.children(n).front()) - s_.position(n);
        return turn(Vec3d(in), Vec3d(out)) > o_.bend_angle;
    }

    // A tree of one segment always gets a node in the middle: each end is a separate tube.
    double length_before_tip(NodeId n) const {
        const double length = distance(s_.position(n), s_.position(s_.parent(n)));
        return is_lone(n) ? length / 2 : length;
    }
    bool is_lone(NodeId tip) const {
        const NodeId p = s_.parent(tip);
        return s_.is_root(p) && s_.is_tip(tip) && s_.children(p).size() == 1;
    }

    // Returns whether all branches at a root are at least 67 degrees apart; false for many branches, which
    // cannot be.
    bool parts_widely(NodeId root) const {
        constexpr float kCosine = 0.39f;
        constexpr std::size_t kMaxChildren = 16;
        const auto children = s_.children(root);
        if (children.size() > kMaxChildren) return false;
        for (std::size_t i = 0; i < children.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                const Vec3 a = s_.position(children[i]) - s_.position(root),
                           b = s_.position(children[j]) - s_.position(root);
                if (dot(a, b) > kCosine * length(a) * length(b)) return false;
            }
        }
        return true;
    }

    std::vector<Ring> rings(NodeId n) const {
        const NodeId p = s_.parent(n);
        // If a leader is thicker than its parent, a thinner inserted node could make a sibling the leader.
        if (s_.children(p).size() > 1 && s_.leader(p) == n && s_.radius(n) > s_.radius(p)) return {};
        const Segment g = s_.segment(n);
        const double l = distance(Vec3d(g.a), Vec3d(g.b));
        const EvenRings even = even_rings(n, g, l);
        const double ratio = g.radius_b / static_cast<double>(g.radius_a);
        // This form is never below both ends.
        const auto linear = [&](double t) { return (1 - t) * g.radius_a + t * g.radius_b; };
        // Where the leader leaves a ball, the hull of the balls at its ends begins to be a cone.
        const bool leaves_ball = s_.is_root(p) && s_.leader(p) == n && is_ball(s_, p) && even.first > 0;
        const double sine = (g.radius_a - g.radius_b) / l;
        const double outside = leaves_ball ? (g.radius_a - even.first * l * sine) / std::sqrt(1 - sine * sine)
                                           : linear(even.first);
        const auto radius = [&](double t) {
            if (!leaves_ball) return linear(t);
            const double share = (t - even.first) / (1 - even.first);
            return (1 - share) * outside + share * g.radius_b;
        };
        std::vector<Ring> out;
        const auto add = [&](double t) { out.push_back({t, radius(t)}); };
        if (even.first > 0) add(even.first);
        for (std::uint32_t i = 1; i < even.parts; ++i) add(even.begin(i, ratio));
        if (even.last < 1) add(even.last);
        return out;
    }

    EvenRings even_rings(NodeId n, const Segment& g, double length) const {
        constexpr double kOutsideBall = 1.05;
        const NodeId p = s_.parent(n);
        const bool at_ball = s_.is_root(p) && is_ball(s_, p);
        const float radius_a = s_.is_root(p) ? s_.radius(p) : g.radius_a;
        const double near_a = (at_ball ? kOutsideBall : static_cast<double>(o_.bend_spacing)) * radius_a;
        const double near_b = static_cast<double>(o_.bend_spacing) * g.radius_b;
        EvenRings r;
        if (2.5 * std::max(near_a, near_b) < length) {
            if (sharp_[p.index()]) r.first = near_a / length;
            if (sharp_[n.index()]) r.last = 1 - near_b / length;
        } else if (at_ball && 1.25 * near_a < length) {
            r.first = near_a / length;
        }
        const double least = r.last < 1 && is_lone(n) ? 2 : 1;
        r.parts = static_cast<std::uint32_t>(
            std::clamp(std::ceil(relative_length(n) / max_length_ * (r.last - r.first)), least, 1e7));
        return r;
    }

    const Skeleton& s_;
    const ResampleOptions& o_;
    double max_length_;
    std::vector<bool> sharp_;
};

}  // namespace

ResampleResult resample(const Skeleton& skeleton, const ResampleOptions& options) {
    check_fields(options, "resample");
    if (options.method == ResampleMethod::none) return {skeleton, {}, all_nodes(skeleton)};
    ResampleResult result = choose_nodes(skeleton, options);
    if (options.method == ResampleMethod::zhu) return result;
    Splitter(result.skeleton, options).run(result);
    return result;
}

void list_fields(ResampleOptions& o, FieldList& list) {
    list.add(Field{"resample", "Method that resamples the nodes between branch nodes."}, o.method);
    list.add(Field{"tolerance", "Maximum shift of the surface caused by removing nodes.", Unit::radius, 0, 1},
             o.tolerance);
    list.add(Field{"min_spacing", "Minimum distance between nodes along a chain.", Unit::radius, 0, 10},
             o.min_spacing);
    list.add(
        Field{"max_length", "Maximum length of a segment, above which it is split.", Unit::radius, 1, 1e6},
        o.max_length);
    list.add(
        Field{"bend_angle", "Turn angle above which a node gets a ring on each side.", Unit::radian, 0, 3.15},
        o.bend_angle);
    list.add(Field{"bend_spacing", "Distance of the rings from a sharp turn.", Unit::radius, 0.1, 10},
             o.bend_spacing);
    list.add(
        Field{"zhu_angle", "Turn angle below which the method zhu removes a node.", Unit::radian, 0, 3.15},
        o.zhu_angle);
    list.add(Field{"zhu_spacing", "Distance to a neighbour below which the method zhu removes a node.",
                   Unit::radius, 0, 10},
             o.zhu_spacing);
}

}  // namespace coppice
