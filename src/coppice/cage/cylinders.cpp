#include "coppice/cage/cylinders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "coppice/base/frame.h"
#include "coppice/base/parallel.h"

namespace coppice {
namespace {

constexpr std::size_t kGrain = 16;

enum class Cap { open, flat, round };

/// A tube: its nodes, its caps, and the first indices of its rings, vertices, faces and corners in the mesh.
struct Tube {
    std::uint32_t first_node = 0, node_count = 0;
    std::uint32_t sides = 0;
    Cap start = Cap::flat, end = Cap::round;
    std::uint64_t vertex = 0, face = 0, corner = 0;
};

/// A ring, before it has vertices.
struct Circle {
    Vec3d center, tangent, normal;
    double radius = 0;
    double way = 0;  // along the axis, from its beginning
};

/// The axes of all tubes, in sequence: nodes with radii, without those at the position of the previous one.
struct Axes {
    std::vector<Tube> tubes;
    std::vector<Vec3d> positions;
    std::vector<double> radii;

    void add_node(Vec3 p, float r) {
        Tube& tube = tubes.back();
        if (tube.node_count > 0 && positions.back() == Vec3d(p)) return;
        positions.push_back(Vec3d(p));
        radii.push_back(double{r});
        ++tube.node_count;
    }
};

Cap cap_of_root(const Skeleton& s, NodeId root, BaseShape base) {
    if (base == BaseShape::round || s.children(root).size() != 1) return Cap::round;
    return base == BaseShape::flat ? Cap::flat : Cap::open;
}

void add_axis(Axes& axes, const Skeleton& s, NodeId first, const CylinderOptions& options) {
    Tube tube;
    tube.first_node = static_cast<std::uint32_t>(axes.positions.size());
    if (s.is_root(first)) tube.start = cap_of_root(s, first, options.base);
    if (options.tips == TipShape::flat) tube.end = Cap::flat;
    axes.tubes.push_back(tube);
    if (s.is_root(first)) {
        axes.add_node(s.position(first), s.radius(first));
    } else {
        const Segment segment = s.segment(first);
        axes.add_node(segment.a, segment.radius_a);
        axes.add_node(segment.b, segment.radius_b);
    }
    for (NodeId n = s.leader(first); n; n = s.leader(n)) axes.add_node(s.position(n), s.radius(n));
    if (axes.tubes.back().node_count == 1) axes.tubes.back().start = axes.tubes.back().end = Cap::round;
}

Axes find_axes(const Skeleton& s, const CylinderOptions& options) {
    Axes axes;
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n) || s.leader(s.parent(n)) != n) add_axis(axes, s, n, options);
    }
    return axes;
}

/// Chords of n sides are r (1 - cos(pi / n)) within their circle, about r (pi / n)^2 / 2: the distance is
/// constant if n is proportional to the root of r. Even if the maximum is even, so that all caps are quads.
std::uint32_t compute_sides(double radius, double largest, const CylinderOptions& options) {
    if (options.thin != TubeSides::by_radius) return static_cast<std::uint32_t>(options.sides);
    const bool even = options.sides % 2 == 0;
    const double wanted = options.sides * std::sqrt(radius / largest);
    const double step = even ? 2 : 1;
    return static_cast<std::uint32_t>(std::max(even ? 4.0 : 3.0, step * std::round(wanted / step)));
}

std::uint32_t cap_rings(const Tube& tube, Cap cap) {
    return cap == Cap::round ? std::max(1u, tube.sides / 4) - 1 : 0;
}

/// Discs with few sides are one face; others have a vertex in their middle.
bool has_pole(const Tube& tube, Cap cap) { return cap == Cap::round || (cap == Cap::flat && tube.sides > 4); }

std::uint64_t ring_count(const Tube& tube, int rows) {
    return std::uint64_t{tube.node_count - 1} * static_cast<std::uint64_t>(rows) + 1 +
           cap_rings(tube, tube.start) + cap_rings(tube, tube.end);
}

