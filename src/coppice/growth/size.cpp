#include "coppice/growth/size.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"

namespace coppice {
namespace {

/// Returns the nodes from the first root along leaders to the tip.
std::vector<NodeId> find_stem(const Skeleton& s, NodeId root) {
    std::vector<NodeId> out;
    for (NodeId n = root; n; n = s.leader(n)) out.push_back(n);
    return out;
}

/// [m] Returns the height above the root at which the diameter of a stem is measured.
float find_breast_height(float height) {
    constexpr float kBreastHeight = 1.3f, kMaxShare = 0.25f;
    return std::min(kBreastHeight, kMaxShare * height);
}

float find_top(const Skeleton& s) {
    float top = s.position(NodeId(0)).z;
    for (const Vec3 p : s.positions()) top = std::max(top, p.z);
    return top - s.position(NodeId(0)).z;
}

float find_height(const Skeleton& s) {
    const float height = find_top(s);
    if (height <= 0)
        throw InvalidInput("size: the tree does not rise above its root; grow it upwards, or longer");
    return height;
}

/// Factors of the radius along a stem.
class StemForm {
  public:
    StemForm(const SizeOptions& o, float ground) : o_(o), ground_(ground) {}

    float compute_factor(float z) const {
        const float above = std::max(0.0f, z - ground_);
        const float taper = 1 + o_.taper * std::max(0.0f, 1 - above / o_.height);
        return taper * (1 + o_.flare * std::exp(-above / o_.flare_height));
    }

  private:
    const SizeOptions& o_;
    float ground_;
};

/// Returns the radius of a stem at a height above its root.
float find_radius_at(std::span<const Vec3> positions, std::span<const float> radii,
                     const std::vector<NodeId>& stem, float height) {
    const float z = positions[stem.front().index()].z + height;
    for (std::size_t i = 1; i < stem.size(); ++i) {
        const float above = positions[stem[i].index()].z, below = positions[stem[i - 1].index()].z;
        if (above < z) continue;
        const float f = above > below ? std::clamp((z - below) / (above - below), 0.0f, 1.0f) : 0.0f;
        return std::lerp(radii[stem[i - 1].index()], radii[stem[i].index()], f);
    }
    return radii[stem.back().index()];
}

/// Returns the radius of the thickest stem at breast height.
float find_thickest(const Skeleton& s, std::span<const Vec3> positions, std::span<const float> radii,
                    float breast) {
    float thickest = 0;
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n))
            thickest = std::max(thickest, find_radius_at(positions, radii, find_stem(s, n), breast));
    }
    return thickest;
}

/// Replaces radii by powers of them such that the minimum is `tip` and that of the stem is `stem`.
void change_radii(std::span<float> radii, float given_stem, float tip, float stem) {
    const float low = std::ranges::min(radii);
    if (given_stem <= low * 1.0001f) {
        for (float& r : radii) r *= stem / given_stem;
        return;
    }
    const float power = std::log(stem / tip) / std::log(given_stem / low);
    for (float& r : radii) r = tip * std::pow(r / low, power);
}

}  // namespace

TreeSize measure_size(const Skeleton& skeleton) {
    if (skeleton.size() == 0) return {};
    const float height = find_top(skeleton);
    Box3 box;
    for (const Vec3 p : skeleton.positions()) box.extend(p);
    const float radius =
        find_thickest(skeleton, skeleton.positions(), skeleton.radii(), find_breast_height(height));
    return {
        .height = height, .dbh = 2.0 * double{radius}, .width = 0.5 * double{box.size().x + box.size().y}};
}

Skeleton with_size(const Skeleton& skeleton, const SizeOptions& options) {
    check_fields(options, "size");
    if (skeleton.size() == 0) return skeleton;
    const float scale = options.height / find_height(skeleton);
    const Vec3 root = skeleton.position(NodeId(0));
    std::vector<Vec3> positions(skeleton.positions().begin(), skeleton.positions().end());
    std::vector<float> radii(skeleton.radii().begin(), skeleton.radii().end());
    for (Vec3& p : positions) p = root + (p - root) * scale;
    const float breast = find_breast_height(options.height);
    if (options.dbh > 0) {
        const float stem = 0.5f * options.dbh / StemForm(options, root.z).compute_factor(root.z + breast);
        if (stem <= options.tip_radius)
            throw InvalidInput(fmt::format(
                "size: a diameter of {} m is not greater than that of tips, {} m; reduce tip_radius",
                options.dbh, 2 * options.tip_radius));
        const float given = find_thickest(skeleton, positions, radii, breast);
        change_radii(radii, given, options.tip_radius, stem);
    } else {
        for (float& r : radii) r *= scale;
    }
    for (const NodeId n : nodes(skeleton)) {
        if (!skeleton.is_root(n)) continue;
        const StemForm form(options, positions[n.index()].z);
        for (const NodeId m : find_stem(skeleton, n))
            radii[m.index()] *= form.compute_factor(positions[m.index()].z);
    }
    return Skeleton({skeleton.parents().begin(), skeleton.parents().end()}, std::move(positions),
                    std::move(radii), skeleton.origin(),
                    {skeleton.stable_ids().begin(), skeleton.stable_ids().end()});
}

void list_fields(SizeOptions& o, FieldList& list) {
    list.add(
        common_field("height", "Height of the highest node above the first root.", Unit::metre, 0.01, 1000),
        o.height);
    list.add(
        common_field(
            "dbh",
            "Diameter of the thickest stem at 1.3 m, or at a quarter of the height of low trees; 0 scales "
            "radii with the height.",
            Unit::metre, 0, 50),
        o.dbh);
    list.add(
        common_field("tip_radius", "Radius of the thinnest node, if there is a dbh.", Unit::metre, 1e-5, 10),
        o.tip_radius);
    list.add(Field{"taper", "Share by which the stem is thicker at the ground than at its tip, in addition.",
                   Unit::none, 0, 5},
             o.taper);
    list.add(Field{"flare", "Share by which roots widen the stem at the ground.", Unit::none, 0, 5}, o.flare);
    list.add(Field{"flare_height", "Height at which a 1/e of that is left.", Unit::metre, 1e-3, 100},
             o.flare_height);
}

}  // namespace coppice
