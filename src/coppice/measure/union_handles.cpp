#include "coppice/measure/union_handles.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/disjoint_sets.h"
#include "coppice/base/golden_section.h"
#include "coppice/base/id.h"
#include "coppice/base/parallel.h"

namespace coppice {
namespace {

constexpr std::size_t kPairGrain = 64;
constexpr std::size_t kMaxNeighbors = 100;      // mean number of boxes that overlap the box of a cone
constexpr std::size_t kMinNeighbors = 100'000;  // number of overlaps that is always permitted
constexpr double kSlack = 1e-3;  // [radii] distance at which cones are considered to have a common point

/// The ball of a cone that is closest to a point p.
struct ClosestBall {
    Vec3d center;
    double radius;
    double distance;  ///< [m] of p from the ball, and so from the convex hull of the balls; < 0 inside
};

ClosestBall find_closest_ball(const RoundCone& c, Vec3d p) {
    const double l = length(c.axis);
    double t = c.growth > 0 ? 1 : 0;
    if (std::fabs(c.growth) < l) {
        const double along = dot(p - c.a, c.axis) / l, slope = c.growth / l;
        const double across = std::sqrt(std::max(0.0, length_squared(p - c.a) - along * along));
        t = std::clamp((along + across * slope / std::sqrt(1 - slope * slope)) / l, 0.0, 1.0);
    }
    const Vec3d center = c.point(t);
    return {center, c.radius(t), distance(center, p) - c.radius(t)};
}

/// Returns whether two cones have a common point. The distance of a ball of b from a is convex in the ball's
/// parameter.
bool overlap(const RoundCone& a, const RoundCone& b) {
    constexpr double kTolerance = 1e-8;
    const SegmentGap closest = gap(a, b);
    if (closest.distance <= a.radius(closest.s) + b.radius(closest.t)) return true;
    if (a.growth == 0 && b.growth == 0) return false;
    const auto distance_at = [&](double t) {
        return find_closest_ball(a, b.point(t)).distance - b.radius(t);
    };
    const double middle = find_minimum(0, 1, kTolerance, distance_at);
    return std::min({distance_at(middle), distance_at(0), distance_at(1)}) <= 0;
}

/// Returns whether three cones have a common point, by projecting a point onto each in turn.
bool overlap(const std::array<const RoundCone*, 3>& cones) {
    constexpr int kRounds = 5000;
    constexpr double kSettled = 1e-4;
    double slack = std::numeric_limits<double>::infinity();
    Vec3d p;
    for (const RoundCone* c : cones) {
        slack = std::min(slack, kSlack * std::max(c->radius_a, c->radius_b()));
        p += c->point(0.5) / 3;
    }
    for (int round = 0; round < kRounds; ++round) {
        const Vec3d before = p;
        double farthest = 0;
        for (const RoundCone* c : cones) {
            const ClosestBall ball = find_closest_ball(*c, p);
            farthest = std::max(farthest, ball.distance);
            if (ball.distance > 0) p = ball.center + normalized(p - ball.center) * ball.radius;
        }
        if (farthest <= slack) return true;
        if (distance(p, before) < kSettled * farthest) return false;  // the points form a cycle
    }
    return false;
}

Box3 compute_box(const RoundCone& c) {
    Box3 box;
    extend_outward(box, c.a, c.radius_a);
    extend_outward(box, c.b(), c.radius_b());
    return box;
}

/// The pairs of cones with common points.
class Pairs {
  public:
    Pairs(const CapsuleTree& capsules, const Context& ctx) {
        std::vector<Box3> boxes(capsules.size());
        parallel_for(ctx, boxes.size(), kPairGrain, [&](std::size_t i) {
            boxes[i] = compute_box(capsules.cone(static_cast<std::uint32_t>(i)));
        });
        const BoxTree tree(boxes, ctx);
        const std::size_t most = std::max(kMinNeighbors, kMaxNeighbors * capsules.size());
        std::atomic<std::size_t> neighbors = 0;
        std::vector<std::vector<std::uint32_t>> after(capsules.size());
        parallel_for(ctx, after.size(), kPairGrain, [&](std::size_t i) {
            const RoundCone& cone = capsules.cone(static_cast<std::uint32_t>(i));
            tree.visit_overlapping(boxes[i], [&](std::uint32_t j) {
                if (j > i && overlap(cone, capsules.cone(j))) after[i].push_back(j);
                return ++neighbors <= most;
            });
            std::ranges::sort(after[i]);
        });
        is_crowded_ = neighbors > most;
        for (const auto& row : after) {
            rows_.items.insert(rows_.items.end(), row.begin(), row.end());
            rows_.first.push_back(rows_.items.size());
        }
    }