struct CapSize {
    std::uint64_t faces = 0, corners = 0;
};

CapSize cap_size(const Tube& tube, Cap cap) {
    if (cap == Cap::open) return {};
    if (!has_pole(tube, cap)) return {1, tube.sides};
    const std::uint64_t quads = tube.sides / 2, triangles = tube.sides % 2;
    return {quads + triangles, 4 * quads + 3 * triangles};
}

/// Sets the number of sides and the first indices of every tube; returns one past the last as a tube.
Tube lay_out(Axes& axes, const CylinderOptions& options, CylinderReport& report) {
    const double largest = *std::ranges::max_element(axes.radii);
    Tube next;
    report.tubes = static_cast<std::uint32_t>(axes.tubes.size());
    report.min_sides = static_cast<std::uint32_t>(options.sides);
    for (Tube& tube : axes.tubes) {
        const auto first = axes.radii.begin() + tube.first_node;
        tube.sides = compute_sides(*std::max_element(first, first + tube.node_count), largest, options);
        tube.vertex = next.vertex;
        tube.face = next.face;
        tube.corner = next.corner;
        const std::uint64_t rings = ring_count(tube, options.rows);
        const CapSize start = cap_size(tube, tube.start), end = cap_size(tube, tube.end);
        next.vertex +=
            rings * tube.sides + (has_pole(tube, tube.start) ? 1 : 0) + (has_pole(tube, tube.end) ? 1 : 0);
        next.face += (rings - 1) * tube.sides + start.faces + end.faces;
        next.corner += 4 * (rings - 1) * tube.sides + start.corners + end.corners;
        report.rings += rings;
        report.min_sides = std::min(report.min_sides, tube.sides);
        report.max_sides = std::max(report.max_sides, tube.sides);
    }
    return next;
}

/// The circles of one tube: the spline at uniform steps of its parameter, in frames that are reflected from
/// circle to circle.
class Circles {
  public:
    Circles(const Axes& axes, const Tube& tube)
        : positions_(std::span(axes.positions).subspan(tube.first_node, tube.node_count)),
          radii_(std::span(axes.radii).subspan(tube.first_node, tube.node_count)) {}

    void sample(int rows, std::vector<Circle>& out) const {
        out.clear();
        if (positions_.size() == 1) {
            out.push_back({positions_[0], {0, 0, 1}, {1, 0, 0}, radii_[0]});
            return;
        }
        for (std::size_t i = 0; i + 1 < positions_.size(); ++i) {
            const Vec3d from = tangent(i), to = tangent(i + 1);
            for (int row = i == 0 ? 0 : 1; row <= rows; ++row) out.push_back(at(i, from, to, row, rows));
        }
        out.front().normal = perpendicular(out.front().tangent);
        for (std::size_t i = 1; i < out.size(); ++i) {
            const Circle& from = out[i - 1];
            out[i].way = from.way + distance(from.center, out[i].center);
            out[i].normal = carried(from.normal, from.center, from.tangent, out[i].center, out[i].tangent);
        }
    }

  private:
    /// Returns the derivative by length at a node: that of the parabola through it and its neighbours.
    Vec3d tangent(std::size_t i) const {
        const std::size_t last = positions_.size() - 1;
        const auto chord = [&](std::size_t k) {
            const Vec3d d = positions_[k + 1] - positions_[k];
            return d / length(d);
        };
        if (i == 0) return chord(0);
        if (i == last) return chord(last - 1);
        const double before = distance(positions_[i - 1], positions_[i]);
        const double after = distance(positions_[i], positions_[i + 1]);
        return (chord(i - 1) * after + chord(i) * before) / (before + after);
    }

