#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "coppice/base/check_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/base/random.h"
#include "coppice/foliage/leaf_frame_internal.h"
#include "coppice/foliage/placement.h"
#include "coppice/foliage/wood_internal.h"
#include "coppice/skeleton/segment_cone.h"
#include "coppice/spatial/planar_hull.h"

namespace coppice {
namespace {

using namespace foliage_internal;

/// The leaves of one shoot.
struct ShootResult {
    std::size_t leaves = 0;
    std::size_t inside_wood = 0;
    std::size_t floating = 0;
    double area = 0;
    double inclination = 0;   ///< sum
    std::vector<Vec3d> hull;  ///< corners seen from above
};

/// The part of a model that placement uses.
struct ModelSize {
    Vec3 tip;         ///< [m] farthest vertex
    double area = 0;  ///< [m^2]
};

std::vector<ModelSize> measure_models(std::span<const LeafModel> models) {
    std::vector<ModelSize> out;
    for (const LeafModel& model : models) {
        ModelSize size{.area = model.area};
        for (const Vec3 p : model.prototype.mesh.positions) {
            if (length_squared(p) > length_squared(size.tip)) size.tip = p;
        }
        out.push_back(size);
    }
    return out;
}

float find_longest(const std::vector<ModelSize>& models) {
    float longest = 0;
    for (const ModelSize& model : models) longest = std::max(longest, length(model.tip));
    return longest;
}

/// Returns the maximum length of a leaf.
float find_reach(const std::vector<ModelSize>& models, const LeafRules& rules) {
    return find_longest(models) * rules.size * (1 + rules.size_spread) * std::max(1.0f, rules.base_size);
}

/// Returns the radius above which leaves must not enter a segment: that of shoots, at most a twentieth of the
/// longest leaf.
float find_wood_radius(const std::vector<ModelSize>& models, float max_radius) {
    constexpr float kShare = 0.05f;
    return std::min(max_radius, kShare * find_longest(models));
}

class Placer {
  public:
    Placer(const Skeleton& skeleton, std::span<const LeafModel> models, const LeafRules& rules,
           const Context& ctx)
        : skeleton_(skeleton),
          rules_(rules),
          season_(rules),
          models_(measure_models(models)),
          table_(find_shoots(skeleton, rules)),
          wood_(skeleton, find_wood_radius(models_, table_.max_radius), ctx),
          reach_(find_reach(models_, rules)),
          results_(table_.shoots.size()) {
        resize(table_.leaf_count);
        instances_.origin = skeleton.origin();
    }

    Foliage place(const Context& ctx) {
        constexpr std::size_t kGrain = 64;
        parallel_for(ctx, table_.shoots.size(), kGrain, [&](std::size_t i) { place_shoot(i); });
        compact();
        FoliageReport report = make_report();
        return {.instances = std::move(instances_), .report = report};
    }

  private:
    static constexpr std::uint32_t kStretch = 32;  // nodes for which the wood around is found together

    void resize(std::size_t count) {
        instances_.prototypes.resize(count);
        instances_.positions.resize(count);
        instances_.rotations.resize(count);
        instances_.scales.resize(count);
        instances_.colors.resize(count);
    }

    void move_leaf(std::size_t from, std::size_t to) {
        instances_.prototypes[to] = instances_.prototypes[from];
        instances_.positions[to] = instances_.positions[from];
        instances_.rotations[to] = instances_.rotations[from];
        instances_.scales[to] = instances_.scales[from];
        instances_.colors[to] = instances_.colors[from];
    }

    /// Writes the leaves of a shoot to the beginning of its range.
    void place_shoot(std::size_t i) {
        const Shoot& shoot = table_.shoots[i];
        const StableId id = skeleton_.stable_id(table_.table.branches[shoot.branch].first);
        const std::uint64_t key = mix_bits(static_cast<std::uint64_t>(rules_.seed) << 32 | id.index());
        const LeafDraws of_shoot = draw_leaf(key, ~std::uint64_t{0});
        const std::uint32_t per_node = count_leaves_per_node(rules_);
        const std::vector<ShootPlace> places = find_places(skeleton_, table_, shoot, rules_);
        ShootResult& result = results_[i];
        std::vector<std::uint32_t> near;
        for (std::uint32_t node = 0; node < places.size(); ++node) {
            if (node % kStretch == 0) wood_.find_near(bound_stretch(places, node), near);
            for (std::uint32_t k = 0; k < per_node; ++k)
                place_leaf({places[node], node, k, near}, of_shoot, draw_leaf(key, node * per_node + k),
                           shoot.first + result.leaves, result);
        }
        result.hull = compute_planar_hull(std::move(result.hull));
    }

    /// Returns a box around all leaves of a number of nodes.
    Box3 bound_stretch(const std::vector<ShootPlace>& places, std::size_t first) const {
        Box3 box;
        float radius = 0;
        for (std::size_t i = first; i < std::min(first + kStretch, places.size()); ++i) {
            box.extend(places[i].center);
            radius = std::max(radius, places[i].radius);
        }
        return box.inflated(radius + reach_);
    }

    /// A place of one leaf.
    struct LeafPlace {
        const ShootPlace& shoot;
        std::uint32_t node;                   ///< from the tip
        std::uint32_t index;                  ///< at the node
        std::span<const std::uint32_t> near;  ///< wood
    };

