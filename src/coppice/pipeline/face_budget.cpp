#include "coppice/pipeline/face_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "coppice/base/option_fields.h"
#include "coppice/options/quantity.h"
#include "coppice/pipeline/coarsen/node_levels_internal.h"
#include "coppice/pipeline/coarsen/selection_internal.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/quads/quad_surface_internal.h"
#include "coppice/pipeline/stages_internal.h"
#include "coppice/skeleton/chains_internal.h"

namespace coppice {
namespace {

constexpr int kMaxLevels = 5;
// Levels of a surface that is thinned out to the sides of its cage, since cages are not repaired.
constexpr int kRepairedLevels = 1;
// Density of rings relative to the given options.
constexpr double kMinDensity = 0.1, kMaxDensity = 16;
// [radii] maximum displacement of the surface by a lower density of rings.
constexpr float kMaxTolerance = 0.2f;
// Errors of the number of faces, as compute_error() returns them: accepted as exact, and rejected.
constexpr double kNear = 0.01, kFar = 0.05;
constexpr int kSteps = 12;

// Returns the relative error of a number of faces; half as many and twice as many are equally wrong.
double compute_error(double faces, double wanted) { return std::abs(std::log(faces / wanted)); }

// The axes of a skeleton (chains of leaders), sorted by the silhouette of each with everything that it
// carries.
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
        // The silhouette of an axis is smaller than that of its parent, so the parent comes first.
        std::ranges::stable_sort(laterals_, std::greater<>{},
                                 [&](NodeId n) { return std::pair(area_[n.index()], ~n.index()); });
    }

    std::uint32_t count() const { return axes_; }
    std::uint32_t lateral_count() const { return static_cast<std::uint32_t>(laterals_.size()); }

    /// Returns the skeleton with the given number of laterals.
    Skeleton with(std::uint32_t laterals) const {
        std::vector<bool> kept = kept_with(laterals);
        return take_nodes(s_, kept, s_.positions(), s_.radii()).skeleton;
    }
    /// Returns the share of the silhouette that is lost with this number of laterals.
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
    std::vector<NodeId> laterals_;  // first nodes of removable axes, by silhouette
    std::uint32_t axes_ = 0;
};

MeshOptions with_density(MeshOptions options, double density) {
    ResampleOptions& o = options.prepare.resample;
    const auto scale = static_cast<float>(density);
    if (density < 1) o.tolerance = std::max(o.tolerance, std::min(o.tolerance / scale, kMaxTolerance));
    o.max_length = std::clamp(o.max_length / scale, 1.0f, 1e6f);
    return options;
}

QuadBuild cage_with(const Skeleton& skeleton, const MeshOptions& options, Context ctx) {
    ctx.throw_if_cancelled();
    ctx.progress = {};  // the progress of one cage is not the progress of the plan
    const PrepareResult prepared = prepare(skeleton, options.prepare);
    check_branches(prepared.skeleton);
    return build_cage(prepared.skeleton, options, ctx);
}

// Number of faces of the cage of a skeleton as a function of the density of rings; each density is computed
// once.
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
        return static_cast<double>(cage_with(skeleton_, options, *ctx_).cage.cage.quads.size());
    }

    Skeleton skeleton_;
    const MeshOptions* given_;
    const Context* ctx_;
    std::map<double, double> counts_;
};

// Returns a plan with all branches and the given options.
FaceBudget plan_with_all(const Skeleton& skeleton, const MeshOptions& given) {
    return {skeleton, given, 0, AxesBySilhouette(skeleton).count()};
}

// Plans with sides by radius, and the branches and rings of another plan.
class RadiusPlanner {
  public:
    RadiusPlanner(FaceBudget base, const Context& ctx)
        : base_(std::move(base)),
          cage_(cage_with(base_.skeleton, base_.options, ctx)),
          thickest_(pipeline_internal::thickest_radius(cage_.tubes)) {}