    bool is_crowded() const { return is_crowded_; }  ///< the search was stopped: too many boxes overlap
    std::size_t size() const { return rows_.items.size(); }
    std::size_t begin(std::uint32_t i) const { return rows_.first[i]; }  ///< first pair of i with a later one
    std::size_t end(std::uint32_t i) const { return begin(i + 1); }      ///< past the last of these
    std::uint32_t second(std::size_t pair) const { return rows_.items[pair]; }
    /// Returns the pair of two different cones; size() if they have no common point.
    std::size_t find(std::uint32_t i, std::uint32_t j) const {
        if (i > j) std::swap(i, j);
        const auto row = rows_[i];
        const auto found = std::ranges::lower_bound(row, j);
        if (found == row.end() || *found != j) return size();
        return begin(i) + static_cast<std::size_t>(found - row.begin());
    }

  private:
    bool is_crowded_ = false;
    CompressedRows<std::uint32_t, std::size_t> rows_;  // of each cone the later ones, ascending
};

/// The cones of trees, each joined to one before it by a ball that both contain.
struct Forest {
    std::vector<std::uint32_t> previous;  ///< cone of the parent, or of a sibling at a root; kNoIndex for one
    std::vector<RoundCone> common;        ///< that ball
    std::size_t trees = 0;                ///< number of cones without a previous one
};

Forest make_forest(const CapsuleTree& capsules, const Skeleton& skeleton) {
    Forest out;
    std::vector<std::uint32_t> capsule_of(skeleton.size(), kNoIndex);  // of roots: that of a child
    for (std::uint32_t i = 0; i < capsules.size(); ++i) {
        const NodeId n = capsules.node(i);
        const RoundCone& cone = capsules.cone(i);
        capsule_of[n.index()] = i;
        out.previous.push_back(skeleton.is_root(n) ? kNoIndex : capsule_of[skeleton.parent(n).index()]);
        out.common.push_back({cone.a, {}, cone.radius_a, 0});
        if (skeleton.is_root(n)) {
            ++out.trees;
        } else if (out.previous.back() == kNoIndex) {
            ++out.trees;
            capsule_of[skeleton.parent(n).index()] = i;
        } else {
            const RoundCone& before = capsules.cone(out.previous.back());
            const double radius = before.a == cone.a ? before.radius_a : before.radius_b();
            out.common.back().radius_a = std::min(cone.radius_a, radius);
        }
    }
    return out;
}

/// Sets of loops, each of which is zero: a basis of their sums modulo 2.
class Relations {
  public:
    /// Adds basis sets to a set, ascending, until it contains no maximum of these.
    void reduce(std::vector<std::uint32_t>& set) const {
        std::vector<std::uint32_t> sum;
        while (!set.empty()) {
            const auto found = by_maximum_.find(set.back());
            if (found == by_maximum_.end()) return;
            sum.clear();
            std::ranges::set_symmetric_difference(set, found->second, std::back_inserter(sum));
            set.swap(sum);
        }
    }
    /// Adds a set that is reduced and not empty.
    void add(std::vector<std::uint32_t> set) {
        const std::uint32_t maximum = set.back();
        by_maximum_.emplace(maximum, std::move(set));
    }
    std::size_t size() const { return by_maximum_.size(); }

  private:
    std::map<std::uint32_t, std::vector<std::uint32_t>> by_maximum_;
};

/// Finds the loops that pairs of cones close in a forest. Loop 0 is contractible.
class Loops {
  public:
    Loops(const CapsuleTree& capsules, const Pairs& pairs, const Forest& forest)
        : capsules_(capsules), pairs_(pairs), forest_(forest), sets_(pairs.size() + 1) {
        for (std::uint32_t i = 0; i < capsules.size(); ++i) {
            for (std::size_t k = pairs.begin(i); k < pairs.end(i); ++k) {
                step_back(k, i, pairs.second(k));
                step_back(k, pairs.second(k), i);
            }
        }
        loop_.resize(pairs.size());
        for (std::size_t k = 0; k < loop_.size(); ++k) {
            loop_[k] = sets_.find(static_cast<std::uint32_t>(k + 1));
        }
        find_open();
    }