    Circle at(std::size_t i, Vec3d from, Vec3d to, int row, int rows) const {
        const double t = static_cast<double>(row) / rows, u = 1 - t;
        const Vec3d a = positions_[i], b = positions_[i + 1], chord = b - a;
        const double l = length(chord);
        const Vec3d center = row == rows ? b
                                         : a * (u * u * (1 + 2 * t)) + b * (t * t * (3 - 2 * t)) +
                                               (from * (u * u * t) - to * (t * t * u)) * l;
        const Vec3d tangent = chord * (6 * t * u / l) + from * (u * (1 - 3 * t)) + to * (t * (3 * t - 2));
        return {center, normalized(tangent, chord / l), {}, radii_[i] + t * (radii_[i + 1] - radii_[i])};
    }

    std::span<const Vec3d> positions_;
    std::span<const double> radii_;
};

/// Writes vertices and faces of one tube.
class TubeWriter {
  public:
    TubeWriter(const Tube& tube, float tile, CylinderMesh& out)
        : tube_(tube),
          tile_(tile),
          mesh_(out.mesh),
          texture_(out.texture),
          vertex_(tube.vertex),
          face_(tube.face),
          corner_(tube.corner) {}

    void write(std::span<const Circle> circles) {
        double largest = 0;
        for (const Circle& c : circles) largest = std::max(largest, c.radius);
        circumference_ = 2 * std::numbers::pi * largest;
        if (tile_ > 0) wraps_ = std::max(1.0, std::round(circumference_ / double{tile_}));
        const Pole start_pole = pole(circles.front(), tube_.start, -1);
        const auto first_ring = static_cast<std::uint32_t>(vertex_);
        for (std::uint32_t k = cap_rings(tube_, tube_.start); k > 0; --k) cap_ring(circles.front(), k, -1);
        for (const Circle& c : circles) ring(c, 0, 1, 0);
        for (std::uint32_t k = 1; k <= cap_rings(tube_, tube_.end); ++k) cap_ring(circles.back(), k, 1);
        const auto last_ring = static_cast<std::uint32_t>(vertex_ - tube_.sides);
        const Pole end_pole = pole(circles.back(), tube_.end, 1);
        cap(tube_.start, first_ring, start_pole, ways_.front(), true);
        for (std::uint32_t ring = 0; ring + 1 < ways_.size(); ++ring) {
            const std::uint32_t low = first_ring + ring * tube_.sides, high = low + tube_.sides;
            for (std::uint32_t k = 0; k < tube_.sides; ++k) {
                const std::uint32_t next = (k + 1) % tube_.sides;
                add_face({corner(low + k, k, ways_[ring]), corner(low + next, k + 1, ways_[ring]),
                          corner(high + next, k + 1, ways_[ring + 1]), corner(high + k, k, ways_[ring + 1])});
            }
        }
        cap(tube_.end, last_ring, end_pole, ways_.back(), false);
    }

  private:
    struct Corner {
        std::uint32_t vertex;
        TexturePoint place;
    };
    struct Pole {
        std::uint32_t vertex = 0;
        double way = 0;
    };

    /// `turn` is in units of sides.
    Corner corner(std::uint32_t vertex, double turn, double way) const {
        return {vertex,
                {static_cast<float>(turn / tube_.sides * wraps_),
                 static_cast<float>(way / circumference_ * wraps_)}};
    }

    std::uint32_t add_vertex(Vec3d p) {
        mesh_.positions[vertex_] = Vec3(p);
        return static_cast<std::uint32_t>(vertex_++);
    }

    void add_face(std::initializer_list<Corner> corners) {
        for (const Corner& c : corners) {
            mesh_.corners[corner_] = c.vertex;
            texture_[corner_++] = c.place;
        }
        mesh_.first[++face_] = static_cast<std::uint32_t>(corner_);
    }

    /// `way` is the length over the cap, from the circle.
    void ring(const Circle& c, double along, double scale, double way) {
        const Vec3d binormal = cross(c.tangent, c.normal);
        ways_.push_back(c.way + way);
        for (std::uint32_t k = 0; k < tube_.sides; ++k) {
            const double angle = 2 * std::numbers::pi * k / tube_.sides;
            add_vertex(c.center + c.tangent * (along * c.radius) +
                       (c.normal * std::cos(angle) + binormal * std::sin(angle)) * (scale * c.radius));
        }
    }