    // [m] chord error at which the thickest axis has as many sides as this number of levels produces.
    float chord_error_at(int levels) const {
        return pipeline_internal::chord_error_at(thickest_, sides(), levels);
    }

    // More levels would need too much memory before quads are removed.
    int max_levels(double goal) const {
        const auto cage_faces = static_cast<double>(cage_.cage.cage.quads.size());
        const auto most = static_cast<int>(std::log2(kMaxRefinedFaces * goal / cage_faces) / 2);
        return std::clamp(most, 1, kMaxLevels);
    }

    FaceBudget with(int levels, float chord_error) const {
        FaceBudget out = base_;
        out.faces = faces_with(levels, chord_error);
        out.options.tube_sides = TubeSides::by_radius;
        out.options.chord_error = chord_error;
        out.options.levels = levels;
        return out;
    }

    // Returns nullopt if there are more faces than requested even with at most eight sides.
    std::optional<FaceBudget> plan(double goal) const {
        int levels = max_levels(goal);
        while (levels > 1 && !fits(levels, goal)) --levels;
        if (!fits(levels, goal)) return {};
        float low = chord_error_at(kMaxLevels + 1), high = chord_error_at(levels);
        while (high > 1.001f * low) {
            const float middle = std::sqrt(low * high);
            (static_cast<double>(faces_with(levels, middle)) > goal ? low : high) = middle;
        }
        return with(levels, high);
    }

  private:
    std::uint32_t sides() const { return static_cast<std::uint32_t>(base_.options.control.sides); }
    bool fits(int levels, double goal) const {
        return static_cast<double>(faces_with(levels, chord_error_at(levels))) <= goal;
    }
    std::uint64_t faces_with(int levels, float chord_error) const {
        return pipeline_internal::faces_by_radius(cage_.cage, cage_.tubes, levels, chord_error);
    }

    FaceBudget base_;
    QuadBuild cage_;
    float thickest_;
};

// Number of levels, density of the rings, and resulting numbers of faces of the cage and of the surface.
struct Rings {
    int levels = 0;
    double density = 1, faces = 0;
    double surface_faces() const { return std::ldexp(faces, 2 * levels); }
};

