#include "coppice/implicit/shape/curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/error.h"
#include "coppice/base/frame.h"
#include "coppice/base/option_fields.h"
#include "coppice/implicit/shape/curve_internal.h"
#include "coppice/implicit/solid/input_internal.h"

namespace coppice {
namespace {

using Cubic = std::array<Vec3d, 4>;

constexpr std::size_t kMaxPoints = 1000000;
constexpr int kMaxArcs = 16;          // maximum number per section
constexpr double kDeviation = 0.01;   // [section lengths] maximum deviation of an arc from its chord
constexpr double kCoincident = 1e-9;  // [size of the curve] minimum distance of consecutive points

void check_points(std::span<const Vec3> points, bool closed) {
    const std::size_t least = closed ? 3 : 2, n = points.size();
    if (n < least || n > kMaxPoints)
        throw InvalidInput(fmt::format("curve: {} curve needs {} to {} points, but has {}",
                                       closed ? "a closed" : "an open", least, kMaxPoints, n));
    Box3 box;
    for (std::size_t i = 0; i < n; ++i) {
        for (int axis = 0; axis < 3; ++axis) check_coordinate(points[i][axis], "curve", "point", i);
        box.extend(points[i]);
    }
    const double min_step = kCoincident * box.diagonal();
    for (std::size_t i = 0; i + 1 < n + (closed ? 1 : 0); ++i) {
        const std::size_t j = (i + 1) % n;
        if (!(distance(Vec3d(points[i]), Vec3d(points[j])) > min_step))
            throw InvalidInput(fmt::format("curve: points {} and {} coincide; remove one", i + 1, j + 1));
    }
}

Cubic hermite(Vec3d p, Vec3d q, Vec3d tangent_p, Vec3d tangent_q) {
    return {p, tangent_p, (q - p) * 3.0 - tangent_p * 2.0 - tangent_q, (p - q) * 2.0 + tangent_p + tangent_q};
}

/// Points and the parameter intervals between them: square roots of the distances, which prevents loops in
/// splines through unevenly spaced points.
struct Knots {
    std::vector<Vec3d> point;
    std::vector<double> space;
    bool closed;

