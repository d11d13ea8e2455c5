#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/base/error.h"
#include "coppice/implicit/solid/solid_internal.h"

namespace coppice {
namespace {

constexpr std::uint32_t kMaxParts = 1000000;
constexpr std::uint32_t kDeepest = 256;
constexpr double kFarthest = 1e6;  // [m]

Solid made(std::string_view subject, SolidNode node) {
    std::uint64_t count = 1;
    for (const Solid& part : node.parts) {
        count += part.part_count();
        node.depth = std::max(node.depth, part.depth() + 1);
    }
    if (count > kMaxParts) {
        throw InvalidInput(fmt::format("{}: would have {} parts, but the maximum is {}; use fewer", subject,
                                       count, kMaxParts));
    }
    if (node.depth > kDeepest) {
        throw InvalidInput(fmt::format(
            "{}: would have a nesting depth of {}, but the maximum is {}; combine several solids at once",
            subject, node.depth, kDeepest));
    }
    node.part_count = static_cast<std::uint32_t>(count);
    return Solid(std::make_shared<const SolidNode>(std::move(node)));
}

Solid checked_reach(std::string_view subject, Solid solid) {
    const Box3 box = solid.bounds();
    if (box.empty()) return solid;
    for (int axis = 0; axis < 3; ++axis) {
        const float reach = std::max(-box.low[axis], box.high[axis]);
        if (reach <= 2 * kFarthest) continue;
        throw InvalidInput(fmt::format(
            "{}: the solid would extend {} m from the origin, but the maximum is 2e6 m; make it smaller",
            subject, reach));
    }
    return solid;
}

Solid combined(std::string_view subject, SolidKind kind, std::span<const Solid> parts, double exponent = 1) {
    if (parts.empty()) throw InvalidInput(fmt::format("{}: needs at least one solid", subject));
    if (parts.size() == 1) return parts.front();
    SolidNode node;
    node.kind = kind;
    node.parts.assign(parts.begin(), parts.end());
    node.size.x = exponent;
    return made(subject, std::move(node));
}

void check_finite(std::string_view subject, std::string_view name, Vec3 v) {
    if (is_finite(v) && length(Vec3d(v)) <= kFarthest) return;
    throw InvalidInput(fmt::format("{}: {} must be finite and at most 1e6 m long, but is ({} {} {})", subject,
                                   name, v.x, v.y, v.z));
}

/// Sets a rigid frame at a with z towards b, and returns their distance.
double frame_along(SolidNode& node, std::string_view subject, Vec3 a, Vec3 b) {
    check_finite(subject, "a", a);
    check_finite(subject, "b", b);
    const double l = length(Vec3d(b) - Vec3d(a));
    if (l < 1e-6)
        throw InvalidInput(fmt::format("{}: a and b coincide; specify two different points", subject));
    node.map = Affine::frame(Vec3d(a), (Vec3d(b) - Vec3d(a)) / l);
    return l;
}

SolidNode over(SolidKind kind, const Solid& part) {
    SolidNode node;
    node.kind = kind;
    node.parts.push_back(part);
    return node;
}

/// Returns false also for values that are not finite.
bool is_moderate(const Affine& map) {
    constexpr double kMax = 1e7;
    return length(map.x) <= kMax && length(map.y) <= kMax && length(map.z) <= kMax && is_finite(map.origin);
}

Vec3d unit_axis(std::string_view subject, Vec3 axis) {
    check_finite(subject, "axis", axis);
    const double l = length(Vec3d(axis));
    if (!(l > 1e-12)) throw InvalidInput(fmt::format("{}: axis must not be zero", subject));
    return Vec3d(axis) / l;
}

Solid about(const Solid& solid, Vec3 center, const Affine& map) {
    return transformed(solid, Affine::translation(Vec3d(center)) * map * Affine::translation(-Vec3d(center)));
}

}  // namespace

Solid unite(std::span<const Solid> parts) { return combined("union", SolidKind::unite, parts); }
Solid intersect(std::span<const Solid> parts) {
    return combined("intersection", SolidKind::intersect, parts);
}
Solid blend(std::span<const Solid> parts) { return combined("blend", SolidKind::blend, parts); }

Solid subtract(const Solid& from, std::span<const Solid> parts) {
    if (parts.empty()) throw InvalidInput("difference: needs at least one solid to subtract");
    std::vector<Solid> all{from};
    all.insert(all.end(), parts.begin(), parts.end());
    return combined("difference", SolidKind::subtract, all);
}

Solid ricci_blend(std::span<const Solid> parts, float exponent) {
    if (!(exponent >= 1 && exponent <= 100)) {
        throw InvalidInput(fmt::format("ricci: exponent must be between 1 and 100, but is {}", exponent));
    }
    return combined("ricci blend", SolidKind::ricci, parts, exponent);
}

Solid transformed(const Solid& solid, const Affine& map) {
    // Consecutive maps are composed, so that moving a solid repeatedly does not increase its nesting depth.
    const bool again = solid.node().kind == SolidKind::transform;
    SolidNode node = over(SolidKind::transform, again ? solid.parts().front() : solid);
    node.map = again ? map * solid.node().map : map;
    if (!is_moderate(map) || !is_moderate(node.map) || !is_moderate(node.map.inverse())) {
        throw InvalidInput(
            "transform: the map must be finite and, together with previous maps, must not stretch or shrink "
            "any direction by more than 1e7");
    }
    return checked_reach("transform", made("transform", std::move(node)));
}

Solid translated(const Solid& solid, Vec3 by) {
    check_finite("translate", "the offset", by);
    return transformed(solid, Affine::translation(Vec3d(by)));
}

Solid relative_to(const Solid& solid, Vec3d origin) {
    return origin == Vec3d{} ? solid : translated(solid, Vec3(-origin));
}

Solid rotated(const Solid& solid, Vec3 axis, float angle, Vec3 center) {
    const Vec3d unit = unit_axis("rotate", axis);
    check_finite("rotate", "center", center);
    if (!(std::abs(angle) <= 1e4f)) {
        throw InvalidInput(fmt::format("rotate: angle must be between -1e4 and 1e4 rad, but is {}", angle));
    }
    return about(solid, center, Affine::rotation(unit, angle));
}

Solid scaled(const Solid& solid, Vec3 factors, Vec3 center) {
    check_finite("scale", "center", center);
    for (int axis = 0; axis < 3; ++axis) {
        const double size = std::abs(factors[axis]);
        if (size >= 1e-6 && size <= 1e6) continue;
        throw InvalidInput(
            fmt::format("scale: the absolute value of the factor along {} must be between 1e-6 and 1e6, but "
                        "the factor is {}",
                        "xyz"[axis], factors[axis]));
    }
    return about(solid, center, Affine::scaling(Vec3d(factors)));
}

Solid twisted(const Solid& solid, Vec3 origin, Vec3 axis, float rate) {
    SolidNode node = over(SolidKind::twist, solid);
    check_finite("twist", "origin", origin);
    node.map = Affine::frame(Vec3d(origin), unit_axis("twist", axis));
    node.size.x = rate;
    const Box3 straight = compute_box(solid, node.map.inverse(), 0);
    const double reach = straight.empty() ? 0 : std::max(-straight.low.z, straight.high.z);
    if (!(std::abs(rate) * std::max(reach, 1.0) <= 1e4)) {
        throw InvalidInput(fmt::format(
            "twist: rate must be finite and turn the solid by at most 1e4 rad, but is {} rad/m over {} m",
            rate, reach));
    }
    return checked_reach("twist", made("twist", std::move(node)));
}

Solid tapered(const Solid& solid, Vec3 a, Vec3 b, float factor) {
    SolidNode node = over(SolidKind::taper, solid);
    node.size.x = frame_along(node, "taper", a, b);
    node.size.y = factor;
    if (!(factor >= 0.01f && factor <= 100)) {
        throw InvalidInput(fmt::format("taper: factor must be between 0.01 and 100, but is {}", factor));
    }
    return checked_reach("taper", made("taper", std::move(node)));
}

Solid bent(const Solid& solid, Vec3 a, Vec3 b, Vec3 side, float angle) {
    SolidNode node = over(SolidKind::bend, solid);
    const double height = frame_along(node, "bend", a, b);
    check_finite("bend", "side", side);
    const Vec3d z = node.map.z, across = Vec3d(side) - z * dot(z, Vec3d(side));
    if (!(length(across) > 1e-6 * length(Vec3d(side)) && length(across) > 1e-12)) {
        throw InvalidInput("bend: side must point away from the line from a to b");
    }
    if (!(angle >= 0.001f && angle <= std::numbers::pi_v<float>)) {
        throw InvalidInput(fmt::format("bend: angle must be between 0.001 and pi rad, but is {}", angle));
    }
    const Vec3d x = across / length(across);
    node.map = {x, cross(z, x), z, Vec3d(a)};
    node.size = {height, angle, 0};
    const Box3 straight = compute_box(solid, node.map.inverse(), 0);
    if (!straight.empty() && straight.high.x > 0.999 * height / angle) {
        throw InvalidInput(
            fmt::format("bend: the solid's field reaches {} m to the side, which must be less than the "
                        "radius of the bend, {} m; bend less or over a greater length",
                        straight.high.x, height / angle));
    }
    return checked_reach("bend", made("bend", std::move(node)));
}

}  // namespace coppice
