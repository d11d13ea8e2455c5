#include "coppice/growth/tidy.h"

#include <algorithm>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"

namespace coppice {
namespace {

constexpr std::size_t kTidyGrain = 1024;
constexpr int kRounds = 64;  // maximum number; then the edit is dropped for the remaining nodes

using Positions = std::vector<Vec3>;

Positions relaxed(const Skeleton& s, const Positions& p, float part) {
    Positions to = p;
    for (const NodeId n : nodes(s)) {
        if (!s.is_root(n)) to[n.index()] = lerp(p[n.index()], p[s.parent(n).index()], part);
    }
    return to;
}

Positions smoothed(const Skeleton& s, const Positions& p, float part) {
    Positions to = p;
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n) || s.is_tip(n)) continue;
        const Vec3 middle = lerp(p[s.parent(n).index()], p[s.leader(n).index()], 0.5f);
        to[n.index()] = lerp(p[n.index()], middle, part);
    }
    return to;
}

/// Keeps edits clear of the guard, if there is one.
class GuardCheck {
  public:
    GuardCheck(const Skeleton& s, const Guard* guard, const Context& ctx) : s_(s), guard_(guard), ctx_(ctx) {}

    /// Moves nodes back from `to` to `from` until no moved segment is excluded.
    std::uint32_t undo_barred(const Positions& from, Positions& to) const {
        if (!guard_) return 0;
        std::uint32_t held = 0;
        std::vector<char> look(s_.size(), 1);
        bool again = true;
        for (int round = 0; again && round < kRounds; ++round) {
            const std::vector<char> bad = barred(from, to, look);
            again = false;
            std::ranges::fill(look, 0);
            for (const NodeId n : nodes(s_)) {
                if (!bad[n.index()]) continue;
                again = true;
                held += undo(n, from, to, look) + undo(s_.parent(n), from, to, look);
            }
        }
        if (again) to = from;
        return held;
    }

    /// Returns the nodes with changed segments from the given parents that are excluded.
    std::vector<char> barred_from(std::span<const NodeId> parent, const Positions& p) const {
        std::vector<char> bad(s_.size(), 0);
        if (!guard_) return bad;
        parallel_for(ctx_, s_.size(), kTidyGrain, [&](std::size_t i) {
            const NodeId n(static_cast<std::uint32_t>(i));
            if (s_.is_root(n) || parent[i] == s_.parent(n)) return;
            bad[i] = !guard_->allows_segment(p[parent[i].index()], p[i]);
        });
        return bad;
    }

  private:
    std::vector<char> barred(const Positions& from, const Positions& to,
                             const std::vector<char>& look) const {
        std::vector<char> bad(s_.size(), 0);
        parallel_for(ctx_, s_.size(), kTidyGrain, [&](std::size_t i) {
            const NodeId n(static_cast<std::uint32_t>(i));
            if (s_.is_root(n)) return;
            const std::uint32_t a = s_.parent(n).index();
            if (!look[i] || (from[a] == to[a] && from[i] == to[i])) return;
            bad[i] = !guard_->allows_segment(to[a], to[i]);
        });
        return bad;
    }

    std::uint32_t undo(NodeId n, const Positions& from, Positions& to, std::vector<char>& look) const {
        if (to[n.index()] == from[n.index()]) return 0;
        to[n.index()] = from[n.index()];
        look[n.index()] = 1;
        for (const NodeId c : s_.children(n)) look[c.index()] = 1;
        return 1;
    }

    const Skeleton& s_;
    const Guard* guard_;
    const Context& ctx_;
};

double mean_length(const Skeleton& s, const Positions& p) {
    double sum = 0;
    for (const NodeId n : nodes(s)) {
        if (!s.is_root(n)) sum += distance(Vec3d(p[n.index()]), Vec3d(p[s.parent(n).index()]));
    }
    const std::uint32_t segments = s.size() - s.tree_count();
    return segments > 0 ? sum / segments : 0;
}

/// Lengths below which nodes are contracted.
struct Shortest {
    double step;    ///< [m] minimum length of any segment
    double within;  ///< [radius of the parent] minimum length
};

/// Returns for every node the node into which it is contracted, or itself. Nodes of `fixed` are kept.
std::vector<NodeId> contraction(const Skeleton& s, const Positions& p, const Shortest& shortest,
                                const std::vector<char>& fixed) {
    std::vector<NodeId> image(s.size());
    for (const NodeId n : nodes(s)) {
        image[n.index()] = n;
        if (s.is_root(n) || fixed[n.index()]) continue;
        const NodeId parent = image[s.parent(n).index()];
        const double least = std::max(shortest.step, shortest.within * s.radius(parent));
        if (distance(Vec3d(p[n.index()]), Vec3d(p[parent.index()])) < least) image[n.index()] = parent;
    }
    return image;
}

