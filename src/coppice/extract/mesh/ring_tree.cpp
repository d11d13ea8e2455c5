#include "coppice/base/median.h"
#include "coppice/base/round_cone.h"
#include "coppice/extract/mesh/ring_tree_internal.h"

#include <algorithm>
#include <cmath>

namespace coppice::extract_internal {
namespace {

constexpr double kRound = 0.15;      // spread up to which a ring counts as a circle
constexpr double kLeastRound = 1.8;  // in medians of its chain
constexpr double kReach = 3;         // [radius] how far from the fork's ring a chain may start
constexpr double kSame = 0.3;        // [radius] nodes nearer than this are one

/// One chain from its base outward.
struct Strand {
    std::vector<std::uint32_t> rings;  // the kept ones, from the base outward; at least one
    std::uint32_t owner = kNone;       // the strand that it leaves; kNone for one that begins at a source
    double start = 0;                  // where on the owner's points: index + fraction
    std::vector<Vec3d> points;         // the place of the start first, where there is an owner
    std::vector<double> radii;

    std::uint32_t last() const { return static_cast<std::uint32_t>(points.size()) - 1; }
    Vec3d at(double t) const {
        const auto k = static_cast<std::uint32_t>(t);
        return lerp(points[k], points[std::min(k + 1, last())], t - k);
    }
    double radius_at(double t) const {
        const auto k = static_cast<std::uint32_t>(t);
        return radii[k] + (radii[std::min(k + 1, last())] - radii[k]) * (t - k);
    }
};

class Stringing {
  public:
    Stringing(const Surface& surface, const RingForest& forest)
        : s_(surface), f_(forest), strand_(forest.rings.size()), place_(forest.rings.size()) {}
    RingTree run();

  private:
    struct Window {  // of an owner's points
        std::uint32_t begin, end;
    };
    void keep_rings(std::uint32_t c);
    Window window(const Strand& owner, std::uint32_t ring) const;
    void drop_rings_inside(Strand& s, const Strand& owner, Window w) const;
    double meeting(const Strand& s, const Strand& owner, Window w, Vec3d tip) const;
    void lay(std::uint32_t c);
    void add_nodes(std::uint32_t c, RingTree& out);

