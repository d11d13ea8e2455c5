#include "coppice/foliage/leaf_frame_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/base/error.h"
#include "coppice/base/random.h"
#include "coppice/base/srgb.h"

namespace coppice::foliage_internal {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr Vec3 kUp{0, 0, 1};

/// Returns the sum of three uniform numbers of 21 bits with the variance 1.
float draw_normal(std::uint64_t bits) {
    constexpr std::uint64_t kMask = (1u << 21) - 1;
    const std::uint64_t sum = (bits & kMask) + ((bits >> 21) & kMask) + ((bits >> 42) & kMask);
    return 2 * (static_cast<float>(sum) * 0x1p-21f - 1.5f);
}

float find_azimuth(const LeafRules& rules, std::uint32_t node, std::uint32_t index, float start) {
    const auto k = static_cast<float>(node), j = static_cast<float>(index);
    switch (rules.arrangement) {
        case LeafArrangement::spiral:
            return start + std::fmod(k * rules.divergence, 2 * kPi);
        case LeafArrangement::two_ranked:
            return kPi * static_cast<float>(node % 2);
        case LeafArrangement::opposite:
            return start + 0.5f * kPi * static_cast<float>(node % 2) + kPi * j;
        case LeafArrangement::whorled: {
            const float gap = 2 * kPi / static_cast<float>(rules.whorl);
            return start + gap * (j + 0.5f * static_cast<float>(node % 2));
        }
    }
    return start;
}

/// Removes the component along a unit vector, and normalises the rest.
Vec3 reject(Vec3 v, Vec3 unit, Vec3 fallback) {
    const Vec3 rest = v - unit * dot(v, unit);
    return length_squared(rest) > 1e-8f ? normalized(rest) : fallback;
}

/// Turns a direction towards the horizontal by the share of the light, and down by the droop.
Vec3 turn_down(Vec3 along, Vec3 radial, float light, float droop) {
    along = normalized(Vec3{along.x, along.y, along.z * (1 - light)}, radial);
    const Vec3 level = reject(along, kUp, reject(radial, kUp, {1, 0, 0}));
    constexpr float kSteep = 1.5f;
    const float elevation = std::clamp(std::asin(std::clamp(along.z, -1.0f, 1.0f)) - droop, -kSteep, kSteep);
    return level * std::cos(elevation) + kUp * std::sin(elevation);
}

Vec3 choose_color(const std::optional<Vec3d>& given, Vec3 otherwise, std::string_view name) {
    if (!given) return otherwise;
    for (int k = 0; k < 3; ++k) {
        if (!((*given)[k] >= 0 && (*given)[k] <= 1))
            throw InvalidInput(
                fmt::format("leaves: {} must have three values from 0 to 1, but has {}", name, (*given)[k]));
    }
    return Vec3(*given);
}

}  // namespace

LeafDraws draw_leaf(std::uint64_t key, std::uint64_t index) {
    const CounterRandom random(key, index);
    LeafDraws out;
    for (std::size_t k = 0; k < out.uniform.size(); ++k)
        out.uniform[k] = static_cast<float>(random.uniform(k));
    for (std::size_t k = 0; k < out.normal.size(); ++k) out.normal[k] = draw_normal(random.bits(16 + k));
    out.bits = random.bits(32);
    return out;
}

LeafFrame make_frame(const ShootPlace& place, const LeafRules& rules, std::uint32_t node, std::uint32_t index,
                     float start, float opening, const LeafDraws& draws) {
    // Leaves at the tip have not yet turned away from the shoot.
    const float opened = opening * std::min(1.0f, 0.55f + 2 * place.from_tip);
    const float azimuth = find_azimuth(rules, node, index, start) + 0.5f * rules.spread * draws.normal[0];
    const Vec3 across = cross(place.axis, place.normal);
    const Vec3 radial = place.normal * std::cos(azimuth) + across * std::sin(azimuth);
    const float angle = std::clamp(rules.angle * opened + rules.spread * draws.normal[1], 0.0f, kPi);
    const Vec3 grown = place.axis * std::cos(angle) + radial * std::sin(angle);
    const Vec3 along = turn_down(grown, radial, rules.light, rules.droop + rules.spread * draws.normal[2]);

    const Vec3 inner = reject(place.axis, along, reject(-radial, along, perpendicular(along)));
    const Vec3 level = reject(kUp, along, inner);
    const Vec3 blend = inner * (1 - rules.light) + level * rules.light;
    const Vec3 up = reject(blend, along, level);
    const float roll = rules.spread * draws.normal[3];
    return {.attachment = place.center + radial * place.radius,
            .along = along,
            .up = normalized(up * std::cos(roll) + cross(along, up) * std::sin(roll))};
}

Quaternion make_rotation(const LeafFrame& frame) {
    const Vec3 x = cross(frame.along, frame.up), y = frame.along, z = frame.up;
    Quaternion r;
    const float trace = x.x + y.y + z.z;
    if (trace > 0) {
        r = {y.z - z.y, z.x - x.z, x.y - y.x, 1 + trace};
    } else if (x.x > y.y && x.x > z.z) {
        r = {1 + x.x - y.y - z.z, x.y + y.x, z.x + x.z, y.z - z.y};
    } else if (y.y > z.z) {
        r = {x.y + y.x, 1 + y.y - x.x - z.z, y.z + z.y, z.x - x.z};
    } else {
        r = {z.x + x.z, y.z + z.y, 1 + z.z - x.x - y.y, x.y - y.x};
    }
    const float scale = 1 / std::sqrt(r.x * r.x + r.y * r.y + r.z * r.z + r.w * r.w);
    return {r.x * scale, r.y * scale, r.z * scale, r.w * scale};
}

SeasonEffects::SeasonEffects(const LeafRules& rules)
    : season_(rules.season),
      evergreen_(rules.evergreen),
      young_(choose_color(rules.young_color, {0.47f, 0.588f, 0.235f}, "young_color")),
      summer_(choose_color(rules.summer_color, {0.29f, 0.384f, 0.165f}, "summer_color")),
      autumn_(choose_color(rules.autumn_color, {0.878f, 0.722f, 0.22f}, "autumn_color")) {}

SeasonState SeasonEffects::find(float from_tip) const {
    constexpr float kNewGrowth = 0.15f;  // of the shoots of evergreens
    const bool is_old = evergreen_ && from_tip > kNewGrowth;
    switch (season_) {
        case Season::bud:
            if (is_old) break;
            return {.size = 0.25f, .angle = 0.35f, .hue = {young_, lerp(young_, summer_, 0.2f)}};
        case Season::young:
            if (is_old) break;
            return {.size = 0.7f, .angle = 0.7f, .hue = {young_, lerp(young_, summer_, 0.5f)}};
        case Season::summer:
            break;
        case Season::autumn:
            if (evergreen_) break;
            return {.density = 0.8f, .hue = {lerp(summer_, autumn_, 0.25f), autumn_}};
        case Season::winter:
            if (evergreen_) break;
            return {.density = 0, .hue = {autumn_, autumn_}};
    }
    return {.hue = {summer_, lerp(summer_, young_, 0.35f * (1 - from_tip))}};
}

std::array<std::uint8_t, 3> make_color(const SeasonState& season, const LeafRules& rules, float mix,
                                       float light) {
    return to_bytes(lerp(season.hue[0], season.hue[1], mix) * (1 + rules.color_spread * (2 * light - 1)));
}

}  // namespace coppice::foliage_internal
