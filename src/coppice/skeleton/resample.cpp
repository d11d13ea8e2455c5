#include "coppice/skeleton/resample.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/skeleton/chains_internal.h"

namespace coppice {
namespace {

constexpr float kJump = 0.2f;  // relative change of radius that is worth two close nodes

/// A chain with the radii that its segments really have, in double precision.
struct ChainPoint {
    Vec3d position;
    double radius;
    double influence = 0;  // relative shift of the surface without the point
    NodeId node;
};

struct Interval {
    std::uint32_t first, last;
    int depth;
};

/// The relative shift of the ball about p when points first + 1 ... last - 1 go.
double shift_of(const ChainPoint& p, const ChainPoint& a, const ChainPoint& b) {
    const Vec3d way = b.position - a.position;
    const double widening = b.radius - a.radius;
    const Vec3d to = p.position - a.position;
    const double square = dot(way, way) + widening * widening;
    const double along = dot(to, way) + (p.radius - a.radius) * widening;
    const double t = square > 0 ? std::clamp(along / square, 0.0, 1.0) : 0.0;
    const double d_radius = p.radius - a.radius - t * widening;
    return std::sqrt(length_squared(to - way * t) + d_radius * d_radius) / p.radius;
}

/// Chooses points by Douglas-Peucker in four dimensions, on a stack of its own. Deep intervals are halved
/// instead of split at their farthest point: so the worst case stays O(n log n), at the price of a few points
/// more.
class Simplifier {
  public:
    /// Whether each point is chosen; valid until the next call.
    const std::vector<bool>& run(std::vector<ChainPoint>& points, bool leads, double tolerance) {
        const auto last = static_cast<std::uint32_t>(points.size() - 1);
        kept_.assign(points.size(), false);
        kept_[0] = kept_[last] = true;
        const int deepest = 16 + 2 * static_cast<int>(std::log2(points.size()));
        stack_.assign(1, {0, last, 0});
        while (!stack_.empty()) {
            const Interval in = stack_.back();
            stack_.pop_back();
            const auto [farthest, shift] = find_farthest(points, in, leads);
            if (!(shift > tolerance)) continue;
            const std::uint32_t at = in.depth < deepest ? farthest : in.first + (in.last - in.first) / 2;
            kept_[at] = true;
            points[at].influence = shift;
            stack_.push_back({at, in.last, in.depth + 1});
            stack_.push_back({in.first, at, in.depth + 1});
        }
        return kept_;
    }

  private:
    static std::pair<std::uint32_t, double> find_farthest(const std::vector<ChainPoint>& points,
                                                          const Interval& in, bool leads) {
        std::pair<std::uint32_t, double> best{in.first, -1};
        ChainPoint a = points[in.first];
        // A lateral's first segment has the radius of its end all along.
        if (in.first == 0 && !leads) a.radius = points[in.last].radius;
        for (std::uint32_t i = in.first + 1; i < in.last; ++i) {
            const double shift = shift_of(points[i], a, points[in.last]);
            if (shift > best.second) best = {i, shift};
        }
        return best;
    }

    std::vector<bool> kept_;
    std::vector<Interval> stack_;
};

bool is_jump(const ChainPoint& a, const ChainPoint& b) {
    return std::abs(a.radius - b.radius) > kJump * std::max(a.radius, b.radius);
}

/// Thins the chosen points of a chain; the ends stay.
class Spacer {
  public:
    explicit Spacer(double spacing) : spacing_(spacing) {}

    /// The points that stay; valid until the next call. The first node of a lateral is not within `inside` of
    /// its branch node.
    std::vector<ChainPoint>& run(const std::vector<ChainPoint>& points, const std::vector<bool>& chosen,
                                 double inside) {
        out_.assign(1, points[0]);
        for (std::size_t i = 1; i + 1 < points.size(); ++i) {
            if (!chosen[i]) continue;
            if (out_.size() == 1 && distance(points[i].position, points[0].position) < inside) continue;
            push(points[i]);
        }
        const ChainPoint& end = points.back();
        while (out_.size() > 1 && too_close(out_.back(), end) && !is_jump(out_.back(), end)) out_.pop_back();
        out_.push_back(end);
        return out_;
    }

  private:
    bool too_close(const ChainPoint& a, const ChainPoint& b) const {
        return distance(a.position, b.position) < spacing_ * std::min(a.radius, b.radius);
    }

    void push(const ChainPoint& p) {
        while (too_close(out_.back(), p) && !is_jump(out_.back(), p)) {
            if (out_.size() == 1 || out_.back().influence >= p.influence) return;
            out_.pop_back();
        }
        out_.push_back(p);
    }

    double spacing_;
    std::vector<ChainPoint> out_;
};

/// Pushes the two ends of a jump in radius apart, each along its own segment and by at most a third of that.
/// Returns how many points moved.
std::uint32_t spread_jumps(std::vector<ChainPoint>& chain, double spacing) {
    std::uint32_t moved = 0;
    const auto move = [&](std::size_t i, std::size_t toward, double way) {
        const Vec3d to = chain[toward].position - chain[i].position;
        const double l = length(to);
        if (l <= 0) return 0.0;
        const double step = std::min(way, l / 3);
        chain[i].position += to * (step / l);
        ++moved;
        return step;
    };
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        if (!is_jump(chain[i], chain[i + 1])) continue;
        double lacking = spacing * std::min(chain[i].radius, chain[i + 1].radius) -
                         distance(chain[i].position, chain[i + 1].position);
        if (!(lacking > 0)) continue;
        const bool back = i > 0, on = i + 2 < chain.size();
        if (back) lacking -= move(i, i - 1, on ? lacking / 2 : lacking);
        if (on && lacking > 0) move(i + 1, i + 2, lacking);
    }
    return moved;
}

/// Which nodes stay, and where.
struct Choice {
    std::vector<bool> kept;
    std::vector<Vec3> position;
};

/// Simplifies one chain after the other; keeps its buffers.
class ChainSimplifier {
  public:
    ChainSimplifier(const Skeleton& s, const ResampleOptions& o) : s_(s), o_(o), spacer_(o.min_spacing) {}

    void run(NodeId anchor, const std::vector<NodeId>& chain, Choice& choice, ResampleReport& report) {
        if (chain.size() == 1) return;
        const bool leads = s_.leader(anchor) == chain.front();
        points_.assign(1, {Vec3d(s_.position(anchor)), s_.segment(chain.front()).radius_a, 0, anchor});
        for (const NodeId n : chain) points_.push_back({Vec3d(s_.position(n)), s_.radius(n), 0, n});
        const std::vector<bool>& chosen = simplifier_.run(points_, leads, o_.tolerance);
        const double inside = leads ? 0 : static_cast<double>(o_.min_spacing) * s_.radius(anchor);
        std::vector<ChainPoint>& kept = spacer_.run(points_, chosen, inside);
        report.moved += spread_jumps(kept, o_.min_spacing);
        for (std::size_t i = 1; i + 1 < kept.size(); ++i) {
            choice.kept[kept[i].node.index()] = true;
            choice.position[kept[i].node.index()] = Vec3(kept[i].position);
        }
    }

  private:
    const Skeleton& s_;
    const ResampleOptions& o_;
    Simplifier simplifier_;
    Spacer spacer_;
    std::vector<ChainPoint> points_;
};

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
    ChainSimplifier simplifier(s, options);
    for_each_chain(s, [&](NodeId anchor, const std::vector<NodeId>& chain) {
        if (options.method == ResampleMethod::zhu) {
            thin_chain(s, anchor, chain, options, choice);
        } else {
            simplifier.run(anchor, chain, choice, report);
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