    const Surface& s_;
    const RingForest& f_;
    std::vector<Strand> strands_;
    std::vector<std::uint32_t> strand_, place_;        // per ring: its strand, and its (or the next) point
    std::vector<std::vector<std::uint32_t>> leaving_;  // per strand
    std::vector<std::uint32_t> base_;                  // per strand: the node that it starts from
    std::vector<std::vector<std::uint32_t>> node_;     // per strand and point
};

void Stringing::keep_rings(std::uint32_t c) {
    const RingChain& chain = f_.chains[c];
    std::vector<double> spreads;
    for (std::uint32_t i = chain.first; i < chain.end; ++i) spreads.push_back(f_.rings[i].spread);
    const double limit = std::max(kRound, kLeastRound * median_in_place(spreads));
    for (std::uint32_t i = chain.end; i-- > chain.first;) {
        strand_[i] = c;
        if (f_.rings[i].spread <= limit || i == chain.first) strands_[c].rings.push_back(i);
    }
}

/// The owner's segments within reach of the ring that the chain ran into.
Stringing::Window Stringing::window(const Strand& o, std::uint32_t ring) const {
    const Ring& r = f_.rings[ring];
    Window w{std::min(place_[ring], o.last()), 0};
    w.end = std::min(w.begin + 1, o.last() + 1);
    while (w.begin > 0 && distance(o.points[w.begin], r.center) < kReach * r.radius) --w.begin;
    while (w.end < o.points.size() && distance(o.points[w.end], r.center) < kReach * r.radius) ++w.end;
    return w;
}

/// A lateral's rings within the owner's surface are cut by it, and no sections of the lateral.
void Stringing::drop_rings_inside(Strand& s, const Strand& o, Window w) const {
    const auto inside = [&](Vec3d p) {
        for (std::uint32_t k = w.begin; k < w.end; ++k) {
            const std::uint32_t next = std::min(k + 1, o.last());
            const RoundCone cone = round_cone(o.points[k], o.points[next], o.radii[k], o.radii[next]);
            if (cone.foot(p).signed_distance() < 0) return true;
        }
        return false;
    };
    std::size_t skip = 0;
    while (skip + 1 < s.rings.size() && inside(f_.rings[s.rings[skip]].center)) ++skip;
    s.rings.erase(s.rings.begin(), s.rings.begin() + static_cast<std::ptrdiff_t>(skip));
}

/// Where the chain's first axis, led backward, comes nearest to the owner's.
double Stringing::meeting(const Strand& s, const Strand& o, Window w, Vec3d tip) const {
    constexpr int kSteps = 8;
    constexpr double kNearer = 0.8;  // of two places equally far off the line the nearer one is right
    const Vec3d p = f_.rings[s.rings[0]].center;
    const Vec3d outward =
        s.rings.size() > 1 ? f_.rings[s.rings[std::min<std::size_t>(2, s.rings.size() - 1)]].center : tip;
    const Vec3d dir = normalized(p - outward, {});
    double best = std::numeric_limits<double>::infinity(), where = w.begin;
    for (std::uint32_t k = w.begin; k < w.end; ++k) {
        for (int i = 0; i < kSteps; ++i) {
            const double t = k + static_cast<double>(i) / kSteps;
            const Vec3d v = o.at(t) - p;
            const double ahead = dot(v, dir);
            const double cost = length(v - dir * ahead) + kNearer * length(v) + std::max(0.0, -ahead);
            if (cost >= best) continue;
            best = cost;
            where = t;
        }
    }
    return std::min<double>(where, o.last());
}

/// The points of a strand, after those of its owner.
void Stringing::lay(std::uint32_t c) {
    Strand& s = strands_[c];
    const RingChain& chain = f_.chains[c];
    keep_rings(c);
    if (const std::uint32_t to = f_.rings[chain.end - 1].parent; to != kNone) {
        s.owner = strand_[to];
        const Strand& o = strands_[s.owner];
        const Window w = window(o, to);
        drop_rings_inside(s, o, w);
        s.start = meeting(s, o, w, Vec3d(s_.positions[chain.tip]));
        s.points.push_back(o.at(s.start));
        s.radii.push_back(o.radius_at(s.start));
    }
    auto next = static_cast<std::uint32_t>(s.points.size());
    std::size_t kept = 0;
    for (std::uint32_t i = chain.end; i-- > chain.first;) {
        place_[i] = next;
        if (kept == s.rings.size() || s.rings[kept] != i) continue;
        s.points.push_back(f_.rings[i].center);
        s.radii.push_back(f_.rings[i].radius);
        if (++kept < s.rings.size()) ++next;
    }
    if (s.points.size() > 1) return;
    // A lone ring has no axis: the tip gives it one.
    s.points.push_back(lerp(s.points[0], Vec3d(s_.positions[chain.tip]), 0.5));
    s.radii.push_back(s.radii[0]);
}

/// The nodes of a strand, those where others start among them.
void Stringing::add_nodes(std::uint32_t c, RingTree& out) {
    const Strand& s = strands_[c];
    auto& list = leaving_[c];
    std::sort(list.begin(), list.end(), [&](std::uint32_t a, std::uint32_t b) {
        const double x = strands_[a].start, y = strands_[b].start;
        return x != y ? x < y : a < b;
    });
    DraftTree& tree = out.tree;
    std::uint32_t last = kNone;
    std::size_t l = 0;
    for (std::uint32_t k = 0; k <= s.last(); ++k) {
        last = k == 0 && base_[c] != kNone ? base_[c] : tree.add(last, s.points[k], s.radii[k]);
        node_[c].push_back(last);
        for (; l < list.size() && (k == s.last() || strands_[list[l]].start < k + 1); ++l) {
            const double t = std::min<double>(strands_[list[l]].start, s.last());
            const double same = kSame * s.radius_at(t);
            if (k < s.last() && distance(s.at(t), s.points[k + 1]) < same) {
                strands_[list[l]].start = k + 1;
                break;
            }
            if (distance(s.at(t), tree.position[last]) >= same)
                last = tree.add(last, s.at(t), s.radius_at(t));
            base_[list[l]] = last;
        }
    }
}

RingTree Stringing::run() {
    RingTree out;
    const std::size_t n = f_.chains.size();
    strands_.resize(n);
    leaving_.resize(n);
    node_.resize(n);
    base_.assign(n, kNone);
    for (std::uint32_t c = 0; c < n; ++c) {
        lay(c);
        if (strands_[c].owner != kNone) leaving_[strands_[c].owner].push_back(c);
    }
    for (std::uint32_t c = 0; c < n; ++c) add_nodes(c, out);
    for (std::size_t r = 0; r < f_.rings.size(); ++r)
        out.node_of_ring.push_back(node_[strand_[r]][place_[r]]);
    for (const RingChain& chain : f_.chains)
        if (chain.touched != kNone)
            out.loops.push_back({out.node_of_ring[chain.first], out.node_of_ring[chain.touched]});
    return out;
}

}  // namespace

RingTree string_rings(const Surface& surface, const RingForest& forest) {
    return Stringing(surface, forest).run();
}

}  // namespace coppice::extract_internal
