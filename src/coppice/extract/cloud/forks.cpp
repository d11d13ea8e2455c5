#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "coppice/base/round_cone.h"
#include "coppice/extract/cloud/draft_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr double kBend = 2;       // how much a detour by bending counts, against length
constexpr double kReach = 3;      // [radius] of what it leaves, how far from its fork a lateral may start
constexpr double kDirection = 5;  // [radius] over which the direction of a lateral is taken
constexpr int kPlaces = 8;        // on a segment, that a lateral may start from

/// A place on the segment that ends at `node`.
struct Place {
    std::uint32_t node = kNone;
    double t = 1;  ///< from the parent, 0, to the node, 1
    Vec3d at;
    double radius = 0;
    double cost = std::numeric_limits<double>::infinity();
};

struct Move {
    std::uint32_t lateral;
    Place to;
};

/// For every node the child with the longest way to a tip, or kNone.
std::vector<std::uint32_t> axes_of(const DraftTree& tree) {
    std::vector<std::uint32_t> next(tree.size(), kNone);
    std::vector<double> longest(tree.size(), 0);
    for (std::uint32_t n = tree.size(); n-- > 0;) {
        const std::uint32_t q = tree.parent[n];
        if (q == kNone) continue;
        const double way = longest[n] + distance(tree.position[n], tree.position[q]);
        if (next[q] != kNone && way < longest[q]) continue;
        longest[q] = way;
        next[q] = n;
    }
    return next;
}

class ForkSettler {
  public:
    ForkSettler(DraftTree& tree, FitSamples& samples)
        : tree_(tree),
          samples_(samples),
          next_(axes_of(tree)),
          links_(tree),
          gone_(tree.size(), 0),
          stands_for_(tree.size()) {
        std::iota(stands_for_.begin(), stands_for_.end(), 0u);
    }

    void run(const Context& ctx) {
        for (std::uint32_t n = 0; n < gone_.size(); ++n) {
            const std::uint32_t fork = tree_.parent[n];
            if (fork == kNone || next_[fork] == n) continue;
            ctx.throw_if_cancelled();
            const std::uint32_t outer = outer_node(n, fork);
            const Place place = best_place(outer, fork);
            if (place.node != kNone) {
                moves_.push_back({outer, place});
            } else {
                tree_.parent[outer] = fork;
            }
        }
        carry_out();
        gone_.resize(tree_.size(), 0);
        const auto new_of_old = sort_parents_first(tree_, gone_);
        for (std::uint32_t& n : samples_.node) {
            if (n == kNone) continue;
            while (stands_for_[n] != n) n = stands_for_[n];
            n = new_of_old[n];
        }
    }

  private:
    /// Visits the segments of the axis that a fork lies on, as far as a lateral from p may start.
    template <class Visit>
    void visit_host(std::uint32_t fork, Vec3d p, const Visit& visit) const {
        const double reach = kReach * tree_.radius[fork] + distance(p, tree_.position[fork]);
        double way = 0;
        for (std::uint32_t q = fork; tree_.parent[q] != kNone && way < reach; q = tree_.parent[q]) {
            visit(q);
            way += distance(tree_.position[q], tree_.position[tree_.parent[q]]);
        }
        way = 0;
        for (std::uint32_t q = next_[fork]; q != kNone && way < reach; q = next_[q]) {
            visit(q);
            way += distance(tree_.position[q], tree_.position[tree_.parent[q]]);
        }
    }

    /// The first node of a lateral that lies outside of what it leaves; those before it are marked as gone.
    std::uint32_t outer_node(std::uint32_t lateral, std::uint32_t fork) {
        std::uint32_t n = lateral;
        for (; next_[n] != kNone && links_.children(n).size() == 1; n = next_[n]) {
            const Vec3d p = tree_.position[n];
            bool inside = false;
            visit_host(fork, p, [&](std::uint32_t q) {
                inside = inside || axis_cone(tree_, q).foot(p).signed_distance() <= 0;
            });
            if (!inside) break;
            gone_[n] = 1;
            stands_for_[n] = next_[n];
        }
        return n;
    }

    /// Where the lateral points to, as seen over some radii.
    Vec3d direction_of(std::uint32_t n) const {
        std::uint32_t m = n;
        while (next_[m] != kNone &&
               distance(tree_.position[m], tree_.position[n]) < kDirection * tree_.radius[n])
            m = next_[m];
        return normalized(tree_.position[m] - tree_.position[n], {});
    }

    /// The place from which the way to a lateral is short and leads on as the lateral does.
    Place best_place(std::uint32_t lateral, std::uint32_t fork) const {
        const Vec3d start = tree_.position[lateral], direction = direction_of(lateral);
        Place best;
        visit_host(fork, start, [&](std::uint32_t q) {
            const std::uint32_t above = tree_.parent[q];
            if (gone_[q] || gone_[above]) return;
            const RoundCone cone = axis_cone(tree_, q);
            // The first segment of another lateral is about to move: only its end will do.
            for (int k = next_[above] == q ? 0 : kPlaces; k <= kPlaces; ++k) {
                const double t = static_cast<double>(k) / kPlaces;
                const Vec3d at = cone.point(t), way = start - at;
                const double l = length(way), cost = l + kBend * (l - dot(way, direction));
                if (cost < best.cost) best = {q, t, at, cone.radius(t), cost};
            }
        });
        return best;
    }

    /// Hangs the laterals where they belong. Of several on one segment the new nodes follow one another.
    void carry_out() {
        std::ranges::stable_sort(moves_, [](const Move& a, const Move& b) {
            return a.to.node != b.to.node ? a.to.node < b.to.node : a.to.t < b.to.t;
        });
        for (std::size_t i = 0; i < moves_.size();) {
            const std::uint32_t node = moves_[i].to.node;
            std::uint32_t below = tree_.parent[node];
            double last = 0;
            for (; i < moves_.size() && moves_[i].to.node == node; ++i) {
                const Place& to = moves_[i].to;
                if (to.t > last && to.t < 1) {
                    below = tree_.add(below, to.at, to.radius);
                    last = to.t;
                }
                tree_.parent[moves_[i].lateral] = to.t == 1 ? node : below;
            }
            tree_.parent[node] = below;
        }
    }

    DraftTree& tree_;
    FitSamples& samples_;
    std::vector<std::uint32_t> next_;
    DraftLinks links_;
    std::vector<char> gone_;
    std::vector<std::uint32_t> stands_for_;
    std::vector<Move> moves_;
};

}  // namespace

void settle_forks(DraftTree& tree, FitSamples& samples, const Context& ctx) {
    ForkSettler(tree, samples).run(ctx);
}

}  // namespace coppice::extract_internal
