#include "coppice/foliage/flat_leaf_internal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace coppice::foliage_internal {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// Returns the integral of the cosine (x) and of the sine (y) of first + k s over s from 0 to `to`.
Point2 integrate_arc(float first, float k, float to) {
    if (std::abs(k * to) < 1e-4f) return {to * std::cos(first), to * std::sin(first)};
    return {(std::sin(first + k * to) - std::sin(first)) / k,
            (std::cos(first) - std::cos(first + k * to)) / k};
}

/// Bends a blade: folded at the midrib, raised towards the margin, waved, and curled down towards the tip.
/// All but the waves keep lengths and areas.
class BladeBend {
  public:
    explicit BladeBend(const LeafShape& shape) : shape_(shape) {}

    Vec3 operator()(Point2 p, float t) const {
        const float away = std::abs(p.x), half = 0.5f * shape_.width;
        const Point2 across = integrate_arc(shape_.fold, shape_.cup / half, away);
        const float waves = static_cast<float>(std::max(shape_.veins, 1));
        const float height =
            across.y + shape_.wave * shape_.length * std::sin(2 * kPi * waves * t) * away / half;
        return bend_along({std::copysign(across.x, p.x), p.y, height});
    }

    /// Curls a point down around the axis across the blade.
    Vec3 bend_along(Vec3 p) const {
        const float k = shape_.curl / shape_.length;
        const Point2 along = integrate_arc(0, k, p.y);
        return {p.x, along.x + p.z * std::sin(k * p.y), p.z * std::cos(k * p.y) - along.y};
    }

  private:
    const LeafShape& shape_;
};

/// The place of a leaflet or a blade.
struct Placing {
    Point2 base;      ///< [m]
    float angle = 0;  ///< [rad] about z, counter-clockwise
    float scale = 1;  ///< of its size
    float tilt = 0;   ///< [rad] downwards

    Point2 place(Point2 p) const {
        const float c = std::cos(angle) * scale, s = std::sin(angle) * scale;
        return base + Point2{c * p.x - s * p.y, s * p.x + c * p.y};
    }
    Vec3 place(Vec3 p) const {
        const float c = std::cos(tilt), s = std::sin(tilt);
        const Point2 flat = place(Point2{p.x, c * p.y + s * p.z});
        return {flat.x, flat.y, scale * (c * p.z - s * p.y)};
    }
};

class Builder {
  public:
    explicit Builder(const LeafShape& shape)
        : shape_(shape), bend_(shape), rows_(make_rows(shape, shape.rows)) {}

    void add_blade(const Placing& at) {
        add_half(at, 1);
        add_half(at, -1);
    }

    /// Adds a prism with three sides along y.
    void add_stalk(float from, float to, float width) {
        constexpr int kStraightRows = 2, kArchedRows = 10;
        const int rows = shape_.arch == 0 ? kStraightRows : kArchedRows;
        std::vector<Ring> rings;
        for (int i = 0; i <= rows; ++i) {
            const float f = static_cast<float>(i) / static_cast<float>(rows);
            const float y = from + f * (to - from), radius = 0.5f * width * (1.15f - 0.3f * f);
            rings.push_back(add_ring(radius, y, [](Vec3 p) { return p; }));
        }
        join_rings(rings, LeafPart::petiole);
    }

    /// Adds a needle that leaves the axis of its bundle at an angle.
    void add_needle(float base, float angle, float azimuth) {
        const float c = std::cos(angle), s = std::sin(angle);
        const float ca = std::cos(azimuth), sa = std::sin(azimuth);
        const auto place = [&](Vec3 p) {
            const Vec3 bent = bend_.bend_along(p);
            const float y = c * bent.y - s * bent.z, out = s * bent.y + c * bent.z;
            return Vec3{ca * bent.x - sa * out, base + y, sa * bent.x + ca * out};
        };
        std::vector<Ring> rings;
        for (int i = 0; i < shape_.rows; ++i) {
            const float f = static_cast<float>(i) / static_cast<float>(shape_.rows);
            const float radius = 0.5f * shape_.width * std::min(1.0f, 0.7f + f) * std::sqrt(1 - f * f);
            rings.push_back(add_ring(radius, f * shape_.length, place));
        }
        join_rings(rings, LeafPart::needle);
        const FlatCorner tip = add_corner(place({0, shape_.length, 0}), 1);
        const Ring& last = rings.back();
        for (std::size_t k = 0; k < 3; ++k) add_triangle(last[k], tip, last[(k + 1) % 3], LeafPart::needle);
    }

