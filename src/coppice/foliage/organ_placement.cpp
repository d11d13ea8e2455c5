#include "coppice/foliage/organ_placement_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/base/random.h"
#include "coppice/base/srgb.h"
#include "coppice/foliage/leaf_frame_internal.h"
#include "coppice/foliage/wood_internal.h"

namespace coppice::foliage_internal {
namespace {

using Color = std::array<std::uint8_t, 3>;

constexpr double kMaxClusters = 20e6;

/// The parts of all variants of an organ, and the places of their prototypes in the tree.
struct OrganModels {
    std::vector<std::vector<OrganPart>> variants;
    std::vector<std::size_t> first;  ///< prototype of the first part of each variant
    float reach = 0;                 ///< [m] distance of the farthest point from the attachment
};

OrganModels make_models(const Organ& organ, int count, TreeFoliage& tree) {
    OrganModels out;
    const std::uint32_t material = organ.is_fruit ? kFruitMaterial : kFlowerMaterial;
    for (int i = 0; i < count; ++i) {
        out.variants.push_back(make_organ(organ.shape, material, i));
        out.first.push_back(tree.prototypes.size());
        for (std::size_t k = 0; k < out.variants.back().size(); ++k) {
            OrganPart& part = out.variants.back()[k];
            for (const Vec3 p : part.prototype.mesh.positions) out.reach = std::max(out.reach, length(p));
            part.prototype.name = fmt::format("{}_{}_{}", organ.name, i + 1, k + 1);
            tree.prototypes.push_back(std::move(part.prototype));
        }
    }
    return out;
}

/// Returns the rules by which clusters are placed on the models of branches, in their frame.
LeafRules make_rules(const Organ& organ, const LeafRules& leaves, const OrganBranches& branches) {
    LeafRules out = leaves;
    out.season = Season::summer;
    out.max_radius = branches.max_radius;
    out.min_order = branches.min_order;
    out.shoot_length = organ.shoot_length;
    out.internode = organ.internode;
    out.clustering = 0;
    out.angle = organ.angle;
    out.light = out.droop = 0;
    out.spread = organ.spread;
    out.size = out.base_size = out.density = 1;
    out.size_spread = organ.size_spread;
    // Pairs of leaves have one cluster.
    if (out.arrangement == LeafArrangement::opposite) out.arrangement = LeafArrangement::spiral;
    return out;
}

/// Returns the direction turned down by the share, or up if it is negative.
Vec3 turn(Vec3 along, float hang) {
    const Vec3 goal{0, 0, hang > 0 ? -1.0f : 1.0f};
    return normalized(lerp(along, goal, std::abs(hang)), goal);
}

std::uint64_t make_key(int seed, Vec3 place, std::uint64_t organ) {
    std::uint64_t key = mix_bits(static_cast<std::uint64_t>(seed) ^ organ);
    for (const float x : {place.x, place.y, place.z}) key = mix_bits(key ^ std::bit_cast<std::uint32_t>(x));
    return key;
}

/// A placed cluster.
struct Cluster {
    Vec3 position;
    Quaternion rotation;
    float scale = 1;
    std::uint32_t variant = 0;
    float hue = 0;    ///< between the two colours
    float light = 1;  ///< factor of the brightness
};

/// The clusters of one copy of a branch.
struct CopyResult {
    std::vector<Cluster> clusters;
    std::size_t inside_wood = 0;
};

Color mix_color(const OrganPart& part, const Cluster& cluster) {
    return to_bytes(lerp(part.color, part.other_color, double{cluster.hue}) * double{cluster.light});
}

class OrganPlacer {
  public:
    OrganPlacer(const OrganBranches& branches, const Organ& organ, std::uint64_t number, float share,
                int seed, OrganModels models, const Context& ctx)
        : branches_(branches),
          organ_(organ),
          share_(share),
          key_seed_(seed),
          number_(number),
          models_(std::move(models)),
          wood_(branches.tree, find_wood_radius(branches, organ), ctx) {
        low_ = high_ = branches.tree.size() > 0 ? branches.tree.positions()[0].z : 0;
        for (const Vec3 p : branches.tree.positions()) {
            low_ = std::min(low_, p.z);
            high_ = std::max(high_, p.z);
        }
    }

    void place(TreeFoliage& tree, const LeafRules& leaves, const Context& ctx) {
        find_places(tree, leaves, ctx);
        std::vector<CopyResult> results(branches_.copies.size());
        constexpr std::size_t kGrain = 64;
        parallel_for(ctx, results.size(), kGrain, [&](std::size_t i) { place_copy(i, results[i]); });
        FoliageReport& report = tree.foliage.report;
        std::uint64_t clusters = 0;
        for (const CopyResult& result : results) {
            report.inside_wood += result.inside_wood;
            clusters += result.clusters.size();
            for (const Cluster& cluster : result.clusters) append(tree.foliage.instances, cluster);
        }
        (organ_.is_fruit ? report.fruit : report.flowers) +=
            clusters * static_cast<std::uint64_t>(organ_.shape.count);
    }

  private:
    static float find_wood_radius(const OrganBranches& branches, const Organ& organ) {
        // Shoots that bear the clusters are no wood.
        const float size = organ.shape.axis_length + organ.shape.stalk_length + organ.shape.length;
        return std::min(branches.max_radius, std::max(0.003f, 0.1f * size));
    }