    void cap_ring(const Circle& c, std::uint32_t k, double sign) {
        const double angle = std::numbers::pi / 2 * k / (cap_rings(tube_, Cap::round) + 1);
        ring(c, sign * std::sin(angle), std::cos(angle), sign * angle * c.radius);
    }

    Pole pole(const Circle& c, Cap cap, double sign) {
        if (!has_pole(tube_, cap)) return {};
        const bool round = cap == Cap::round;
        return {add_vertex(c.center + c.tangent * (round ? sign * c.radius : 0)),
                c.way + sign * c.radius * (round ? std::numbers::pi / 2 : 1)};
    }

    /// Closes a ring: quads around the pole with two edges each, or one face. Seen from outside the ring is
    /// reversed at the start.
    void cap(Cap cap, std::uint32_t ring, Pole pole, double way, bool backwards) {
        if (cap == Cap::open) return;
        const std::uint32_t n = tube_.sides;
        const auto at = [&](std::uint32_t k) {
            return corner(ring + (backwards ? (n - k % n) % n : k % n), backwards ? n - k : k, way);
        };
        const auto middle = [&](double k) { return corner(pole.vertex, backwards ? n - k : k, pole.way); };
        if (!has_pole(tube_, cap)) {
            n == 3 ? add_face({at(0), at(1), at(2)}) : add_face({at(0), at(1), at(2), at(3)});
            return;
        }
        for (std::uint32_t k = 0; k + 1 < n; k += 2) add_face({middle(k + 1), at(k), at(k + 1), at(k + 2)});
        if (n % 2 == 1) add_face({middle(n - 0.5), at(n - 1), at(n)});
    }

    const Tube& tube_;
    float tile_;
    PolygonMesh& mesh_;
    Buffer<TexturePoint>& texture_;
    std::uint64_t vertex_, face_, corner_;
    std::vector<double> ways_;  // of the rings, along the axis and over the caps
    double circumference_ = 0;
    double wraps_ = 1;
};

void check(const CylinderOptions& o) {
    if (o.sides < 3 || o.sides > 2048)
        throw InvalidInput(fmt::format("cylinders: sides must be from 3 to 2048, but is {}", o.sides));
    if (o.rows < 1 || o.rows > 64)
        throw InvalidInput(fmt::format("cylinders: rows must be from 1 to 64, but is {}", o.rows));
    if (!(o.tile >= 0))
        throw InvalidInput(fmt::format("cylinders: tile must be at least 0, but is {}", o.tile));
}

}  // namespace

CylinderMesh cylinders(const Skeleton& skeleton, const CylinderOptions& options, const Context& ctx) {
    check(options);
    CylinderMesh out;
    Axes axes = find_axes(skeleton, options);
    const Tube size = lay_out(axes, options, out.report);
    if (size.corner >= std::uint64_t{1} << 32 || size.vertex >= std::uint64_t{1} << 31)
        throw InvalidInput(fmt::format(
            "cylinders: {} vertices are too many to index; choose fewer levels or sides", size.vertex));
    out.mesh.origin = skeleton.origin();
    out.mesh.positions.resize(size.vertex);
    out.mesh.corners.resize(size.corner);
    out.texture.resize(size.corner);
    out.mesh.first.resize(size.face + 1);
    parallel_for_ranges(ctx, axes.tubes.size(), kGrain, [&](IndexRange range) {
        std::vector<Circle> circles;
        for (std::size_t i = range.begin; i < range.end; ++i) {
            Circles(axes, axes.tubes[i]).sample(options.rows, circles);
            TubeWriter(axes.tubes[i], options.tile, out).write(circles);
        }
    });
    return out;
}

}  // namespace coppice