// Returns the density of rings at which the cage has approximately this number of faces.
Rings density_for(double wanted, CageFaces& cage) {
    Rings best;
    const auto off = [&](const Rings& r) { return compute_error(r.faces, wanted); };
    const auto has_more = [&](double density) {
        const Rings r{0, density, cage.at(density)};
        if (best.faces == 0 || off(r) < off(best)) best = r;
        return r.faces >= wanted;
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

// Plans with the same number of sides everywhere. Counts are stored for the following plans.
class RingPlanner {
  public:
    RingPlanner(const Skeleton& skeleton, const MeshOptions& given, const Context& ctx)
        : skeleton_(skeleton), given_(given), ctx_(ctx), axes_(skeleton), all_(skeleton, given, ctx) {}

    FaceBudget plan(double goal) {
        int levels = levels_closest_to(goal);
        // Prefers more rings to fewer branches.
        if (levels > 0 && all_.at(kMinDensity) > cage_goal(goal, levels)) --levels;
        std::uint32_t laterals = axes_.lateral_count();
        std::optional<CageFaces> some;
        if (all_.at(kMinDensity) > cage_goal(goal, levels)) {
            laterals = max_laterals(cage_goal(goal, levels));
            if (laterals < axes_.lateral_count()) some = with(laterals);
        }
        CageFaces& drawn = some ? *some : all_;
        Rings best = rings_at(goal, levels, drawn);
        // With few branches there are too few rings to choose from: four times as many and as large faces
        // come closer.
        if (levels > 0 && compute_error(best.surface_faces(), goal) > kFar) {
            const Rings more = rings_at(goal, levels - 1, drawn);
            if (compute_error(more.surface_faces(), goal) < compute_error(best.surface_faces(), goal))
                best = more;
        }
        FaceBudget out{drawn.skeleton(),
                       with_density(given_, best.density),
                       static_cast<std::uint64_t>(best.surface_faces()),
                       axes_.count(),
                       axes_.lateral_count() - laterals,
                       axes_.share_without(laterals)};
        if (best.levels == 0 && given_.tube_sides == TubeSides::by_radius) {
            out.options.levels = kRepairedLevels;
            out.options.chord_error = *std::ranges::max_element(skeleton_.radii());
        } else {
            out.options.levels = best.levels;
            out.options.tube_sides = TubeSides::equal;
        }
        return out;
    }

  private:
    // Returns the number of faces of a cage for a surface with the requested number.
    static double cage_goal(double goal, int levels) { return std::ldexp(goal, -2 * levels); }
    int levels_closest_to(double goal) {
        const double levels = std::log(goal / all_.at(1)) / std::log(4.0);
        return std::clamp(static_cast<int>(std::lround(levels)), 0, kMaxLevels);
    }
    CageFaces with(std::uint32_t laterals) const { return {axes_.with(laterals), given_, ctx_}; }

    // Returns the minimum number of faces of a cage with some laterals.
    double min_faces(std::uint32_t laterals) {
        const auto [found, is_new] = min_faces_.try_emplace(laterals, 0.0);
        if (is_new) found->second = with(laterals).at(kMinDensity);
        return found->second;
    }

    // Returns the maximum number of laterals of a cage with this number of faces.
    std::uint32_t max_laterals(double cage_faces) {
        std::uint32_t fits = 0, too_many = axes_.lateral_count();
        while (fits + 1 < too_many) {
            const std::uint32_t middle = fits + (too_many - fits) / 2;
            (min_faces(middle) <= cage_faces ? fits : too_many) = middle;
        }
        return fits;
    }

    static Rings rings_at(double goal, int levels, CageFaces& drawn) {
        Rings out = density_for(cage_goal(goal, levels), drawn);
        out.levels = levels;
        return out;
    }

    const Skeleton& skeleton_;
    const MeshOptions& given_;
    const Context& ctx_;
    AxesBySilhouette axes_;
    CageFaces all_;
    std::map<std::uint32_t, double> min_faces_;  // by the number of laterals
};

void check_budget(const MeshOptions& given, std::uint64_t faces) {
    if (faces < kMinFaces || faces > kMaxFaces)
        throw InvalidInput(
            fmt::format("mesh: faces must be from {} to {}, but is {}", kMinFaces, kMaxFaces, faces));
    if (given.method != MeshMethod::quads && given.method != MeshMethod::bmesh)
        throw InvalidInput("mesh: method must be quads or bmesh for a number of faces");
    if (given.chord_error != 0)
        throw InvalidInput("mesh: a number of faces chooses chord_error; leave it out");
}

// Returns the options with which a number of faces is planned.
MeshOptions options_of_plan(MeshOptions given) {
    if (given.tube_sides == TubeSides::automatic) given.tube_sides = TubeSides::by_radius;
    return given;
}

// Builds surfaces until one has approximately the requested number of faces.
class BudgetSearch {
  public:
    BudgetSearch(const Skeleton& skeleton, const PointSet& constraints, const MeshOptions& options,
                 std::uint64_t faces, const Context& ctx)
        : skeleton_(skeleton),
          constraints_(constraints),
          options_(options_of_plan(options)),
          faces_(faces),
          ctx_(ctx) {}

    BudgetedMesh run() {
        if (options_.tube_sides == TubeSides::by_radius) search_sides(plan_with_all(skeleton_, options_));
        // Many branches may have the same radius, so that no number of sides gives the requested number.
        if (best_ && !is_close()) search_density(below_.value_or(Made{best_->budget, count(*best_)}));
        if (!is_close()) search_rings();
        // A branch may add many faces at once, where it intersects others.
        if (!is_close() && below_ && options_.tube_sides == TubeSides::by_radius) {
            search_sides(FaceBudget(below_->budget));
            if (!is_close()) search_density(Made(*below_));
        }
        name_stages();
        return std::move(*best_);
    }

  private:
    // Result of a search: a number close to the requested one or numbers on both sides of it, or on one side
    // only.
    enum class Found { enough, too_few, too_many };
    // A plan and the number of faces of its surface.
    struct Made {
        FaceBudget budget;
        double faces;
    };

    static double count(const BudgetedMesh& m) {
        return static_cast<double>(m.result.quads().mesh.quads.size());
    }
    double wanted() const { return static_cast<double>(faces_); }
    double off(const BudgetedMesh& m) const { return compute_error(count(m), wanted()); }
    bool is_close() const { return best_ && off(*best_) <= kFar; }

    template <class Plan>
    auto planned(const Plan& plan) {
        return Stages(ctx_, planned_).run("plan", 0, plan);
    }

    // Builds a surface, keeps it if it is the best, and returns its number of faces.
    double make(FaceBudget budget) {
        MeshResult result = Stages(ctx_, tried_).run("try", 0, [&] {
            return mesh_skeleton(budget.skeleton, constraints_, budget.options, ctx_);
        });
        BudgetedMesh made{std::move(budget), std::move(result)};
        const double faces = count(made);
        if (faces < wanted() && (!below_ || faces > below_->faces)) below_ = Made{made.budget, faces};
        if (!best_ || off(made) < off(*best_)) best_ = std::move(made);
        return faces;
    }

    void search_sides(FaceBudget base) {
        constexpr double kMadeOfPlanned = 2;  // approximate: bends and branch nodes have more than planned
        std::optional<RadiusPlanner> planner;
        const std::optional<FaceBudget> first = planned([&] {
            planner.emplace(std::move(base), ctx_);
            std::optional<FaceBudget> plan = planner->plan(wanted() / kMadeOfPlanned);
            return plan ? plan : planner->plan(wanted());
        });
        if (!first) return;
        // The number of sides is approximately proportional to the root.
        const auto density = [](float chord_error) { return 1 / std::sqrt(double{chord_error}); };
        const auto search_with = [&](int levels, double at) {
            const double least = density(planner->chord_error_at(levels));
            return search(std::max(at, least), least,
                          [&](double d) { return planner->with(levels, static_cast<float>(1 / (d * d))); });
        };
        int levels = first->options.levels;
        double at = density(first->options.chord_error);
        const int most = planner->max_levels(wanted());
        Found found = search_with(levels, at);
        while (found == Found::too_few && levels < most) found = search_with(++levels, at);
        while (found == Found::too_many && levels > 1) {
            at = density(planner->chord_error_at(levels));
            found = search_with(--levels, at);
        }
    }

    // Uses the sides and branches of a plan and changes the density of the rings.
    void search_density(const Made& from) {
        CageFaces cage(from.budget.skeleton, from.budget.options, ctx_);
        search(wanted() / from.faces, 0, [&](double share) {
            FaceBudget out = from.budget;
            out.options = with_density(out.options, density_for(share * cage.at(1), cage).density);
            out.faces = faces_;
            return out;
        });
    }

    void search_rings() {
        RingPlanner planner(skeleton_, options_, ctx_);
        search(wanted(), double{kMinFaces}, [&](double goal) { return planner.plan(goal); });
    }

    // Tries numbers that are not below `least`, assuming that the number of faces is approximately a power of
    // them.
    template <class Plan>
    Found search(double first, double least, const Plan& plan) {
        constexpr double kClose = 0.03;  // relative error at which the search ends
        constexpr int kTries = 6;
        std::array<double, 2> low{0, 0}, high{0, 0};  // tried value and result, below and above the request
        double at = first, before = 0;
        for (int i = 0; i < kTries; ++i) {
            const double made = make(planned([&] { return plan(at); }));
            if (compute_error(made, wanted()) < kClose) return Found::enough;
            (made < wanted() ? low : high) = {at, made};
            if (made == before || (made > wanted() && at <= least)) break;
            before = made;
            at = std::max(least, next_try(at, made, low, high));
        }
        if (low[0] > 0 && high[0] > 0) return Found::enough;
        return low[0] > 0 ? Found::too_few : Found::too_many;
    }

    double next_try(double at, double made, const std::array<double, 2>& low,
                    const std::array<double, 2>& high) const {
        if (low[0] == 0 || high[0] == 0) return at * wanted() / made;
        const double power = std::log(wanted() / low[1]) / std::log(high[1] / low[1]);
        return low[0] * std::pow(high[0] / low[0], power);
    }

    void name_stages() {
        const auto total = [](const auto& stages) {
            return std::accumulate(stages.begin(), stages.end(), 0.0,
                                   [](double sum, const auto& stage) { return sum + stage.second; });
        };
        auto& stages = best_->result.stages;
        const double others = total(tried_) - total(stages);
        stages.insert(stages.begin(), {"plan", total(planned_)});
        if (tried_.size() > 1) stages.insert(stages.begin() + 1, {"other plans", others});
    }

    const Skeleton& skeleton_;
    const PointSet& constraints_;
    MeshOptions options_;
    std::uint64_t faces_;
    const Context& ctx_;
    std::vector<std::pair<std::string, double>> planned_, tried_;
    std::optional<BudgetedMesh> best_;
    std::optional<Made> below_;  // the closest with fewer faces than requested
};

}  // namespace

FaceBudget plan_faces(const Skeleton& skeleton, const MeshOptions& given, std::uint64_t faces,
                      const Context& ctx) {
    check_budget(given, faces);
    const MeshOptions options = options_of_plan(given);
    const auto goal = static_cast<double>(faces);
    const auto off = [&](const FaceBudget& b) { return compute_error(static_cast<double>(b.faces), goal); };
    std::optional<FaceBudget> sides;
    if (options.tube_sides == TubeSides::by_radius)
        sides = RadiusPlanner(plan_with_all(skeleton, options), ctx).plan(goal);
    if (sides && off(*sides) <= kFar) return std::move(*sides);
    FaceBudget rings = RingPlanner(skeleton, options, ctx).plan(goal);
    return sides && off(*sides) < off(rings) ? std::move(*sides) : std::move(rings);
}

BudgetedMesh mesh_with_faces(const Skeleton& skeleton, const PointSet& constraints,
                             const MeshOptions& options, std::uint64_t faces, const Context& ctx) {
    check_budget(options, faces);
    return BudgetSearch(skeleton, constraints, options, faces, ctx).run();
}

std::string to_text(const FaceBudget& budget) {
    const bool by_radius = budget.options.tube_sides == TubeSides::by_radius;
    return fmt::format("level {}{}, {} of {} axes, without {:.1f} % of the silhouette", budget.options.levels,
                       by_radius ? ", sides by radius" : "", grouped(budget.axes - budget.dropped),
                       grouped(budget.axes), 100 * budget.dropped_silhouette);
}

std::string text_of_missed_faces(const BudgetedMesh& made, std::uint64_t faces) {
    const std::size_t has = made.result.quads().mesh.quads.size();
    if (compute_error(static_cast<double>(has), static_cast<double>(faces)) <= kFar) return {};
    return fmt::format(
        "the surface has {} faces instead of {}: no choice of levels, rings and branches comes closer",
        grouped(has), grouped(faces));
}

void list_fields(FaceNumber& o, FieldList& list) {
    list.add(
        common_field("faces",
                     "Number of faces of the surface, within 5 %: chooses the levels, the spacing of rings "
                     "and the branches that are included; 0 sets no number.",
                     Unit::none, 0, kMaxFaces),
        o.faces);
}

}  // namespace coppice
