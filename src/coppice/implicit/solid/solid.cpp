#include "coppice/implicit/solid/solid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"
#include "coppice/implicit/solid/solid_internal.h"

namespace coppice {
namespace {

constexpr double kFarthest = 1e6;  // [m]
constexpr double kMin = 1e-6;      // [m] minimum of a length

/// Returns the share of the influence at which the law is 0.5.
double surface_share(FieldLaw law) { return law == FieldLaw::soft ? 0.5 : std::sqrt(1 - std::cbrt(0.5)); }

void check_point(std::string_view subject, Vec3 p) {
    if (is_finite(p) && std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= kFarthest) return;
    throw InvalidInput(fmt::format("{}: the point ({} {} {}) must be finite and within 1e6 m of the origin",
                                   subject, p.x, p.y, p.z));
}

void check_length(std::string_view subject, std::string_view name, double value) {
    if (value >= kMin && value <= kFarthest) return;
    throw InvalidInput(fmt::format("{}: {} must be between 1e-6 and 1e6 m, but is {}", subject, name, value));
}

Vec3d checked_direction(std::string_view subject, std::string_view name, Vec3 direction) {
    const double l = length(Vec3d(direction));
    if (std::isfinite(l) && l > 1e-12) return Vec3d(direction) / l;
    throw InvalidInput(fmt::format("{}: {} must be a finite direction that is not zero, but is ({} {} {})",
                                   subject, name, direction.x, direction.y, direction.z));
}

SolidNode primitive(std::string_view subject, SolidKind kind, const PrimitiveOptions& options) {
    check_fields(options, subject);
    SolidNode node;
    node.kind = kind;
    node.law = options.law;
    const double radius = options.radius;
    if (options.influence == 0) {
        node.influence = radius / surface_share(options.law);
        return node;
    }
    node.influence = options.influence;
    // Decimal radii of the command line, such as 0.1 and 0.11, have no exact ratio.
    if (!(node.influence >= 1.0999 * radius && node.influence <= 20.001 * radius)) {
        throw InvalidInput(fmt::format("{}: influence must be 0 or 1.1 to 20 radii of {} m, but is {} m",
                                       subject, options.radius, options.influence));
    }
    const double s = radius / node.influence;
    node.weight = 0.5 / law_value(options.law, s * s);
    return node;
}

Solid made(SolidNode node) {
    node.part_count = static_cast<std::uint32_t>(std::max<std::size_t>(1, node.points.size()));
    return Solid(std::make_shared<const SolidNode>(std::move(node)));
}

/// Sets the frame, with z from a towards b, and |b - a| as size.z.
void lay_along(SolidNode& node, std::string_view subject, Vec3 a, Vec3 b) {
    check_point(subject, a);
    check_point(subject, b);
    const double l = length(Vec3d(b) - Vec3d(a));
    if (l < kMin)
        throw InvalidInput(fmt::format("{}: the two ends coincide; specify two different points", subject));
    node.map = Affine::frame(Vec3d(a), (Vec3d(b) - Vec3d(a)) / l);
    node.size.z = l;
}

/// Returns the points without consecutive ones that coincide.
std::vector<Vec3d> distinct(std::string_view subject, std::span<const Vec3> points, bool closed) {
    std::vector<Vec3d> out;
    for (const Vec3 p : points) {
        check_point(subject, p);
        const Vec3d q(p);
        if (out.empty() || length(q - out.back()) >= kMin) out.push_back(q);
    }
    while (closed && out.size() > 1 && length(out.front() - out.back()) < kMin) out.pop_back();
    return out;
}

void check_count(std::string_view subject, std::size_t count, std::size_t least, std::size_t most) {
    if (count >= least && count <= most) return;
    throw InvalidInput(
        fmt::format("{}: needs {} to {} different points, but has {}", subject, least, most, count));
}

/// Returns twice the area of a polygon, along its normal.
Vec3d area_vector(std::span<const Vec3d> corners) {
    Vec3d sum{};
    for (std::size_t i = 0; i < corners.size(); ++i) {
        sum += cross(corners[i] - corners[0], corners[(i + 1) % corners.size()] - corners[0]);
    }
    return sum;
}

/// Creates a circle or disc.
Solid round_flat(const std::string& subject, SolidKind kind, Vec3 center, Vec3 axis, float radius,
                 const PrimitiveOptions& options) {
    SolidNode node = primitive(subject, kind, options);
    check_point(subject, center);
    check_length(subject, subject + "_radius", radius);
    node.map = Affine::frame(Vec3d(center), checked_direction(subject, "axis", axis));
    node.size = {radius, 0, 0};
    return made(std::move(node));
}

}  // namespace

Solid sphere(Vec3 center, const PrimitiveOptions& options) {
    SolidNode node = primitive("sphere", SolidKind::sphere, options);
    check_point("sphere", center);
    node.map = Affine::translation(Vec3d(center));
    return made(std::move(node));
}

Solid line(Vec3 a, Vec3 b, const PrimitiveOptions& options) {
    SolidNode node = primitive("line", SolidKind::line, options);
    lay_along(node, "line", a, b);
    return made(std::move(node));
}

Solid circle(Vec3 center, Vec3 axis, float circle_radius, const PrimitiveOptions& options) {
    return round_flat("circle", SolidKind::circle, center, axis, circle_radius, options);
}

Solid disc(Vec3 center, Vec3 axis, float disc_radius, const PrimitiveOptions& options) {
    return round_flat("disc", SolidKind::disc, center, axis, disc_radius, options);
}

Solid box(const Box3& skeleton, const PrimitiveOptions& options) {
    SolidNode node = primitive("box", SolidKind::box, options);
    check_point("box", skeleton.low);
    check_point("box", skeleton.high);
    const Vec3d low(skeleton.low), high(skeleton.high);
    for (int axis = 0; axis < 3; ++axis) {
        if (high[axis] - low[axis] >= kMin) continue;
        throw InvalidInput(fmt::format("box: the sides must be at least 1e-6 m long, but side {} is {}",
                                       "xyz"[axis], high[axis] - low[axis]));
    }
    node.map = Affine::translation((low + high) * 0.5);
    node.size = (high - low) * 0.5;
    return made(std::move(node));
}

Solid cylinder(Vec3 a, Vec3 b, float cylinder_radius, const PrimitiveOptions& options) {
    SolidNode node = primitive("cylinder", SolidKind::cylinder, options);
    lay_along(node, "cylinder", a, b);
    check_length("cylinder", "cylinder_radius", cylinder_radius);
    node.size.x = cylinder_radius;
    return made(std::move(node));
}

Solid cone(Vec3 a, Vec3 b, float a_radius, float b_radius, const PrimitiveOptions& options) {
    SolidNode node = primitive("cone", SolidKind::cone, options);
    lay_along(node, "cone", a, b);
    // One sharp end makes a cone; two would make a line.
    if (a_radius != 0 || b_radius == 0) check_length("cone", "a_radius", a_radius);
    if (b_radius != 0) check_length("cone", "b_radius", b_radius);
    node.size.x = a_radius;
    node.size.y = b_radius;
    return made(std::move(node));
}

Solid polyline(std::span<const Vec3> points, bool closed, const PrimitiveOptions& options) {
    SolidNode node = primitive("polyline", SolidKind::polyline, options);
    check_count("polyline", points.size(), 2, 100000);
    node.points = distinct("polyline", points, closed);
    check_count("polyline", node.points.size(), 2, 100000);
    node.closed = closed;
    node.map = Affine::translation(node.points.front());
    for (Vec3d& p : node.points) p = p - node.map.origin;
    return made(std::move(node));
}

Solid polygon(std::span<const Vec3> corners, const PrimitiveOptions& options) {
    SolidNode node = primitive("polygon", SolidKind::polygon, options);
    check_count("polygon", corners.size(), 3, 10000);
    node.points = distinct("polygon", corners, true);
    check_count("polygon", node.points.size(), 3, 10000);
    Vec3d center{};
    for (const Vec3d p : node.points) center += p / static_cast<double>(node.points.size());
    double size = 0;
    for (const Vec3d p : node.points) size = std::max(size, length(p - center));
    const Vec3d area = area_vector(node.points);
    if (!(length(area) > 1e-6 * size * size)) {
        throw InvalidInput("polygon: the corners enclose no area; use corners that are not on one line");
    }
    node.map = Affine::frame(center, area / length(area));
    const Affine to_plane = node.map.inverse();
    for (Vec3d& p : node.points) {
        p = to_plane.point(p);
        if (std::abs(p.z) > 0.01 * size) {
            throw InvalidInput(fmt::format(
                "polygon: a corner is {} m off the plane of the others; all corners must be in one plane",
                p.z));
        }
        p.z = 0;
    }
    return made(std::move(node));
}

Solid make_solid(std::shared_ptr<const Shape> shape, const PrimitiveOptions& options) {
    COPPICE_ASSERT(shape != nullptr);
    const Box3 bounds = shape->bounds();
    check_point("shape", bounds.low);
    check_point("shape", bounds.high);
    SolidNode node;
    if (shape->is_closed()) {
        check_fields(options, "shape");
        node.kind = SolidKind::shape;
        const Vec3d side = Vec3d(bounds.high) - Vec3d(bounds.low);
        node.influence = options.influence > 0 ? options.influence : 0.5 * std::min({side.x, side.y, side.z});
        check_length("shape", "influence", node.influence);
        node.closed = true;
        node.law = options.law;
    } else {
        node = primitive("shape", SolidKind::shape, options);
    }
    node.shape = std::move(shape);
    return made(std::move(node));
}

std::string_view Solid::kind() const {
    static constexpr std::array<std::string_view, 19> kNames{
        "sphere",      "line",      "circle", "disc",  "box",          "cylinder",   "cone",
        "polyline",    "polygon",   "shape",  "union", "intersection", "difference", "blend",
        "ricci blend", "transform", "twist",  "taper", "bend"};
    return kNames[static_cast<std::size_t>(node_->kind)];
}

std::span<const Solid> Solid::parts() const { return node_->parts; }
std::uint32_t Solid::part_count() const { return node_->part_count; }
std::uint32_t Solid::depth() const { return node_->depth; }
Box3 Solid::bounds_at(float value) const { return compute_box(*this, Affine{}, value); }

void list_fields(PrimitiveOptions& o, FieldList& list) {
    list.add(Field{"radius", "Distance of the surface from the skeleton.", Unit::metre, 1e-5, 1e5}, o.radius);
    list.add(
        Field{"influence",
              "Distance at which the field ends, 1.1 to 20 radii; 0 uses 2.2 radii, or 2 radii for the law "
              "soft.",
              Unit::metre, 0, 1e6},
        o.influence);
    list.add(
        Field{"law",
              "Falloff of the field with the share x of the influence: (1 - x^2)^3 or -4/9 x^6 + 17/9 x^4 "
              "- 22/9 x^2 + 1."},
        o.law);
}

}  // namespace coppice