/// Contracts nodes, and omits the contraction next to a segment that would be excluded.
std::vector<NodeId> allowed_contraction(const Skeleton& s, const Positions& p, const Shortest& shortest,
                                        const GuardCheck& guarded, std::uint32_t& held) {
    std::vector<char> fixed(s.size(), 0);
    for (int round = 0; round < kRounds; ++round) {
        std::vector<NodeId> image = contraction(s, p, shortest, fixed);
        std::vector<NodeId> parent(s.size());
        for (const NodeId n : nodes(s)) {
            const bool stays = !s.is_root(n) && image[n.index()] == n;
            parent[n.index()] = stays ? image[s.parent(n).index()] : s.parent(n);
        }
        const std::vector<char> bad = guarded.barred_from(parent, p);
        bool again = false;
        for (const NodeId n : nodes(s)) {
            if (!bad[n.index()]) continue;
            // The parent was contracted, otherwise the segment would be unchanged.
            fixed[s.parent(n).index()] = 1;
            ++held;
            again = true;
        }
        if (!again) return image;
    }
    return contraction(s, p, {0, 0}, fixed);
}

TidyResult contracted(const Skeleton& s, const Positions& p, const std::vector<NodeId>& image) {
    std::vector<NodeId> new_of_old(s.size()), parents;
    Positions positions;
    std::vector<float> radii;
    for (const NodeId n : nodes(s)) {
        const NodeId stands = image[n.index()];
        if (stands == n) {
            new_of_old[n.index()] = NodeId(static_cast<std::uint32_t>(parents.size()));
            parents.push_back(s.is_root(n) ? NodeId::none() : new_of_old[s.parent(n).index()]);
            positions.push_back(p[n.index()]);
            radii.push_back(s.radius(n));
        } else {
            new_of_old[n.index()] = new_of_old[stands.index()];
        }
    }
    const auto gone = static_cast<std::uint32_t>(s.size() - parents.size());
    return {Skeleton(std::move(parents), std::move(positions), std::move(radii), s.origin()), gone, 0,
            std::move(new_of_old)};
}

}  // namespace

TidyResult tidy(const Skeleton& skeleton, const TidyOptions& options, const Guard* guard,
                const Context& ctx) {
    check_fields(options, "tidy");
    const GuardCheck guarded(skeleton, guard, ctx);
    Positions p(skeleton.positions().begin(), skeleton.positions().end());
    std::uint32_t held = 0;
    const auto passes =
        static_cast<std::size_t>(options.relax_passes) + static_cast<std::size_t>(options.smooth_passes);
    std::size_t done = 0;
    const auto pass = [&](auto&& move, float part) {
        check_in(ctx, done++, passes + 1);
        Positions to = move(skeleton, p, part);
        held += guarded.undo_barred(p, to);
        p = std::move(to);
    };
    for (int i = 0; i < options.relax_passes; ++i) pass(relaxed, options.relax);
    for (int i = 0; i < options.smooth_passes; ++i) pass(smoothed, options.smooth);
    const Shortest shortest{options.shortest * mean_length(skeleton, p), options.within};
    TidyResult result = contracted(skeleton, p, allowed_contraction(skeleton, p, shortest, guarded, held));
    result.held = held;
    ctx.report(1);
    return result;
}

void list_fields(TidyOptions& o, FieldList& list) {
    list.add(
        Field{"relax_passes", "Number of times that nodes move towards their parents.", Unit::none, 0, 100},
        o.relax_passes);
    list.add(Field{"relax", "Fraction of the distance to the parent that a node moves per pass.", Unit::none,
                   0, 1},
             o.relax);
    list.add(Field{"axis_passes", "Number of times that axes are smoothed.", Unit::none, 0, 1000},
             o.smooth_passes);
    list.add(Field{"axis_smoothing",
                   "Fraction of the distance to the middle of the neighbours that a node moves per pass.",
                   Unit::none, 0, 1},
             o.smooth);
    list.add(
        Field{"shortest", "Minimum length of segments relative to the mean; shorter ones are contracted.",
              Unit::none, 0, 2},
        o.shortest);
    list.add(Field{"within",
                   "Minimum distance of nodes to their parents; nearer ones are contracted into them; 0 "
                   "disables this.",
                   Unit::radius, 0, 2},
             o.within);
}

}  // namespace coppice
