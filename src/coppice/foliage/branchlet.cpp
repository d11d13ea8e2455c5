#include "coppice/foliage/branchlet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/frame.h"
#include "coppice/base/random.h"
#include "coppice/skeleton/branches.h"

namespace coppice {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr std::uint64_t kStream = 0xb7a2c;  // of random numbers

/// Makes the axes of a branchlet.
class AxisBuilder {
  public:
    AxisBuilder(const BranchletOptions& o, const LeafRules& rules, int variant)
        : o_(o),
          rules_(rules),
          random_(static_cast<std::uint64_t>(rules.seed), kStream + static_cast<std::uint64_t>(variant)) {}

    Skeleton build() {
        add_main_axis();
        for (int k = 0; k < o_.laterals; ++k) add_lateral(k);
        return Skeleton(std::move(parents_), std::move(positions_), std::move(radii_));
    }

  private:
    static constexpr float kTipShare = 0.35f;              // of the radius at the base
    static constexpr float kFirst = 0.15f, kLast = 0.92f;  // shares of the main axis with laterals
    static constexpr int kLateralSegments = 4;

    float draw(float low, float high) {
        return static_cast<float>(random_.uniform(next_++, double{low}, double{high}));
    }

    void add(std::uint32_t parent, Vec3 p, float radius) {
        parents_.push_back(parent == kNoIndex ? NodeId() : NodeId(parent));
        positions_.push_back(p);
        radii_.push_back(radius);
    }

    /// Returns the direction of the main axis at a share of its length.
    Vec3 find_direction(float f) const {
        const float down = o_.sag * (f - 0.3f);
        const float side = bend_ * f;
        return normalized(Vec3{std::sin(side), std::cos(down) * std::cos(side), -std::sin(down)});
    }

    void add_main_axis() {
        constexpr int kMinSegments = 6;
        bend_ = draw(-0.3f, 0.3f);
        count_ = std::max(kMinSegments, o_.laterals + 2);
        const float step = o_.length / static_cast<float>(count_);
        Vec3 p;
        add(kNoIndex, p, o_.radius);
        for (int i = 1; i <= count_; ++i) {
            const float f = static_cast<float>(i) / static_cast<float>(count_);
            p = p + find_direction(f) * step;
            add(static_cast<std::uint32_t>(i - 1), p, o_.radius * (1 + (kTipShare - 1) * f));
        }
    }

    float find_azimuth(int k) {
        switch (rules_.arrangement) {
            case LeafArrangement::two_ranked:
                return kPi * static_cast<float>(k % 2);
            case LeafArrangement::opposite:
                return kPi * static_cast<float>(k % 2) + kPi / 2 * static_cast<float>(k / 2 % 2);
            case LeafArrangement::spiral:
            case LeafArrangement::whorled:
                break;
        }
        return 2.3998f * static_cast<float>(k);
    }

    void add_lateral(int k) {
        const bool pairs = rules_.arrangement == LeafArrangement::opposite;
        const int place = pairs ? k / 2 : k, places = pairs ? (o_.laterals + 1) / 2 : o_.laterals;
        const float f =
            kFirst + (kLast - kFirst) * (static_cast<float>(place) + 0.5f) / static_cast<float>(places);
        const auto from = static_cast<std::uint32_t>(std::lround(f * static_cast<float>(count_)));
        const float length = o_.length * o_.lateral_length * (1 - 0.65f * f) * draw(0.7f, 1.2f);
        if (length < 1e-4f * o_.length) return;
        const Vec3 axis = find_direction(f);
        const float azimuth = find_azimuth(k) + draw(-0.35f, 0.35f);
        const Vec3 right = normalized(cross(axis, Vec3{0, 0, 1}), Vec3{1, 0, 0});
        const Vec3 up = cross(right, axis);
        const Vec3 radial = right * std::cos(azimuth) + up * (std::sin(azimuth) * (1 - o_.flatness));
        const Vec3 across = normalized(radial, right);
        const float angle = o_.lateral_angle * draw(0.8f, 1.2f);
        Vec3 p = positions_[from];
        std::uint32_t parent = from;
        const float radius = 0.7f * radii_[from];
        for (int i = 1; i <= kLateralSegments; ++i) {
            const float along = static_cast<float>(i) / kLateralSegments;
            const float opened = angle * (1.1f - 0.3f * along);
            const Vec3 way = normalized(axis * std::cos(opened) + across * std::sin(opened) -
                                        Vec3{0, 0, 0.5f * o_.sag * along});
            p = p + way * (length / kLateralSegments);
            add(parent, p, std::max(radius * (1 + (kTipShare - 1) * along), kTipShare * o_.radius));
            parent = static_cast<std::uint32_t>(positions_.size() - 1);
        }
    }

