#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/implicit/solid/solid_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {
namespace {

/// Boxes are enlarged by this share of size and coordinates, so that the field in single precision is 0
/// outside them too.
constexpr double kSlack = 4e-6;

struct Extent {
    Vec3d low{1e300, 1e300, 1e300};
    Vec3d high{-1e300, -1e300, -1e300};

    bool empty() const { return !(low.x <= high.x); }
    void extend(Vec3d p) { extend(p, {}); }
    void extend(Vec3d p, Vec3d margin) {
        for (int i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], p[i] - margin[i]);
            high[i] = std::max(high[i], p[i] + margin[i]);
        }
    }
    template <class Visit>
    void visit_corners(const Visit& visit) const {
        for (int i = 0; i < 8; ++i) {
            visit(Vec3d{i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
        }
    }
};

Extent compute_extent(const Solid& solid, const Affine& map, double value);

/// Returns the extent of the image of the unit ball (or of the unit disc perpendicular to z) along each axis.
Vec3d ball_reach(const Affine& m) {
    return {std::hypot(m.x.x, m.y.x, m.z.x), std::hypot(m.x.y, m.y.y, m.z.y),
            std::hypot(m.x.z, m.y.z, m.z.z)};
}
Vec3d disc_reach(const Affine& m) {
    return {std::hypot(m.x.x, m.y.x), std::hypot(m.x.y, m.y.y), std::hypot(m.x.z, m.y.z)};
}

void extend_disc(Extent& out, const Affine& m, double height, double radius, Vec3d margin) {
    out.extend(m.point({0, 0, height}), disc_reach(m) * radius + margin);
}

Extent box_extent(Vec3d low, Vec3d high) { return {low, high}; }

Extent primitive_extent(const SolidNode& node, const Affine& m, double value) {
    Extent out;
    const double distance = distance_of_value(node, value);
    if (distance < 0) return out;
    const Vec3d margin = ball_reach(m) * distance;
    const auto add = [&](Vec3d p) { out.extend(m.point(p), margin); };
    switch (node.kind) {
        case SolidKind::box:
            box_extent(-node.size, node.size).visit_corners(add);
            break;
        case SolidKind::shape: {
            const Box3 b = node.shape->bounds();
            box_extent(Vec3d(b.low), Vec3d(b.high)).visit_corners(add);
            break;
        }
        case SolidKind::polyline:
        case SolidKind::polygon:
            for (const Vec3d p : node.points) add(p);
            break;
        default:  // rotationally symmetric about z: sphere, line, circle, disc, cylinder, cone
            extend_disc(out, m, 0, node.size.x, margin);
            extend_disc(out, m, node.size.z, node.kind == SolidKind::cone ? node.size.y : node.size.x,
                        margin);
    }
    return out;
}

Box3 to_box(const Extent& e) {
    Box3 box;
    if (e.empty()) return box;
    double slack = 0;
    for (int i = 0; i < 3; ++i) {
        slack = std::max({slack, std::abs(e.low[i]), std::abs(e.high[i]), e.high[i] - e.low[i]});
    }
    const Vec3d margin = Vec3d{1, 1, 1} * (slack * kSlack);
    extend_outward(box, e.low - margin);
    extend_outward(box, e.high + margin);
    return box;
}

/// Returns for each part the number of parts (including itself) that could add to it somewhere; the total
/// number if there are very many.
std::vector<double> overlap_counts(const SolidNode& node, const Affine& map) {
    constexpr std::size_t kMany = 4096;
    if (node.parts.size() > kMany) return std::vector<double>(node.parts.size(), double(node.parts.size()));
    std::vector<Box3> boxes;
    for (const Solid& part : node.parts) {
        const Box3 support = to_box(compute_extent(part, map, 0));
        boxes.push_back(support.empty() ? Box3{{}, {}} : support);
    }
    const BoxTree tree(boxes, {.threads = 1});
    std::vector<double> count(boxes.size(), 0);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        tree.visit_overlapping(boxes[i], [&](std::uint32_t) { count[i] += 1; });
    }
    return count;
}

/// Where n parts add up to `value`, one of them is at least 1 / n of it (n-th roots for Ricci).
Extent sum_extent(const SolidNode& node, const Affine& map, double value) {
    Extent out;
    const double exponent = node.kind == SolidKind::ricci ? node.size.x : 1;
    const auto count = value > 0 ? overlap_counts(node, map) : std::vector<double>(node.parts.size(), 1.0);
    for (std::size_t i = 0; i < node.parts.size(); ++i) {
        const Extent part = compute_extent(node.parts[i], map, value / std::pow(count[i], 1 / exponent));
        if (part.empty()) continue;
        out.extend(part.low);
        out.extend(part.high);
    }
    return out;
}

Extent union_extent(const SolidNode& node, const Affine& map, double value) {
    Extent out;
    for (const Solid& solid : node.parts) {
        const Extent part = compute_extent(solid, map, value);
        if (part.empty()) continue;
        out.extend(part.low);
        out.extend(part.high);
    }
    return out;
}

