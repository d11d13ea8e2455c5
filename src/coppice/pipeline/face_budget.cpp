#include "coppice/pipeline/face_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "coppice/pipeline/quads/quad_surface_internal.h"
#include "coppice/skeleton/chains_internal.h"

namespace coppice {
namespace {

constexpr std::uint64_t kFewest = 100, kMost = 100'000'000;
constexpr int kMaxLevels = 5;
// Rings stand so many times as close as with the given options.
constexpr double kLeastDensity = 0.1, kGreatestDensity = 16;
// The surface moves by this at most, in radii, where there are fewer rings.
constexpr float kMaxTolerance = 0.2f;
// What is near enough to the wanted number, and what is too far from it.
constexpr double kNear = 0.01, kFar = 0.05;
constexpr int kSteps = 12;

// The axes of a skeleton, chains that follow the leader, by the silhouette of each with all that it carries.
class AxesBySilhouette {
  public:
    explicit AxesBySilhouette(const Skeleton& s) : s_(s), area_(s.size(), 0) {
        for (const NodeId n : nodes(s)) {
            if (s.is_root(n)) continue;
            const NodeId p = s.parent(n);
            const bool leads = s.leader(p) == n;
            if (!leads) laterals_.push_back(n);
            if (!leads || s.is_root(p)) ++axes_;
        }
        for (std::uint32_t i = s.size(); i-- > 0;) {
            const NodeId n(i);
            if (s.is_root(n)) continue;
            const Segment seg = s.segment(n);
            area_[i] += double{distance(seg.a, seg.b)} * (double{seg.radius_a} + double{seg.radius_b});
            area_[s.parent(n).index()] += area_[i];
        }
        // An axis has less than the one that carries it, which therefore comes first.
        std::ranges::stable_sort(laterals_, std::greater<>{},
                                 [&](NodeId n) { return std::pair(area_[n.index()], ~n.index()); });
    }

    std::uint32_t count() const { return axes_; }
    std::uint32_t lateral_count() const { return static_cast<std::uint32_t>(laterals_.size()); }

    /// With so many of the laterals.
    Skeleton with(std::uint32_t laterals) const {
        std::vector<bool> kept = kept_with(laterals);
        return take_nodes(s_, kept, s_.positions(), s_.radii()).skeleton;
    }
    /// The share of the silhouette that is lost then.
    double share_without(std::uint32_t laterals) const {
        const std::vector<bool> kept = kept_with(laterals);
        double all = 0, lost = 0;
        for (const NodeId n : nodes(s_)) {
            if (s_.is_root(n)) {
                all += area_[n.index()];
            } else if (!kept[n.index()] && kept[s_.parent(n).index()]) {
                lost += area_[n.index()];
            }
        }
        return all > 0 ? lost / all : 0;
    }

  private:
    std::vector<bool> kept_with(std::uint32_t laterals) const {
        std::vector<bool> is_dropped(s_.size(), false), kept(s_.size(), true);
        for (std::size_t i = laterals; i < laterals_.size(); ++i) is_dropped[laterals_[i].index()] = true;
        for (const NodeId n : nodes(s_)) {
            if (!s_.is_root(n)) kept[n.index()] = kept[s_.parent(n).index()] && !is_dropped[n.index()];
        }
        return kept;
    }

    const Skeleton& s_;
    std::vector<double> area_;      // [m^2] of the segment that ends at a node and all that it carries
    std::vector<NodeId> laterals_;  // the first nodes of axes that may go, by silhouette
    std::uint32_t axes_ = 0;
};

MeshOptions with_density(MeshOptions options, double density) {
    ResampleOptions& o = options.prepare.resample;
    const auto scale = static_cast<float>(density);
    if (density < 1) o.tolerance = std::max(o.tolerance, std::min(o.tolerance / scale, kMaxTolerance));
    o.max_length = std::clamp(o.max_length / scale, 1.0f, 1e6f);
    return options;
}

class Planner {
  public:
    Planner(const Skeleton& skeleton, const MeshOptions& given, std::uint64_t faces, const Context& ctx)
        : skeleton_(skeleton), given_(given), goal_(static_cast<double>(faces)), ctx_(ctx), axes_(skeleton) {
        ctx_.progress = {};  // that of one cage is none of the plan
    }