    FlatLeaf take() {
        bend_down();
        return std::move(leaf_);
    }

  private:
    using Ring = std::array<FlatCorner, 3>;

    /// Bends all positions along a circular arc, which keeps their distances along the leaf.
    void bend_down() {
        if (shape_.arch == 0) return;
        float end = 0;
        for (const Vec3 p : leaf_.positions) end = std::max(end, p.y);
        if (end <= 0) return;
        const float k = shape_.arch / end;
        for (Vec3& p : leaf_.positions) {
            const Point2 along = integrate_arc(0, k, p.y);
            p = {p.x, along.x + p.z * std::sin(k * p.y), p.z * std::cos(k * p.y) - along.y};
        }
    }

    /// Corners of the row across one half, from the midrib to the margin.
    using Row = std::vector<FlatCorner>;

    FlatCorner add_corner(Vec3 position, float t) {
        leaf_.positions.push_back(position);
        return {static_cast<std::uint32_t>(leaf_.positions.size() - 1), {position.x, position.y}, t, 0, {}};
    }

    FlatCorner add_blade_corner(const Placing& at, Point2 local, float t, float s) {
        FlatCorner corner = add_corner(at.place(bend_(local, t)), t);
        corner.flat = at.place(local);
        corner.local = local;
        corner.s = s;
        return corner;
    }

    void add_triangle(const FlatCorner& a, const FlatCorner& b, const FlatCorner& c, LeafPart part) {
        if (a.vertex == b.vertex || b.vertex == c.vertex || c.vertex == a.vertex) return;
        leaf_.triangles.push_back({{a, b, c}, part});
        const Vec3 p = leaf_.positions[a.vertex];
        const Vec3 normal = cross(leaf_.positions[b.vertex] - p, leaf_.positions[c.vertex] - p);
        if (part == LeafPart::needle) leaf_.area += 0.25 * double{length(normal)};
        if (part != LeafPart::blade) return;
        const Point2 ab = b.flat - a.flat, ac = c.flat - a.flat;
        leaf_.area += 0.5 * std::abs(double{ab.x} * double{ac.y} - double{ab.y} * double{ac.x});
    }

    /// Adds the corners of a row; those at the place of the row before share its vertices.
    Row add_row(const Placing& at, const BladeRow& row, float side, const Row& before, Row& midrib,
                std::size_t index) {
        const bool is_point = row.inner == row.outer;
        Row out;
        for (int j = 0; j <= shape_.columns; ++j) {
            const float f = static_cast<float>(j) / static_cast<float>(shape_.columns);
            const Point2 p = row.inner + (row.outer - row.inner) * f;
            if (j == 0) {
                const bool is_shared = !before.empty() && before.front().local == row.inner;
                if (index == midrib.size())
                    midrib.push_back(is_shared ? before.front() : add_blade_corner(at, p, row.t, 0));
                out.push_back(midrib[index]);
            } else if (is_point) {
                out.push_back(out.front());
            } else {
                out.push_back(add_blade_corner(at, {side * p.x, p.y}, row.t, side * f));
            }
            out.back().t = row.t;
            out.back().s = side * f;
        }
        return out;
    }

    /// Adds the half of a blade to the right (1) or to the left (-1); both share the midrib.
    void add_half(const Placing& at, float side) {
        if (side > 0) midrib_.clear();
        Row before;
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            const Row row = add_row(at, rows_[i], side, before, midrib_, i);
            // The first row is a point; there is nothing between it and a row that begins at this point.
            const bool is_first = before.empty() || before.back().vertex == row.front().vertex;
            for (std::size_t j = 0; !is_first && j + 1 < row.size(); ++j) {
                if (side > 0) {
                    add_triangle(before[j], before[j + 1], row[j + 1], LeafPart::blade);
                    add_triangle(before[j], row[j + 1], row[j], LeafPart::blade);
                } else {
                    add_triangle(before[j], row[j + 1], before[j + 1], LeafPart::blade);
                    add_triangle(before[j], row[j], row[j + 1], LeafPart::blade);
                }
            }
            before = row;
        }
    }

    template <class Place>
    Ring add_ring(float radius, float y, const Place& place) {
        Ring ring;
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const float angle = kPi / 2 + 2 * kPi / 3 * static_cast<float>(k);
            ring[k] = add_corner(place(Vec3{radius * std::cos(angle), y, radius * std::sin(angle)}), 0);
        }
        return ring;
    }

    void join_rings(const std::vector<Ring>& rings, LeafPart part) {
        for (std::size_t i = 0; i + 1 < rings.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t next = (k + 1) % 3;
                add_triangle(rings[i][k], rings[i + 1][k], rings[i + 1][next], part);
                add_triangle(rings[i][k], rings[i + 1][next], rings[i][next], part);
            }
        }
    }

    const LeafShape& shape_;
    BladeBend bend_;
    std::vector<BladeRow> rows_;
    Row midrib_;
    FlatLeaf leaf_;
};

