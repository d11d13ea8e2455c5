#include "coppice/skeleton/resample.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/skeleton/chains_internal.h"
#include "coppice/skeleton/simplify_chain.h"

namespace coppice {
namespace {

/// Which nodes stay, and where.
struct Choice {
    std::vector<bool> kept;
    std::vector<Vec3> position;
};

void simplify(const Skeleton& s, NodeId anchor, const std::vector<NodeId>& chain, const ResampleOptions& o,
              Choice& choice, ResampleReport& report) {
    if (chain.size() == 1) return;
    const bool leads = s.leader(anchor) == chain.front();
    std::vector<ChainPoint> points{
        {Vec3d(s.position(anchor)), s.segment(chain.front()).radius_a, anchor.index()}};
    for (const NodeId n : chain) points.push_back({Vec3d(s.position(n)), s.radius(n), n.index()});
    const double spacing = o.min_spacing;
    const SimplifiedChain kept = simplify_chain(
        std::move(points), {o.tolerance, spacing, leads, leads ? 0 : spacing * s.radius(anchor)});
    report.moved += kept.moved;
    for (std::size_t i = 1; i + 1 < kept.points.size(); ++i) {
        choice.kept[kept.points[i].node] = true;
        choice.position[kept.points[i].node] = Vec3(kept.points[i].position);
    }
}

/// [Zhu2015] 3.1. The paper's condition on the angle holds for its difference from a straight line.
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

/// Where leaving out nodes would make another child lead, the first nodes of all children stay.
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

/// Where new nodes come on a segment: a ring near either end if that end turns sharply, and even parts
/// between.
struct Rings {
    double first = 0, last = 1;  // fractions of the length
    std::uint32_t parts = 1;
};

class Splitter {
  public:
    Splitter(const Skeleton& s, const ResampleOptions& options)
        : s_(s), o_(options), max_length_(options.max_length), sharp_(s.size()) {
        const double budget = 2.0 * s.size() + 10'000;
        double wanted = 0;
        for (const NodeId n : nodes(s)) {
            if (s.is_root(n)) continue;
            wanted += relative_length(n) / max_length_;
            sharp_[n.index()] = turns_sharply(n);
        }
        if (wanted > budget) max_length_ *= wanted / budget;
    }

    bool has_work() const {
        for (const NodeId n : nodes(s_)) {
            if (sharp_[n.index()] || (!s_.is_root(n) && relative_length(n) > max_length_)) return true;
        }
        return false;
    }

    /// `result` holds the skeleton that this splitter was made for.
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
                for_each_fraction(rings(n), [&](double t) {
                    const auto f = static_cast<float>(t);
                    add(lerp(g.a, g.b, f), (1 - f) * g.radius_a + f * g.radius_b);  // never below both
                    ++result.report.inserted;
                });
            }
            add(s_.position(n), s_.radius(n));
            new_index[n.index()] = from;
        }
        for (NodeId& n : result.new_of_old) n = new_index[n.index()];
        result.skeleton = Skeleton(std::move(parent), std::move(position), std::move(radius), s_.origin());
    }

  private:
    double relative_length(NodeId n) const {
        const Segment g = s_.segment(n);
        return distance(Vec3d(g.a), Vec3d(g.b)) / (0.5 * (static_cast<double>(g.radius_a) + g.radius_b));
    }

    bool turns_sharply(NodeId n) const {
        if (!is_chain_node(s_, n)) return false;
        const Vec3 in = s_.position(n) - s_.position(s_.parent(n));
        const Vec3 out = s_.position(s_.children(n).front()) - s_.position(n);
        return turn(Vec3d(in), Vec3d(out)) > o_.bend_angle;
    }

    Rings rings(NodeId n) const {
        const NodeId p = s_.parent(n);
        // A leader thicker than its parent would hand its lead to a sibling through a thinner node before it.
        if (s_.children(p).size() > 1 && s_.leader(p) == n && s_.radius(n) > s_.radius(p)) return {};
        const Segment g = s_.segment(n);
        const double l = distance(Vec3d(g.a), Vec3d(g.b));
        const double near_a = static_cast<double>(o_.bend_spacing) * g.radius_a;
        const double near_b = static_cast<double>(o_.bend_spacing) * g.radius_b;
        Rings r;
        if (2.5 * std::max(near_a, near_b) < l) {
            if (sharp_[p.index()]) r.first = near_a / l;
            if (sharp_[n.index()]) r.last = 1 - near_b / l;
        }
        r.parts = static_cast<std::uint32_t>(
            std::clamp(std::ceil(relative_length(n) / max_length_ * (r.last - r.first)), 1.0, 1e7));
        return r;
    }

    template <class Visit>
    static void for_each_fraction(const Rings& r, const Visit& visit) {
        if (r.first > 0) visit(r.first);
        for (std::uint32_t i = 1; i < r.parts; ++i) visit(r.first + (r.last - r.first) * i / r.parts);
        if (r.last < 1) visit(r.last);
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
    const Splitter splitter(result.skeleton, options);
    if (splitter.has_work()) splitter.run(result);
    return result;
}

}  // namespace coppice
