#include "coppice/foliage/tree_foliage.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "coppice/base/check_fields.h"
#include "coppice/base/random.h"
#include "coppice/foliage/leaf_frame_internal.h"
#include "coppice/foliage/organ_placement_internal.h"

namespace coppice {
namespace {

using Color = std::array<std::uint8_t, 3>;

/// Returns the rules by which branchlets are placed.
LeafRules make_branch_rules(const LeafRules& rules, const BranchletOptions& o) {
    LeafRules out = rules;
    out.season = Season::summer;
    out.internode = o.spacing;
    out.clustering = 0;
    out.angle = o.angle;
    out.light = o.light;
    out.droop = o.droop;
    out.spread = o.spread;
    out.size_spread = 0.25f;
    out.base_size = 1;
    out.density = 1;
    return out;
}

/// Returns the colour of the leaves of a branchlet by its place, so that it does not depend on others.
Color find_color(const foliage_internal::SeasonEffects& effects, const LeafRules& rules, Vec3 place) {
    std::uint64_t key = static_cast<std::uint64_t>(rules.seed);
    for (const float x : {place.x, place.y, place.z}) key = mix_bits(key ^ std::bit_cast<std::uint32_t>(x));
    const CounterRandom random(key, 0);
    return make_color(effects.find(0), rules, static_cast<float>(random.uniform(0)),
                      static_cast<float>(random.uniform(1)));
}

void append_copy(Instances& to, const Instances& from, std::size_t copy, std::size_t prototype, Color color) {
    to.prototypes.push_back(static_cast<std::uint32_t>(prototype));
    to.positions.push_back(from.positions[copy]);
    to.rotations.push_back(from.rotations[copy]);
    to.scales.push_back(from.scales[copy]);
    to.colors.push_back(color);
}

/// Replaces the figures of branchlets by those of their leaves.
void count_leaves(FoliageReport& report, std::span<const Branchlet> models, const Instances& copies) {
    report.leaves = 0;
    double inclination = 0;
    for (std::size_t i = 0; i < copies.size(); ++i) {
        const Branchlet& model = models[copies.prototypes[i]];
        report.leaves += model.upper_sides.size();
        for (const Vec3 up : model.upper_sides)
            inclination += std::acos(std::clamp(double{rotate(copies.rotations[i], up).z}, -1.0, 1.0));
    }
    report.mean_inclination = report.leaves > 0 ? inclination / static_cast<double>(report.leaves) : 0;
}

/// Adds the leaves, then the twigs of all branchlets.
TreeFoliage assemble(std::vector<Branchlet> models, const Foliage& placed, const LeafRules& rules) {
    constexpr Color kWhite{255, 255, 255};
    TreeFoliage out{.branchlets = placed.instances.size()};
    out.foliage.report = placed.report;
    count_leaves(out.foliage.report, models, placed.instances);
    const foliage_internal::SeasonEffects effects(rules);
    const Instances& copies = placed.instances;
    Instances& instances = out.foliage.instances;
    instances.origin = copies.origin;
    std::vector<std::size_t> leaves(models.size());
    for (std::size_t i = 0; i < models.size(); ++i) {
        leaves[i] = out.prototypes.size();
        if (models[i].upper_sides.empty()) continue;
        models[i].leaves.name = fmt::format("leaves_{}", i + 1);
        out.prototypes.push_back(std::move(models[i].leaves));
        out.prototypes.back().material = kLeafMaterial;
    }
    const std::size_t twigs = out.prototypes.size();
    for (std::size_t i = 0; i < models.size(); ++i) {
        out.prototypes.push_back(std::move(models[i].twig.prototype));
        out.prototypes.back().name = fmt::format("twig_{}", i + 1);
        out.prototypes.back().material = kTwigMaterial;
    }
    for (std::size_t i = 0; i < copies.size(); ++i) {
        const std::size_t model = copies.prototypes[i];
        if (!models[model].upper_sides.empty())
            append_copy(instances, copies, i, leaves[model], find_color(effects, rules, copies.positions[i]));
        append_copy(instances, copies, i, twigs + model, kWhite);
    }
    return out;
}

std::vector<LeafModel> list_twigs(std::span<const Branchlet> branchlets) {
    std::vector<LeafModel> out;
    for (const Branchlet& branchlet : branchlets) out.push_back(branchlet.twig);
    return out;
}

TreeFoliage place_branchlets(const Skeleton& skeleton, std::span<const LeafModel> leaves,
                             const LeafRules& rules, const BranchletOptions& options, int models,
                             const FoliageOrgans& organs, const Context& ctx) {
    std::vector<Branchlet> branchlets = make_branchlets(options, leaves, rules, models, ctx);
    const std::vector<LeafModel> twigs = list_twigs(branchlets);
    std::vector<Skeleton> axes;
    for (Branchlet& branchlet : branchlets) axes.push_back(std::move(branchlet.axes));
    LeafRules branch_rules = make_branch_rules(rules, options);
    if (rules.max_index > 0) {
        // The same branchlets grow in all seasons.
        LeafRules summer = rules;
        summer.season = Season::summer;
        const auto leafy = make_branchlets(options, leaves, summer, models, ctx);
        branch_rules.density = foliage_internal::find_density(skeleton, list_twigs(leafy), branch_rules, ctx);
        branch_rules.max_index = 0;
    }
    const Foliage placed = place_leaves(skeleton, twigs, branch_rules, ctx);
    TreeFoliage out = assemble(std::move(branchlets), placed, rules);
    const foliage_internal::OrganBranches branches{
        .tree = skeleton, .models = axes, .copies = placed.instances};
    add_organs(out, branches, organs.organs, organs.options, rules, models, ctx);
    return out;
}

/// Returns one copy of a model at its own place.
Instances make_one_copy(const Skeleton& skeleton) {
    return {.prototypes = {0},
            .positions = {Vec3{}},
            .rotations = {Quaternion{}},
            .scales = {1},
            .colors = {Color{255, 255, 255}},
            .origin = skeleton.origin()};
}

}  // namespace

TreeFoliage make_foliage(const Skeleton& skeleton, const LeafShape& shape, const LeafRules& rules,
                         const BranchletOptions& branchlets, int models, const FoliageOrgans& organs,
                         const Context& ctx) {
    check_fields(organs.options, "leaves");
    const std::vector<LeafModel> leaves = make_leaves(shape, models);
    if (branchlets.length > 0)
        return place_branchlets(skeleton, leaves, rules, branchlets, models, organs, ctx);
    TreeFoliage out{.foliage = place_leaves(skeleton, leaves, rules, ctx)};
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        out.prototypes.push_back(leaves[i].prototype);
        out.prototypes.back().name = fmt::format("leaf_{}", i + 1);
        out.prototypes.back().material = kLeafMaterial;
    }
    const Instances copy = make_one_copy(skeleton);
    const foliage_internal::OrganBranches branches{.tree = skeleton,
                                                   .models = {&skeleton, 1},
                                                   .copies = copy,
                                                   .max_radius = rules.max_radius,
                                                   .min_order = rules.min_order};
    add_organs(out, branches, organs.organs, organs.options, rules, models, ctx);
    return out;
}

}  // namespace coppice