    const BranchletOptions& o_;
    const LeafRules& rules_;
    CounterRandom random_;
    std::uint64_t next_ = 0;
    int count_ = 0;
    float bend_ = 0;
    std::vector<NodeId> parents_;
    std::vector<Vec3> positions_;
    std::vector<float> radii_;
};

/// Makes closed tubes with three sides.
class TubeBuilder {
  public:
    void add_axis(const Skeleton& s, const std::vector<NodeId>& axis, bool is_lateral) {
        const auto base = static_cast<std::uint32_t>(mesh_.positions.size());
        const Vec3 end = s.position(axis.back());
        Vec3 across = perpendicular(normalized(s.position(axis[1]) - s.position(axis[0])));
        for (std::size_t i = 0; i + 1 < axis.size(); ++i) {
            const Vec3 direction = normalized(s.position(axis[i + 1]) - s.position(axis[i]));
            across = normalized(across - direction * dot(across, direction), perpendicular(direction));
            // A lateral begins with its own radius at the node of its parent axis.
            const float radius = i == 0 && is_lateral ? s.radius(axis[1]) : s.radius(axis[i]);
            add_ring(s.position(axis[i]), across, cross(direction, across), radius);
        }
        const auto rings = static_cast<std::uint32_t>(axis.size() - 1);
        for (std::uint32_t i = 0; i + 1 < rings; ++i) {
            for (std::uint32_t k = 0; k < kSides; ++k) {
                const std::uint32_t a = base + i * kSides + k, b = base + i * kSides + (k + 1) % kSides;
                add_triangle({a, b, b + kSides});
                add_triangle({a, b + kSides, a + kSides});
            }
        }
        add_triangle({base + 2, base + 1, base});
        const std::uint32_t last = base + (rings - 1) * kSides, tip = last + kSides;
        mesh_.positions.push_back(end);
        for (std::uint32_t k = 0; k < kSides; ++k) add_triangle({last + k, last + (k + 1) % kSides, tip});
    }

    Prototype take() { return {.name = "twig", .mesh = std::move(mesh_), .texture = std::move(texture_)}; }

  private:
    static constexpr std::uint32_t kSides = 3;

    void add_ring(Vec3 center, Vec3 across, Vec3 up, float radius) {
        for (std::uint32_t k = 0; k < kSides; ++k) {
            const float angle = 2 * kPi * static_cast<float>(k) / kSides;
            mesh_.positions.push_back(center + (across * std::cos(angle) + up * std::sin(angle)) * radius);
        }
    }
    void add_triangle(Triangle t) {
        mesh_.triangles.push_back(t);
        for (const TexturePoint p : {TexturePoint{0, 0}, TexturePoint{1, 0}, TexturePoint{1, 1}})
            texture_.push_back(p);
    }