Extent common_extent(const SolidNode& node, const Affine& map, double value) {
    Extent out = compute_extent(node.parts.front(), map, value);
    for (const Solid& solid : node.parts) {
        const Extent part = compute_extent(solid, map, value);
        for (int i = 0; i < 3; ++i) {
            out.low[i] = std::max(out.low[i], part.low[i]);
            out.high[i] = std::min(out.high[i], part.high[i]);
        }
        if (!(out.low.x <= out.high.x && out.low.y <= out.high.y && out.low.z <= out.high.z)) return {};
    }
    return out;
}

/// A twist preserves the height and the distance from the axis.
Extent twisted_extent(const Extent& straight, const Affine& m) {
    double radius = 0;
    straight.visit_corners([&](Vec3d p) { radius = std::max(radius, std::hypot(p.x, p.y)); });
    Extent out;
    extend_disc(out, m, straight.low.z, radius, {});
    extend_disc(out, m, straight.high.z, radius, {});
    return out;
}

Extent tapered_extent(const SolidNode& node, const Extent& straight, const Affine& m) {
    Extent out;
    for (const double z : {straight.low.z, straight.high.z}) {
        const double scale = 1 + (node.size.y - 1) * std::clamp(z / node.size.x, 0.0, 1.0);
        straight.visit_corners([&](Vec3d p) { out.extend(m.point({p.x * scale, p.y * scale, p.z})); });
    }
    return out;
}

/// Returns the extent of the three sections of a bend: the straight one before, the arc, the straight one
/// after.
Extent bent_extent(const SolidNode& node, const Extent& straight, const Affine& m) {
    const double height = node.size.x, angle = node.size.y, arc_radius = height / angle;
    const double low = straight.low.z, high = straight.high.z;
    Extent bent;  // in the frame
    const auto add = [&](double x, double z) {
        const double turn = std::clamp(z / height, 0.0, 1.0) * angle;
        const double beyond = z < 0 ? z : std::max(z - height, 0.0), r = arc_radius - x;
        const Vec3d p{arc_radius - r * std::cos(turn) + beyond * std::sin(turn), 0,
                      r * std::sin(turn) + beyond * std::cos(turn)};
        bent.extend({p.x, straight.low.y, p.z});
        bent.extend({p.x, straight.high.y, p.z});
    };
    for (const double x : {straight.low.x, straight.high.x}) {
        add(x, low);
        add(x, high);
        // Where the sections meet, and where the arc is highest and farthest to the side.
        for (const double z :
             {0.0, height, arc_radius * std::numbers::pi / 2, arc_radius * std::numbers::pi}) {
            if (z > low && z < high && z <= height) add(x, z);
        }
    }
    Extent out;
    bent.visit_corners([&](Vec3d p) { out.extend(m.point(p)); });
    return out;
}

Extent warped_extent(const SolidNode& node, const Affine& map, double value) {
    const Extent straight = compute_extent(node.parts.front(), node.map.inverse(), value);
    if (straight.empty()) return {};
    const Affine m = map * node.map;
    if (node.kind == SolidKind::twist) return twisted_extent(straight, m);
    if (node.kind == SolidKind::taper) return tapered_extent(node, straight, m);
    return bent_extent(node, straight, m);
}

Extent compute_extent(const Solid& solid, const Affine& map, double value) {
    const SolidNode& node = solid.node();
    switch (node.kind) {
        case SolidKind::unite:
            return union_extent(node, map, value);
        case SolidKind::intersect:
            return common_extent(node, map, value);
        case SolidKind::subtract:
            return compute_extent(node.parts.front(), map, value);
        case SolidKind::blend:
        case SolidKind::ricci:
            return sum_extent(node, map, value);
        case SolidKind::transform:
            return compute_extent(node.parts.front(), map * node.map, value);
        case SolidKind::twist:
        case SolidKind::taper:
        case SolidKind::bend:
            return warped_extent(node, map, value);
        default:
            return primitive_extent(node, map * node.map, value);
    }
}

/// Returns an upper bound of the distance at which the law soft has a value in (0, 1], as a share of the
/// influence.
double soft_distance(double value) {
    constexpr int kHalvings = 50;
    double low = 0, high = 1;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        (law_value(FieldLaw::soft, middle) > value ? low : high) = middle;
    }
    return std::sqrt(high);
}

}  // namespace

double law_value(FieldLaw law, double s) { return (1 - s) * (1 - s) * (1 - s + law_share(law) * s); }

double distance_of_value(const SolidNode& primitive, double value) {
    if (value <= 0) return primitive.influence;
    if (!(value <= primitive.weight)) return -1;
    const double most = primitive.influence;
    const bool closed = primitive.closed && primitive.kind == SolidKind::shape;
    if (primitive.law == FieldLaw::soft) {
        const double x = soft_distance(value / primitive.weight);
        return most * (closed ? std::max(0.0, 2 * x - 1) : x);
    }
    // Outside, a closed shape's field is convex: it is below its chord.
    if (closed) return most * std::max(0.0, 1 - 2 * value);
    return most * std::sqrt(std::max(0.0, 1 - std::cbrt(value / primitive.weight)));
}

Box3 compute_box(const Solid& solid, const Affine& map, double value) {
    return to_box(compute_extent(solid, map, value));
}

}  // namespace coppice