    void find_places(TreeFoliage& tree, const LeafRules& leaves, const Context& ctx) {
        LeafModel card{.prototype = tree.prototypes[models_.first[0]], .area = 0};
        const LeafRules rules = make_rules(organ_, leaves, branches_);
        double count = 0;
        std::vector<double> floating;
        for (const Skeleton& model : branches_.models) {
            Foliage places = place_leaves(model, {&card, 1}, rules, ctx);
            floating.push_back(static_cast<double>(places.report.floating));
            places_.push_back(std::move(places.instances));
        }
        for (const std::uint32_t model : branches_.copies.prototypes) {
            count += static_cast<double>(places_[model].size());
            tree.foliage.report.floating += static_cast<std::uint64_t>(floating[model]);
        }
        if (count * double{share_} > kMaxClusters)
            throw InvalidInput(
                fmt::format("leaves: there are more than {:.0f} million clusters of flowers or fruit; reduce "
                            "flower_density or fruit_density",
                            kMaxClusters / 1e6));
    }

    void place_copy(std::size_t copy, CopyResult& result) const {
        const Instances& copies = branches_.copies;
        const Instances& places = places_[copies.prototypes[copy]];
        const float lowest = low_ + organ_.min_height * (high_ - low_);
        std::vector<std::uint32_t> near;
        for (std::size_t k = 0; k < places.size(); ++k) {
            const Vec3 at = copies.place(copy, places.positions[k]);
            const CounterRandom random(make_key(key_seed_, at, number_), 0);
            if (at.z < lowest || random.uniform(0) >= double{share_}) continue;
            const Vec3 grown = rotate(copies.rotations[copy], rotate(places.rotations[k], {0, 1, 0}));
            const Vec3 along = turn(grown, organ_.hang),
                       up = rotate(copies.rotations[copy], rotate(places.rotations[k], {0, 0, 1}));
            const float scale = places.scales[k];
            if (is_in_wood(at, along, scale, near)) {
                ++result.inside_wood;
                continue;
            }
            const Vec3 across = normalized(up - along * dot(up, along), perpendicular(along));
            result.clusters.push_back(
                {.position = at,
                 .rotation = make_rotation({.attachment = at, .along = along, .up = across}),
                 .scale = scale,
                 .variant = static_cast<std::uint32_t>(random.bits(1) % models_.variants.size()),
                 .hue = static_cast<float>(random.uniform(2)),
                 .light = static_cast<float>(random.uniform(3, 0.9, 1.0))});
        }
    }

    /// Returns whether a cluster begins in the wood of another branch, or its middle or end is in wood.
    bool is_in_wood(Vec3 at, Vec3 along, float scale, std::vector<std::uint32_t>& near) const {
        constexpr float kAccepted = 0.001f;  // [m] depth of an attachment
        const float reach = models_.reach * scale, clearance = 0.4f * organ_.shape.width * scale;
        Box3 box;
        box.extend(at);
        wood_.find_near(box.inflated(reach), near);
        const float whole =
            (organ_.shape.axis_length + organ_.shape.stalk_length + organ_.shape.length) * scale;
        const float middle = whole - 0.5f * organ_.shape.length * scale;
        const LeafPoints points{
            .attachment = at,
            .node = NodeId(),
            .depth = kAccepted,
            .midrib = {at + along * middle, at + along * (0.5f * (middle + whole)), at + along * whole},
            .clearance = clearance};
        return wood_.contains(points, near);
    }

    void append(Instances& to, const Cluster& cluster) const {
        const std::vector<OrganPart>& parts = models_.variants[cluster.variant];
        for (std::size_t k = 0; k < parts.size(); ++k) {
            to.prototypes.push_back(static_cast<std::uint32_t>(models_.first[cluster.variant] + k));
            to.positions.push_back(cluster.position);
            to.rotations.push_back(cluster.rotation);
            to.scales.push_back(cluster.scale);
            to.colors.push_back(mix_color(parts[k], cluster));
        }
    }

    const OrganBranches& branches_;
    const Organ& organ_;
    float share_;
    int key_seed_;
    std::uint64_t number_;
    OrganModels models_;
    Wood wood_;
    float low_ = 0, high_ = 0;
    std::vector<Instances> places_;  ///< of each model of a branch
};

}  // namespace

void add_organs(TreeFoliage& tree, const OrganBranches& branches, std::span<const Organ> organs,
                const OrganOptions& options, const LeafRules& rules, int models, const Context& ctx) {
    if (branches.copies.empty() || branches.tree.size() == 0) return;
    for (std::size_t i = 0; i < organs.size(); ++i) {
        const Organ& organ = organs[i];
        const float factor = organ.is_fruit ? options.fruit_density : options.flower_density;
        const float share = std::min(1.0f, factor * organ.shares[static_cast<std::size_t>(rules.season)]);
        if (share <= 0) continue;
        OrganModels made = make_models(organ, models, tree);
        OrganPlacer(branches, organ, i + 1, share, rules.seed, std::move(made), ctx).place(tree, rules, ctx);
    }
}

}  // namespace coppice::foliage_internal