    FaceBudget plan() {
        const double normal = count(skeleton_, 1), sparsest = count(skeleton_, kLeastDensity);
        int levels = std::clamp(static_cast<int>(std::lround(std::log(goal_ / normal) / std::log(4.0))), 0,
                                kMaxLevels);
        // Rather more rings than fewer branches.
        if (levels > 0 && sparsest > wanted(levels)) --levels;
        const std::uint32_t all = axes_.lateral_count();
        const std::uint32_t laterals = sparsest <= wanted(levels) ? all : most_laterals(levels);
        const Skeleton drawn = laterals < all ? axes_.with(laterals) : skeleton_;
        Rings best = rings_at(levels, drawn);
        // A few branches have too few rings to choose from: faces four times as many and as large do better.
        if (levels > 0 && off(best) > kFar) {
            const Rings more = rings_at(levels - 1, drawn);
            if (off(more) < off(best)) best = more;
        }
        FaceBudget out{drawn,          with_density(given_, best.density), 0, axes_.count(),
                       all - laterals, axes_.share_without(laterals)};
        out.options.levels = best.levels;
        out.faces = static_cast<std::uint64_t>(best.faces) << (2 * best.levels);
        return out;
    }

  private:
    // Levels, how near rings stand, and how many faces the cage then has.
    struct Rings {
        int levels = 0;
        double density = 1, faces = 0;
    };

    // Faces of the cage.
    double wanted(int levels) const { return std::ldexp(goal_, -2 * levels); }
    double off(const Rings& r) const { return std::abs(r.faces / wanted(r.levels) - 1); }
    double count(const Skeleton& s, double density) const {
        ctx_.throw_if_cancelled();
        const MeshOptions options = with_density(given_, density);
        const PrepareResult prepared = prepare(s, options.prepare);
        check_branches(prepared.skeleton);
        return static_cast<double>(cage_of(prepared.skeleton, options, ctx_).cage.quads.size());
    }

    // That with the rings farthest apart have no more faces than are wanted.
    std::uint32_t most_laterals(int levels) const {
        std::uint32_t fits = 0, too_many = axes_.lateral_count();
        while (fits + 1 < too_many) {
            const std::uint32_t middle = fits + (too_many - fits) / 2;
            (count(axes_.with(middle), kLeastDensity) <= wanted(levels) ? fits : too_many) = middle;
        }
        return fits;
    }

    Rings rings_at(int levels, const Skeleton& drawn) const {
        Rings best{levels};
        const auto has_more = [&](double density) {
            const Rings r{levels, density, count(drawn, density)};
            if (best.faces == 0 || off(r) < off(best)) best = r;
            return r.faces >= wanted(levels);
        };
        double low = kLeastDensity, high = kGreatestDensity;
        (has_more(1) ? high : low) = 1;
        if (high == 1 && has_more(low)) return best;
        for (int step = 0; step < kSteps && off(best) > kNear; ++step) {
            const double middle = std::sqrt(low * high);
            (has_more(middle) ? high : low) = middle;
        }
        return best;
    }

    const Skeleton& skeleton_;
    const MeshOptions& given_;
    double goal_;
    Context ctx_;
    AxesBySilhouette axes_;
};

}  // namespace

FaceBudget plan_faces(const Skeleton& skeleton, const MeshOptions& given, std::uint64_t faces,
                      const Context& ctx) {
    if (faces < kFewest || faces > kMost)
        throw InvalidInput(
            fmt::format("mesh: faces must be from {} to {}, but is {}", kFewest, kMost, faces));
    if (given.method != MeshMethod::quads && given.method != MeshMethod::bmesh)
        throw InvalidInput("mesh: method must be quads or bmesh for a number of faces");
    return Planner(skeleton, given, faces, ctx).plan();
}

}  // namespace coppice