    /// Returns the number of independent loops; of pairs of different trees, those that connect them count.
    std::size_t count(const Context& ctx) {
        for (std::uint32_t i = 0; i < capsules_.size(); ++i) {
            ctx.throw_if_cancelled();
            for (std::size_t k = pairs_.begin(i); k < pairs_.end(i); ++k) {
                if (is_open_[i] || is_open_[pairs_.second(k)]) relate_triples(i, k);
            }
        }
        std::size_t classes = 0;
        for (std::size_t k = 0; k < loop_.size(); ++k) classes += loop_[k] == k + 1 ? 1 : 0;
        return classes - relations_.size();
    }

  private:
    /// Moves a pair from cone i to the cone before it in its tree, where all three contain a point.
    void step_back(std::size_t pair, std::uint32_t i, std::uint32_t other) {
        const std::uint32_t to = forest_.previous[i];
        if (to == kNoIndex) return;
        const auto own = static_cast<std::uint32_t>(pair + 1);
        if (to == other) {
            sets_.join(own, 0);
        } else if (const std::size_t next = pairs_.find(to, other);
                   next < pairs_.size() && overlap(forest_.common[i], capsules_.cone(other))) {
            sets_.join(own, static_cast<std::uint32_t>(next + 1));
        }
    }

    /// Marks the cones of pairs that close loops.
    void find_open() {
        is_open_.assign(capsules_.size(), 0);
        for (std::uint32_t i = 0; i < capsules_.size(); ++i) {
            for (std::size_t k = pairs_.begin(i); k < pairs_.end(i); ++k) {
                if (loop_[k] != 0) is_open_[i] = is_open_[pairs_.second(k)] = 1;
            }
        }
    }

    /// Relates the loops of the triples of a pair of cone i with later cones.
    void relate_triples(std::uint32_t i, std::size_t pair) {
        const std::uint32_t j = pairs_.second(pair);
        std::size_t a = pair + 1, b = pairs_.begin(j);
        while (a < pairs_.end(i) && b < pairs_.end(j)) {
            if (pairs_.second(a) < pairs_.second(b)) {
                ++a;
            } else if (pairs_.second(b) < pairs_.second(a)) {
                ++b;
            } else {
                relate({pair, a, b}, {i, j, pairs_.second(a)});
                ++a;
                ++b;
            }
        }
    }

    void relate(const std::array<std::size_t, 3>& sides, const std::array<std::uint32_t, 3>& cones) {
        std::array<std::uint32_t, 3> loops{};
        std::ranges::transform(sides, loops.begin(), [&](std::size_t side) { return loop_[side]; });
        std::ranges::sort(loops);
        std::vector<std::uint32_t> set;
        for (const std::uint32_t loop : loops) {
            if (!set.empty() && set.back() == loop) {
                set.pop_back();
            } else if (loop != 0) {
                set.push_back(loop);
            }
        }
        relations_.reduce(set);
        if (set.empty()) return;
        if (overlap({&capsules_.cone(cones[0]), &capsules_.cone(cones[1]), &capsules_.cone(cones[2])})) {
            relations_.add(std::move(set));
        }
    }

    const CapsuleTree& capsules_;
    const Pairs& pairs_;
    const Forest& forest_;
    DisjointSets sets_;  // of pair k as k + 1
    std::vector<std::uint32_t> loop_;
    std::vector<std::uint8_t> is_open_;
    Relations relations_;
};

std::size_t count_components(const CapsuleTree& capsules, const Pairs& pairs) {
    DisjointSets sets(capsules.size());
    std::size_t count = capsules.size();
    for (std::uint32_t i = 0; i < capsules.size(); ++i) {
        for (std::size_t k = pairs.begin(i); k < pairs.end(i); ++k) {
            count -= sets.join(i, pairs.second(k)) ? 1 : 0;
        }
    }
    return count;
}

}  // namespace

std::optional<std::int64_t> count_union_handles(const CapsuleTree& capsules, const Skeleton& skeleton,
                                                const Context& ctx) {
    const Pairs pairs(capsules, ctx);
    if (pairs.is_crowded()) return std::nullopt;
    ctx.throw_if_cancelled();
    const Forest forest = make_forest(capsules, skeleton);
    const std::size_t loops = Loops(capsules, pairs, forest).count(ctx);
    const std::size_t joins = forest.trees - count_components(capsules, pairs);
    return static_cast<std::int64_t>(loops) - static_cast<std::int64_t>(joins);
}

}  // namespace coppice
