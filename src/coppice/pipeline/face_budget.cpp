#include "coppice/pipeline/face_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <utility>

#include "coppice/base/progress.h"
#include "coppice/pipeline/quads/quad_surface_internal.h"
#include "coppice/pipeline/quantity.h"
#include "coppice/pipeline/stages_internal.h"
#include "coppice/skeleton/chains_internal.h"

namespace coppice {
namespace {

constexpr int kMaxLevels = 5;
// Rings stand so many times as close as with the given options.
constexpr double kMinDensity = 0.1, kMaxDensity = 16;
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

// The faces of the cage of a skeleton by how near rings stand, each counted once.
class CageFaces {
  public:
    CageFaces(Skeleton skeleton, const MeshOptions& given, const Context& ctx)
        : skeleton_(std::move(skeleton)), given_(&given), ctx_(&ctx) {}

    const Skeleton& skeleton() const { return skeleton_; }
    double at(double density) {
        const auto [found, is_new] = counts_.try_emplace(density, 0.0);
        if (is_new) found->second = count(with_density(*given_, density));
        return found->second;
    }

  private:
    double count(const MeshOptions& options) const {
        ctx_->throw_if_cancelled();
        const PrepareResult prepared = prepare(skeleton_, options.prepare);
        check_branches(prepared.skeleton);
        return static_cast<double>(cage_of(prepared.skeleton, options, *ctx_).cage.quads.size());
    }

    Skeleton skeleton_;
    const MeshOptions* given_;
    const Context* ctx_;
    std::map<double, double> counts_;
};

class Planner {
  public:
    Planner(const Skeleton& skeleton, const MeshOptions& given, std::uint64_t faces, const Context& ctx)
        : skeleton_(skeleton), given_(given), goal_(static_cast<double>(faces)), ctx_(ctx), axes_(skeleton) {
        ctx_.progress = {};  // that of one cage is none of the plan
    }

    FaceBudget plan() {
        CageFaces drawn(skeleton_, given_, ctx_);
        int levels = std::clamp(static_cast<int>(std::lround(std::log(goal_ / drawn.at(1)) / std::log(4.0))),
                                0, kMaxLevels);
        // Rather more rings than fewer branches.
        if (levels > 0 && drawn.at(kMinDensity) > wanted(levels)) --levels;
        std::uint32_t laterals = axes_.lateral_count();
        if (drawn.at(kMinDensity) > wanted(levels)) {
            laterals = most_laterals(levels);
            if (laterals < axes_.lateral_count()) drawn = with(laterals);
        }
        Rings best = rings_at(levels, drawn);
        // A few branches have too few rings to choose from: faces four times as many and as large do better.
        if (levels > 0 && off(best) > kFar) {
            const Rings more = rings_at(levels - 1, drawn);
            if (off(more) < off(best)) best = more;
        }
        FaceBudget out{drawn.skeleton(), with_density(given_, best.density), 0,
                       axes_.count(),    axes_.lateral_count() - laterals,   axes_.share_without(laterals)};
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
    CageFaces with(std::uint32_t laterals) const { return {axes_.with(laterals), given_, ctx_}; }

    // That with the rings farthest apart have no more faces than are wanted.
    std::uint32_t most_laterals(int levels) const {
        std::uint32_t fits = 0, too_many = axes_.lateral_count();
        while (fits + 1 < too_many) {
            const std::uint32_t middle = fits + (too_many - fits) / 2;
            (with(middle).at(kMinDensity) <= wanted(levels) ? fits : too_many) = middle;
        }
        return fits;
    }

    Rings rings_at(int levels, CageFaces& drawn) const {
        Rings best{levels};
        const auto has_more = [&](double density) {
            const Rings r{levels, density, drawn.at(density)};
            if (best.faces == 0 || off(r) < off(best)) best = r;
            return r.faces >= wanted(levels);
        };
        double low = kMinDensity, high = kMaxDensity;
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
    if (faces < kMinFaces || faces > kMaxFaces)
        throw InvalidInput(
            fmt::format("mesh: faces must be from {} to {}, but is {}", kMinFaces, kMaxFaces, faces));
    if (given.method != MeshMethod::quads && given.method != MeshMethod::bmesh)
        throw InvalidInput("mesh: method must be quads or bmesh for a number of faces");
    return Planner(skeleton, given, faces, ctx).plan();
}

BudgetedMesh mesh_with_faces(const Skeleton& skeleton, const PointSet& constraints,
                             const MeshOptions& options, std::uint64_t faces, const Context& ctx) {
    constexpr double kClose = 0.03;  // of the number: no further plan
    constexpr int kPlans = 6;
    std::vector<std::pair<std::string, double>> planned, tried;
    const auto make = [&](std::uint64_t goal) {
        FaceBudget budget = Stages(ctx, planned).run("plan", 0, [&] {
            return plan_faces(skeleton, options, goal, part_of(ctx, 0, 0));
        });
        MeshResult result = Stages(ctx, tried).run("try", 0, [&] {
            return mesh_skeleton(budget.skeleton, constraints, budget.options, ctx);
        });
        return BudgetedMesh{std::move(budget), std::move(result)};
    };
    const double wanted = static_cast<double>(faces);
    const auto faces_of = [](const BudgetedMesh& m) {
        return static_cast<double>(m.result.quads().mesh.quads.size());
    };
    const auto off = [&](const BudgetedMesh& m) { return std::abs(faces_of(m) / wanted - 1); };
    std::array<double, 2> low{1, 1}, high{0, 0};  // planned and made, below and above what is wanted
    BudgetedMesh best = make(faces);
    double goal = wanted, made = faces_of(best);
    const bool is_remeshed = std::abs(made / static_cast<double>(best.budget.faces) - 1) > kClose;
    for (int plan = 1; is_remeshed && plan < kPlans && off(best) > kClose; ++plan) {
        (made < wanted ? low : high) = {goal, made};
        // By a power of what is planned.
        goal =
            high[0] > 0 && low[0] > 1
                ? low[0] * std::pow(high[0] / low[0], std::log(wanted / low[1]) / std::log(high[1] / low[1]))
                : goal * wanted / made;
        BudgetedMesh next = make(std::max(kMinFaces, static_cast<std::uint64_t>(goal)));
        made = faces_of(next);
        if (off(next) < off(best)) best = std::move(next);
    }
    const auto total = [](const auto& stages) {
        return std::accumulate(stages.begin(), stages.end(), 0.0,
                               [](double sum, const auto& stage) { return sum + stage.second; });
    };
    auto& stages = best.result.stages;
    const double others = total(tried) - total(stages);
    stages.insert(stages.begin(), {"plan", total(planned)});
    if (tried.size() > 1) stages.insert(stages.begin() + 1, {"other plans", others});
    return best;
}

std::string text_of(const FaceBudget& budget) {
    return fmt::format("level {}, {} of {} axes, without {:.1f} % of the silhouette", budget.options.levels,
                       grouped(budget.axes - budget.dropped), grouped(budget.axes),
                       100 * budget.dropped_silhouette);
}

std::string text_of_missed_faces(const BudgetedMesh& made, std::uint64_t faces) {
    const std::size_t has = made.result.quads().mesh.quads.size();
    if (std::abs(static_cast<double>(has) / static_cast<double>(faces) - 1) <= kFar) return {};
    return fmt::format(
        "the surface has {} faces instead of {}: no choice of levels, rings and branches comes nearer",
        grouped(has), grouped(faces));
}

}  // namespace coppice