    void place_leaf(const LeafPlace& leaf, const LeafDraws& of_shoot, const LeafDraws& draws, std::size_t at,
                    ShootResult& result) {
        const ShootPlace& place = leaf.shoot;
        const SeasonState season = season_.find(place.from_tip);
        if (draws.uniform[0] >= rules_.density * season.density) return;
        constexpr float kTurn = 6.2831853f;
        const LeafFrame frame = make_frame(place, rules_, leaf.node, leaf.index, kTurn * of_shoot.uniform[0],
                                           season.angle, draws);
        const Quaternion rotation = make_rotation(frame);
        const float scale = rules_.size * season.size *
                            (1 + rules_.size_spread * (2 * draws.uniform[1] - 1)) *
                            (1 + (rules_.base_size - 1) * place.from_tip);
        const auto model = static_cast<std::uint32_t>(draws.bits % models_.size());
        const Vec3 tip = rotate(rotation, scale * models_[model].tip);
        const Vec3 base = frame.attachment;
        const LeafPoints points{.attachment = base,
                                .node = place.node,
                                .depth = 0.5f * place.radius,
                                .midrib = {base + 0.35f * tip, base + 0.7f * tip, base + tip}};
        if (wood_.contains(points, leaf.near)) {
            ++result.inside_wood;
            return;
        }
        instances_.prototypes[at] = model;
        instances_.positions[at] = frame.attachment;
        instances_.rotations[at] = rotation;
        instances_.scales[at] = scale;
        instances_.colors[at] =
            make_color(season, rules_, 0.5f * (of_shoot.uniform[1] + draws.uniform[2]), draws.uniform[3]);
        ++result.leaves;
        result.floating += floats(place, frame.attachment) ? 1 : 0;
        result.area += double{scale} * double{scale} * models_[model].area;
        result.inclination += std::acos(std::clamp(double{frame.up.z}, -1.0, 1.0));
        for (const Vec3 p : {frame.attachment, frame.attachment + tip}) result.hull.emplace_back(p);
    }

    /// Returns whether a place is farther from the bark of its segment than by rounding.
    bool floats(const ShootPlace& place, Vec3 attachment) const {
        constexpr double kTolerance = 1e-4, kRounding = 1e-6;  // [m], and per metre from the origin
        const double tolerance = kTolerance + kRounding * double{length(attachment)};
        const RoundCone cone = round_cone(skeleton_.segment(place.node));
        return cone.closest_point(Vec3d(attachment)).signed_distance() > tolerance;
    }

    void compact() {
        std::size_t end = 0;
        for (std::size_t i = 0; i < results_.size(); ++i) {
            for (std::size_t k = 0; k < results_[i].leaves; ++k) move_leaf(table_.shoots[i].first + k, end++);
        }
        resize(end);
    }

    FoliageReport make_report() {
        FoliageReport out{.shoots = table_.shoots.size(), .thick_tips = table_.thick_tips};
        std::vector<std::vector<Vec3d>> crowns(skeleton_.tree_count());
        for (std::size_t i = 0; i < results_.size(); ++i) {
            const ShootResult& r = results_[i];
            out.leaves += r.leaves;
            out.inside_wood += r.inside_wood;
            out.floating += r.floating;
            out.leaf_area += r.area;
            out.mean_inclination += r.inclination;
            std::vector<Vec3d>& crown = crowns[table_.table.branches[table_.shoots[i].branch].tree];
            crown.insert(crown.end(), r.hull.begin(), r.hull.end());
        }
        for (std::vector<Vec3d>& crown : crowns)
            out.crown_area += compute_planar_area(compute_planar_hull(std::move(crown)));
        if (out.crown_area > 0) out.leaf_area_index = out.leaf_area / out.crown_area;
        if (out.leaves > 0) out.mean_inclination /= static_cast<double>(out.leaves);
        return out;
    }

    const Skeleton& skeleton_;
    const LeafRules& rules_;
    SeasonEffects season_;
    std::vector<ModelSize> models_;
    ShootTable table_;
    Wood wood_;
    float reach_;
    std::vector<ShootResult> results_;
    Instances instances_;
};

}  // namespace

float foliage_internal::find_density(const Skeleton& skeleton, std::span<const LeafModel> models,
                                     const LeafRules& rules, const Context& ctx) {
    if (rules.max_index <= 0) return rules.density;
    constexpr int kMaxSteps = 8;
    constexpr double kTolerance = 0.02;
    LeafRules summer = rules;
    summer.season = Season::summer;
    double low = 0, high = 0;  // densities with indices below and above the maximum
    for (int step = 0; step < kMaxSteps; ++step) {
        const double density = double{summer.density};
        const FoliageReport report = Placer(skeleton, models, summer, ctx).place(ctx).report;
        const double excess = report.leaf_area_index / double{rules.max_index};
        if (step == 0 && excess <= 1 + kTolerance) break;
        if (std::abs(excess - 1) <= kTolerance) break;
        (excess > 1 ? high : low) = density;
        summer.density = static_cast<float>(low > 0 ? std::sqrt(low * high) : density / excess);
    }
    return summer.density;
}

Foliage place_leaves(const Skeleton& skeleton, std::span<const LeafModel> models, const LeafRules& rules,
                     const Context& ctx) {
    check_fields(rules, "leaves");
    if (models.empty()) throw InvalidInput("leaves: there is no model of a leaf; add at least one");
    if (skeleton.size() == 0) return {};
    LeafRules thinned = rules;
    thinned.density = find_density(skeleton, models, rules, ctx);
    return Placer(skeleton, models, thinned, ctx).place(ctx);
}

}  // namespace coppice