void add_palmate(const LeafShape& shape, Builder& builder) {
    for (int i = 0; i < shape.leaflets; ++i) {
        const int rank = (i + 1) / 2;
        const float side = i % 2 == 0 ? 1.0f : -1.0f;
        const float size = std::max(0.4f, 1 - 0.055f * static_cast<float>(rank * (rank + 1)));
        builder.add_blade({.base = {0, shape.petiole_length},
                           .angle = side * shape.leaflet_angle * static_cast<float>(rank),
                           .scale = size,
                           .tilt = shape.blade_angle});
    }
}

void add_pinnate(const LeafShape& shape, Builder& builder) {
    const int pairs = shape.leaflets / 2;
    const float step = shape.leaflet_spacing * shape.width;
    const float end = shape.petiole_length + step * (static_cast<float>(pairs) - 0.5f);
    if (pairs > 0) builder.add_stalk(shape.petiole_length, end, 0.7f * shape.petiole_width);
    for (int i = 0; i < pairs; ++i) {
        const float y = shape.petiole_length + step * static_cast<float>(i);
        const float f = (static_cast<float>(i) + 0.5f) / static_cast<float>(pairs);
        const float size =
            std::max(0.05f, (1 - 0.6f * (f - 0.45f) * (f - 0.45f)) * (1 - shape.leaflet_taper * f * f));
        for (const float side : {1.0f, -1.0f})
            builder.add_blade({.base = {0, y},
                               .angle = side * shape.leaflet_angle,
                               .scale = size,
                               .tilt = shape.blade_angle});
    }
    if (shape.leaflets % 2 == 1)
        builder.add_blade({.base = {0, pairs > 0 ? end : shape.petiole_length},
                           .scale = std::max(0.05f, 1 - (pairs > 0 ? shape.leaflet_taper : 0)),
                           .tilt = shape.blade_angle});
}

void add_needles(const LeafShape& shape, Builder& builder) {
    for (int i = 0; i < shape.leaflets; ++i) {
        const float azimuth = 2 * kPi * static_cast<float>(i) / static_cast<float>(shape.leaflets);
        builder.add_needle(shape.petiole_length, shape.leaflets > 1 ? shape.leaflet_angle : 0,
                           azimuth + kPi / 2);
    }
}

}  // namespace

FlatLeaf make_flat_leaf(const LeafShape& shape) {
    Builder builder(shape);
    if (shape.petiole_length > 0) builder.add_stalk(0, shape.petiole_length, shape.petiole_width);
    switch (shape.parts) {
        case LeafParts::simple:
            builder.add_blade({.base = {0, shape.petiole_length}, .tilt = shape.blade_angle});
            break;
        case LeafParts::palmate:
            add_palmate(shape, builder);
            break;
        case LeafParts::pinnate:
            add_pinnate(shape, builder);
            break;
        case LeafParts::needles:
            add_needles(shape, builder);
            break;
    }
    return builder.take();
}

FlatLeaf make_fine_leaf(const LeafShape& shape) {
    constexpr int kMinRows = 160, kRowsPerTooth = 8;
    LeafShape fine = shape;
    fine.rows = std::max(kMinRows, shape.margin == LeafMargin::entire ? 0 : kRowsPerTooth * shape.teeth);
    fine.columns = 1;
    return make_flat_leaf(fine);
}

FlatBox find_image_box(const FlatLeaf& fine_leaf) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    FlatBox box{{kInfinity, 0}, {-kInfinity, -kInfinity}};
    for (const FlatTriangle& triangle : fine_leaf.triangles) {
        for (const FlatCorner& corner : triangle.corners) {
            box.low = {std::min(box.low.x, corner.flat.x), std::min(box.low.y, corner.flat.y)};
            box.high = {std::max(box.high.x, corner.flat.x), std::max(box.high.y, corner.flat.y)};
        }
    }
    return box;
}

}  // namespace coppice::foliage_internal