    Knots(std::span<const Vec3> points, bool closed_) : point(points.begin(), points.end()), closed(closed_) {
        for (std::size_t i = 0; i < span_count(); ++i)
            space.push_back(std::sqrt(distance(point[i], next(i))));
    }
    std::size_t span_count() const { return point.size() - (closed ? 0 : 1); }
    Vec3d next(std::size_t i) const { return point[(i + 1) % point.size()]; }
    Vec3d slope(std::size_t i) const { return (next(i) - point[i]) / space[i]; }
};

/// Returns the derivatives at the points such that the parabola through each point and its neighbours has
/// them.
std::vector<Vec3d> local_tangents(const Knots& k) {
    const std::size_t n = k.point.size();
    std::vector<Vec3d> m(n);
    for (std::size_t i = 0; i < n; ++i) {
        if (!k.closed && (i == 0 || i + 1 == n)) continue;
        const std::size_t before = (i + n - 1) % n;
        const double h0 = k.space[before], h1 = k.space[i];
        m[i] = (k.slope(before) * h1 + k.slope(i) * h0) / (h0 + h1);
    }
    if (k.closed) return m;
    if (n == 2) return {k.slope(0), k.slope(0)};
    m[0] = k.slope(0) * 1.5 - m[1] * 0.5;
    m[n - 1] = k.slope(n - 2) * 1.5 - m[n - 2] * 0.5;
    return m;
}

/// Solves a diagonally dominant tridiagonal system; overwrites `right`.
void solve(std::span<const double> below, std::vector<double> diagonal, std::span<const double> above,
           std::span<Vec3d> right) {
    const std::size_t n = right.size();
    for (std::size_t i = 1; i < n; ++i) {
        const double f = below[i] / diagonal[i - 1];
        diagonal[i] -= f * above[i - 1];
        right[i] -= right[i - 1] * f;
    }
    right[n - 1] = right[n - 1] / diagonal[n - 1];
    for (std::size_t i = n - 1; i-- > 0;) right[i] = (right[i] - right[i + 1] * above[i]) / diagonal[i];
}

/// Returns the derivatives at the points of the cubic spline with continuous second derivatives.
std::vector<Vec3d> spline_tangents(const Knots& k) {
    const std::size_t n = k.point.size();
    std::vector<double> below(n), diagonal(n), above(n);
    std::vector<Vec3d> m(n);
    for (std::size_t i = 0; i < n; ++i) {
        const bool first = !k.closed && i == 0, last = !k.closed && i + 1 == n;
        const std::size_t before = (i + n - 1) % n;
        if (!first) {
            below[i] = 1 / k.space[before];
            m[i] += k.slope(before) * (3 / k.space[before]);
        }
        if (!last) {
            above[i] = 1 / k.space[i];
            m[i] += k.slope(i) * (3 / k.space[i]);
        }
        diagonal[i] = 2 * (below[i] + above[i]);
    }
    if (!k.closed) {
        solve(below, diagonal, above, m);
        return m;
    }
    // The two corner entries, both c, are a rank-one update of a tridiagonal matrix (Sherman, Morrison).
    const double c = below[0], g = -diagonal[0];
    diagonal[0] -= g;
    diagonal[n - 1] -= c * c / g;
    std::vector<Vec3d> u(n);
    u[0].x = g;
    u[n - 1].x = c;
    solve(below, diagonal, above, m);
    solve(below, diagonal, above, u);
    const double denominator = 1 + u[0].x + u[n - 1].x * (c / g);
    const Vec3d factor = (m[0] + m[n - 1] * (c / g)) / denominator;
    for (std::size_t i = 0; i < n; ++i) m[i] -= factor * u[i].x;
    return m;
}

std::vector<Cubic> find_cubics(const Knots& k, CurveKind kind) {
    std::vector<Vec3d> m;
    if (kind == CurveKind::catmull_rom) m = local_tangents(k);
    if (kind == CurveKind::natural) m = spline_tangents(k);
    std::vector<Cubic> cubics(k.span_count());
    for (std::size_t i = 0; i < cubics.size(); ++i) {
        const Vec3d p = k.point[i], q = k.next(i);
        cubics[i] = m.empty() ? Cubic{p, q - p, {}, {}}
                              : hermite(p, q, m[i] * k.space[i], m[(i + 1) % m.size()] * k.space[i]);
    }
    return cubics;
}

/// Returns the portion of a section from t = a, of length h, as a cubic.
Cubic cut_part(const Cubic& c, double a, double h) {
    return {c[0] + (c[1] + (c[2] + c[3] * a) * a) * a, (c[1] + (c[2] * 2.0 + c[3] * (3.0 * a)) * a) * h,
            (c[2] + c[3] * (3.0 * a)) * (h * h), c[3] * (h * h * h)};
}

double max_second(const Cubic& c) {
    return std::max(length(c[2] * 2.0), length(c[2] * 2.0 + c[3] * 6.0));  // it is linear in t
}

/// Returns the length of the arc up to t: Gauss quadrature with 5 points.
double length_to(const CurveArc& arc, double t) {
    constexpr std::array<double, 5> node{-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                                         0.9061798459386640};
    constexpr std::array<double, 5> weight{0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                           0.4786286704993665, 0.2369268850561891};
    double sum = 0;
    for (std::size_t i = 0; i < node.size(); ++i)
        sum += weight[i] * length(arc.first(0.5 * t * (1 + node[i])));
    return 0.5 * t * sum;
}

Vec3d carried(const CurveArc& arc, Vec3d normal, double t) {
    return carried(normal, arc.c[0], arc.tangent(0), arc.position(t), arc.tangent(t));
}

std::vector<Box3> compute_boxes(std::span<const CurveArc> arcs) {
    std::vector<Box3> boxes(arcs.size());
    for (std::size_t i = 0; i < arcs.size(); ++i) {
        const double s = arcs[i].slack;
        for (const double t : {0.0, 1.0})
            for (const double side : {-s, s})
                extend_outward(boxes[i], arcs[i].position(t) + Vec3d(side, side, side));
    }
    return boxes;
}

double distance_to_chord_squared(const CurveArc& arc, Vec3d p) {
    const Vec3d a = arc.c[0], d = arc.position(1) - a;
    const double t = std::clamp(dot(p - a, d) / std::max(length_squared(d), 1e-300), 0.0, 1.0);
    return length_squared(a + d * t - p);
}

/// Returns the nearest parameter of an arc.
double nearest_on(const CurveArc& arc, Vec3d p) {
    const double g0 = distance_slope(arc, p, 0), g1 = distance_slope(arc, p, 1);
    const double t = local_closest_parameter(arc, p, g0, g1);
    if (t >= 0) return t;
    return length_squared(arc.c[0] - p) <= length_squared(arc.position(1) - p) ? 0 : 1;
}

}  // namespace

double local_closest_parameter(const CurveArc& arc, Vec3d p, double g0, double g1) {
    if (!(g0 < 0 && g1 > 0)) return -1;
    double low = 0, high = 1, t = g0 / (g0 - g1);
    for (int i = 0; i < 60; ++i) {
        const Vec3d from = arc.position(t) - p, first = arc.first(t);
        const double g = dot(from, first), slope = length_squared(first) + dot(from, arc.second(t));
        (g < 0 ? low : high) = t;
        double next = t - g / slope;
        if (!(slope > 0 && next >= low && next <= high)) next = 0.5 * (low + high);
        const double step = std::abs(next - t);
        t = next;
        if (step < 1e-9) break;  // the next step of Newton's method would be below 1e-16
    }
    return t;
}

Curve::Curve(std::span<const Vec3> points, const CurveOptions& options)
    : closed_(options.closed), boxes_({}, Context{.threads = 1}) {
    check_points(points, closed_);
    cut(find_cubics(Knots(points, closed_), options.kind));
    measure();
    carry_frames();
}

void Curve::cut(std::span<const std::array<Vec3d, 4>> cubics) {
    for (const Cubic& cubic : cubics) {
        first_arc_.push_back(static_cast<std::uint32_t>(arcs_.size()));
        const double chord = coppice::length(cubic[1] + cubic[2] + cubic[3]), bend = max_second(cubic);
        const int n =
            std::clamp(static_cast<int>(std::ceil(std::sqrt(bend / (8 * kDeviation * chord)))), 1, kMaxArcs);
        for (int i = 0; i < n; ++i) {
            CurveArc arc{.c = cut_part(cubic, static_cast<double>(i) / n, 1.0 / n)};
            arc.slack = max_second(arc.c) / 8;
            arcs_.push_back(arc);
        }
    }
    first_arc_.push_back(static_cast<std::uint32_t>(arcs_.size()));
    const std::vector<Box3> boxes = compute_boxes(arcs_);
    for (const Box3& b : boxes) bounds_.extend(b);
    boxes_ = BoxTree(boxes, Context{.threads = 1});
}

void Curve::measure() {
    for (CurveArc& arc : arcs_) {
        arc.start = length_;
        arc.length = length_to(arc, 1);
        length_ += arc.length;
    }
}

void Curve::carry_frames() {
    normals_.resize(arcs_.size());
    Vec3d tangent = arcs_[0].tangent(0), normal = perpendicular(tangent);
    for (std::size_t i = 0; i < arcs_.size(); ++i) {
        const Vec3d start = arcs_[i].tangent(0);
        normals_[i] = normal = normalized(turned(normal, tangent, start), perpendicular(start));
        normal = carried(arcs_[i], normal, 1);
        tangent = arcs_[i].tangent(1);
    }
    if (!closed_) return;
    const Vec3d start = arcs_[0].tangent(0), end = turned(normal, tangent, start);
    closing_roll_ = std::atan2(dot(cross(end, normals_[0]), start), dot(end, normals_[0]));
}

CurvePlace Curve::at_fraction(double fraction) const {
    const double s = std::clamp(fraction, 0.0, 1.0) * length_;
    const auto after = std::upper_bound(arcs_.begin(), arcs_.end(), s,
                                        [](double at, const CurveArc& arc) { return at < arc.start; });
    const auto i = static_cast<std::uint32_t>(std::max<std::ptrdiff_t>(after - arcs_.begin() - 1, 0));
    const CurveArc& arc = arcs_[i];
    const double target = std::min(s - arc.start, arc.length);
    double t = target / arc.length;
    for (int k = 0; k < 8; ++k) {
        const double step = (length_to(arc, t) - target) / std::max(coppice::length(arc.first(t)), 1e-300);
        t = std::clamp(t - step, 0.0, 1.0);
        if (std::abs(step) < 1e-12) break;
    }
    return {i, t};
}

CurvePlace Curve::at_index(double index) const {
    const double u = std::clamp(index, 0.0, static_cast<double>(span_count()));
    const std::uint32_t cubic = std::min(static_cast<std::uint32_t>(u), span_count() - 1);
    const std::uint32_t n = first_arc_[cubic + 1] - first_arc_[cubic];
    const double within = (u - cubic) * n;
    const std::uint32_t i = std::min(static_cast<std::uint32_t>(within), n - 1);
    return {first_arc_[cubic] + i, within - i};
}

double Curve::fraction(CurvePlace place) const {
    const CurveArc& arc = arcs_[place.arc];
    return std::min((arc.start + length_to(arc, place.t)) / length_, 1.0);
}

CurveFrame Curve::frame(CurvePlace place) const {
    const CurveArc& arc = arcs_[place.arc];
    const Vec3d tangent = arc.tangent(place.t), n = carried(arc, normals_[place.arc], place.t);
    const Vec3d b = cross(tangent, n);
    if (closing_roll_ == 0) return {arc.position(place.t), tangent, n, b};
    const double roll = closing_roll_ * fraction(place), c = std::cos(roll), s = std::sin(roll);
    return {arc.position(place.t), tangent, n * c + b * s, b * c - n * s};
}

CurvePlace Curve::closest(Vec3d p, CurvePlace hint) const {
    // Slightly greater than the distance to the hint, so that ties are resolved as without it.
    double limit = length_squared(position(hint) - p) * (1 + 1e-9) + 1e-30;
    double best = std::numeric_limits<double>::infinity();
    CurvePlace nearest = hint;
    boxes_.search(
        [&](std::uint32_t level, std::uint32_t i) { return distance_squared(boxes_.level(level)[i], p); },
        limit,
        [&](std::uint32_t i) {
            const CurveArc& arc = arcs_[i];
            const double reach = std::sqrt(limit) + arc.slack;
            if (distance_to_chord_squared(arc, p) > reach * reach) return;
            const double t = nearest_on(arc, p), d = length_squared(arc.position(t) - p);
            if (!(d < best)) return;
            best = d;
            limit = std::min(limit, d);
            nearest = {i, t};
        });
    return nearest;
}

void CurveShape::distance(std::span<const Vec3> points, std::span<FieldSample> out) const {
    CurvePlace place;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3d p(points[i]);
        place = curve_.closest(p, place);
        const Vec3d away = p - curve_.position(place);
        const double d = length(away);
        const Vec3d across = perpendicular(curve_.arcs()[place.arc].tangent(place.t));
        out[i] = {static_cast<float>(d), Vec3(normalized(away, across))};
    }
}

void list_fields(CurveOptions& o, FieldList& list) {
    list.add(Field{"kind", "Interpolation of the curve between its points."}, o.kind);
    list.add(Field{"closed", "Connect the last point to the first by an additional section."}, o.closed);
}

}  // namespace coppice