    TriMesh mesh_;
    std::vector<TexturePoint> texture_;
};

Prototype make_twig(const Skeleton& s) {
    const BranchTable table = list_branches(s);
    TubeBuilder builder;
    for (const Branch& branch : table.branches) {
        std::vector<NodeId> axis;
        const bool is_lateral = !s.is_root(branch.first);
        if (is_lateral) axis.push_back(s.parent(branch.first));
        for (NodeId n = branch.first; n; n = table.next_of[n.index()]) axis.push_back(n);
        if (axis.size() > 1) builder.add_axis(s, axis, is_lateral);
    }
    return builder.take();
}

/// Returns the rules of leaves on a branchlet, all of which bear leaves.
LeafRules make_leaf_rules(const LeafRules& rules, const BranchletOptions& o) {
    LeafRules out = rules;
    out.max_radius = 1;
    out.min_order = 0;
    out.shoot_length = std::clamp(o.length, 1e-3f, 100.0f);
    out.size = 1;
    return out;
}

}  // namespace

std::vector<Branchlet> make_branchlets(const BranchletOptions& options, std::span<const LeafModel> models,
                                       const LeafRules& rules, int count, const Context& ctx) {
    check_fields(options, "branchlet");
    check_fields(rules, "leaves");
    if (options.length <= 0) throw InvalidInput("branchlet: the length is 0; use a length in metres");
    std::vector<Prototype> prototypes;
    for (const LeafModel& model : models) prototypes.push_back(model.prototype);
    std::vector<Branchlet> out;
    for (int i = 0; i < count; ++i) {
        Skeleton axes = AxisBuilder(options, rules, i).build();
        const Foliage leaves = place_leaves(axes, models, make_leaf_rules(rules, options), ctx);
        Branchlet made{.twig = {.prototype = make_twig(axes), .area = leaves.report.leaf_area}};
        MergedInstances merged = merge_instances(prototypes, leaves.instances, ctx);
        made.leaves.name = "leaves";
        made.leaves.texture.assign(merged.texture.begin(), merged.texture.end());
        made.leaves.mesh = std::move(merged.mesh);
        for (const Quaternion r : leaves.instances.rotations)
            made.upper_sides.push_back(rotate(r, {0, 0, 1}));
        made.axes = std::move(axes);
        out.push_back(std::move(made));
    }
    return out;
}

void list_fields(BranchletOptions& o, FieldList& list) {
    list.add(common_field(
                 "length",
                 "Length of branchlets, twigs with leaves that are added to branches; 0 attaches leaves to "
                 "the branches.",
                 Unit::metre, 0, 20),
             o.length);
    list.add(Field{"laterals", "Number of side twigs of a branchlet.", Unit::none, 0, 100}, o.laterals);
    list.add(Field{"lateral_length", "Length of the longest side twig per length of a branchlet.", Unit::none,
                   0, 2},
             o.lateral_length);
    list.add(Field{"lateral_angle", "Angle between the side twigs and the axis of a branchlet.", Unit::radian,
                   0, 1.6},
             o.lateral_angle);
    list.add(
        Field{"flatness", "Share by which side twigs turn into the level of a branchlet.", Unit::none, 0, 1},
        o.flatness);
    list.add(Field{"sag", "Angle by which a branchlet bends down towards its tip.", Unit::radian, -2, 2},
             o.sag);
    list.add(Field{"radius", "Radius of a branchlet at its base.", Unit::metre, 1e-4, 0.1}, o.radius);
    list.add(Field{"spacing", "Distance of branchlets along a branch.", Unit::metre, 1e-3, 10}, o.spacing);
    list.add(Field{"angle", "Angle between branchlets and the branch.", Unit::radian, 0, 3.1416}, o.angle);
    list.add(Field{"light", "Share by which branchlets turn level.", Unit::none, 0, 1}, o.light);
    list.add(Field{"droop", "Angle by which branchlets hang down.", Unit::radian, -1.6, 1.6}, o.droop);
    list.add(Field{"spread", "Standard deviation of all angles of branchlets.", Unit::radian, 0, 1.6},
             o.spread);
    list.add(Field{"color", "Colour of the twigs of branchlets in sRGB from 0 to 1; by default brown."},
             o.color);
}

}  // namespace coppice
