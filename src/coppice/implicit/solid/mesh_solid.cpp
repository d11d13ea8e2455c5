#include "coppice/implicit/solid/mesh_solid.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"
#include "coppice/implicit/solid/input_internal.h"
#include "coppice/mesh/half_edges.h"

namespace coppice {
namespace {

constexpr std::size_t kMaxTriangles = 100'000'000;
constexpr std::size_t kGrain = 1 << 13;
constexpr double kFar = 2.5;  // [radii] distance from which a portion of the mesh is approximated by a dipole

/// Returns the point of a triangle nearest to p: by the regions of its corners and edges [Ericson2005].
Vec3d nearest_on(Vec3d p, Vec3d a, Vec3d b, Vec3d c) {
    const Vec3d ab = b - a, ac = c - a, ap = p - a;
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const Vec3d bp = p - b;
    const double d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
    const Vec3d cp = p - c;
    const double d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    const double sum = va + vb + vc;
    return sum > 0 ? a + ab * (vb / sum) + ac * (vc / sum) : a;
}

/// Sums half the solid angles of triangles seen from the origin, each the angle of a complex number
/// [VanOosterom1983]. Numbers are multiplied as long as the angle of the product cannot exceed pi, which
/// saves most arc tangents.
class HalfAngles {
  public:
    void add(Vec3d a, Vec3d b, Vec3d c) {
        const double la = length(a), lb = length(b), lc = length(c);
        const double re = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
        const double im = dot(a, cross(b, c));
        if (!(re > 0)) {
            if (re != 0 || im != 0) sum_ += std::atan2(im, re);
            return;
        }
        const double scale = 1 / (re + std::abs(im));
        multiply(re * scale, im * scale);
        if (!(re_ > 0)) flush();
    }
    double sum() {
        flush();
        return sum_;
    }

  private:
    void multiply(double re, double im) {
        const double r = re_ * re - im_ * im;
        im_ = re_ * im + im_ * re;
        re_ = r;
    }
    void flush() {
        sum_ += std::atan2(im_, re_);
        re_ = 1;
        im_ = 0;
    }

    double re_ = 1, im_ = 0, sum_ = 0;
};

Vec3d area_vector(Vec3d a, Vec3d b, Vec3d c) { return cross(b - a, c - a) * 0.5; }

/// Returns whether every edge occurs equally often in both directions, so that the mesh has no border.
bool has_no_border(std::span<const Triangle> triangles, std::span<const std::uint32_t> number,
                   const Context& ctx) {
    Buffer<Triangle> welded(triangles.size());
    for (std::size_t i = 0; i < welded.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) welded[i][k] = number[triangles[i][k]];
    const HalfEdges edges(welded, static_cast<std::uint32_t>(number.size()), ctx);
    for (std::uint32_t e = 0; e < edges.edge_count(); ++e) {
        const auto [low, high] = edges.ends(e);
        const auto halves = edges.halves(e);
        const auto backward = std::ranges::count_if(halves, [&](auto h) { return edges.is_backward(h); });
        if (low != high && 2 * backward != std::ssize(halves)) return false;
    }
    return true;
}

/// Returns indices of positions such that equal positions have equal indices.
std::vector<std::uint32_t> welded(std::span<const Vec3> positions, const Context& ctx) {
    Buffer<std::uint32_t> order(positions.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    // Any order that makes equal positions consecutive is sufficient; + 0.0f, because -0 and 0 are equal.
    for (int axis = 0; axis < 3; ++axis) {
        radix_sort(ctx, order, 32,
                   [&](std::uint32_t i) { return std::bit_cast<std::uint32_t>(positions[i][axis] + 0.0f); });
    }
    std::vector<std::uint32_t> number(positions.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
        const bool again = k > 0 && positions[order[k]] == positions[order[k - 1]];
        number[order[k]] = again ? number[order[k - 1]] : order[k];
    }
    return number;
}

void check_mesh(std::span<const Vec3> positions, std::span<const MeshSolid::Triangle> triangles) {
    for (std::size_t i = 0; i < positions.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            check_coordinate(positions[i][axis], "mesh solid", "position", i);
    if (triangles.size() > kMaxTriangles)
        throw InvalidInput(fmt::format("mesh solid: {} triangles exceed the maximum of {}; simplify the mesh",
                                       triangles.size(), kMaxTriangles));
    for (std::size_t i = 0; i < triangles.size(); ++i)
        for (const std::uint32_t v : triangles[i])
            if (v >= positions.size())
                throw InvalidInput(fmt::format("mesh solid: triangle {} names position {}, but there are {}",
                                               i + 1, std::uint64_t{v} + 1, positions.size()));
}

}  // namespace

MeshSolid::MeshSolid(std::span<const Vec3> positions, std::span<const Triangle> triangles, const Context& ctx)
    : boxes_({}, ctx) {
    check_mesh(positions, triangles);
    std::vector<Box3> boxes;
    std::vector<Corners> corners;
    for (const Triangle& t : triangles) {
        const Corners c{positions[t[0]], positions[t[1]], positions[t[2]]};
        if (length_squared(area_vector(Vec3d(c.a), Vec3d(c.b), Vec3d(c.c))) == 0) continue;
        Box3 box;
        for (const Vec3 p : {c.a, c.b, c.c}) box.extend(p);
        boxes.push_back(box);
        bounds_.extend(box);
        corners.push_back(c);
    }
    const Vec3d middle = corners.empty() ? Vec3d{} : Vec3d(bounds_.center());
    double volume = 0, area = 0;
    for (const Corners& c : corners) {
        const Vec3d n = area_vector(Vec3d(c.a), Vec3d(c.b), Vec3d(c.c));
        volume += dot(Vec3d(c.a) - middle, n) / 3;
        area += length(n);
    }
    if (!(std::abs(volume) > 1e-9 * area * bounds_.diagonal()))
        throw InvalidInput(
            "mesh solid: the triangles enclose nothing; use a closed mesh with consistently oriented "
            "triangles");
    orientation_ = volume < 0 ? -1 : 1;
    watertight_ = has_no_border(triangles, welded(positions, ctx), ctx);

    // In the order of the tree, triangles that are visited together are adjacent in memory.
    const BoxTree tree(boxes, ctx);
    triangles_.resize(corners.size());
    std::vector<Box3> sorted(corners.size());
    for (std::uint32_t place = 0; place < tree.size(); ++place) {
        triangles_[place] = corners[tree.item(place)];
        sorted[place] = boxes[tree.item(place)];
    }
    boxes_ = BoxTree(sorted, ctx);
    for (std::uint32_t place = 0; place < boxes_.size(); ++place) COPPICE_ASSERT(boxes_.item(place) == place);
    build_dipoles(ctx);
}

void MeshSolid::build_dipoles(const Context& ctx) {
    struct Moments {
        Vec3d moment, weighted;
        double area = 0;
    };
    std::vector<Moments> below(triangles_.size());
    parallel_for(ctx, below.size(), kGrain, [&](std::size_t i) {
        const Vec3d a(triangles_[i].a), b(triangles_[i].b), c(triangles_[i].c);
        Moments& part = below[i];
        part.moment = area_vector(a, b, c);
        part.area = length(part.moment);
        part.weighted = (a + b + c) * (part.area / 3);
    });
    for (std::uint32_t level = 1; level < boxes_.level_count(); ++level) {
        const std::span<const Box3> boxes = boxes_.level(level);
        std::vector<Moments> parts(boxes.size());
        std::vector<Dipole> dipoles(boxes.size());
        parallel_for(ctx, boxes.size(), kGrain, [&](std::size_t i) {
            Moments& sum = parts[i];
            const std::size_t end = std::min<std::size_t>(BoxTree::kWidth * (i + 1), below.size());
            for (std::size_t k = BoxTree::kWidth * i; k < end; ++k) {
                sum.moment += below[k].moment;
                sum.weighted += below[k].weighted;
                sum.area += below[k].area;
            }
            const Vec3d center = sum.weighted / std::max(sum.area, 1e-300);
            Vec3d most;
            for (int axis = 0; axis < 3; ++axis)
                most[axis] = std::max(boxes[i].high[axis] - center[axis], center[axis] - boxes[i].low[axis]);
            dipoles[i] = {Vec3(center), static_cast<float>(length(most)), Vec3(sum.moment)};
        });
        dipoles_.push_back(std::move(dipoles));
        below = std::move(parts);
    }
}

double MeshSolid::winding_of_triangles(std::uint32_t first, std::uint32_t end, Vec3d p) const {
    double sum = 0;
    HalfAngles near;
    for (std::uint32_t i = first; i < end; ++i) {
        const Vec3d a = Vec3d(triangles_[i].a) - p, b = Vec3d(triangles_[i].b) - p,
                    c = Vec3d(triangles_[i].c) - p;
        const Vec3d v = (a + b + c) / 3.0;
        const double squared = length_squared(v);
        const double radius = std::max({length_squared(a - v), length_squared(b - v), length_squared(c - v)});
        if (squared > kFar * kFar * radius) {
            sum += dot(v, area_vector(a, b, c)) / (squared * std::sqrt(squared));
        } else {
            near.add(a, b, c);
        }
    }
    return sum + 2 * near.sum();
}

double MeshSolid::winding_below(std::uint32_t level, std::uint32_t parent, Vec3d p) const {
    const auto count = static_cast<std::uint32_t>(boxes_.level(level).size());
    const std::uint32_t first = BoxTree::kWidth * parent, end = std::min(first + BoxTree::kWidth, count);
    if (level == 0) return winding_of_triangles(first, end, p);
    double sum = 0;
    for (std::uint32_t i = first; i < end; ++i) {
        const Dipole& part = dipoles_[level - 1][i];
        const Vec3d v = Vec3d(part.center) - p;
        const double squared = length_squared(v), far = kFar * part.radius;
        sum += squared > far * far ? dot(v, Vec3d(part.moment)) / (squared * std::sqrt(squared))
                                   : winding_below(level - 1, i, p);
    }
    return sum;
}

double MeshSolid::winding(Vec3d p) const {
    return orientation_ * winding_below(boxes_.level_count() - 1, 0, p) / (4 * std::numbers::pi);
}

MeshSolid::Nearest MeshSolid::nearest(Vec3d p, std::uint32_t hint) const {
    const auto get_point = [&](std::uint32_t i) {
        return nearest_on(p, Vec3d(triangles_[i].a), Vec3d(triangles_[i].b), Vec3d(triangles_[i].c));
    };
    // Slightly greater than the distance to the hint, so that ties are resolved as without it.
    double limit = length_squared(get_point(hint) - p) * (1 + 1e-9) + 1e-30;
    Nearest best{hint, std::numeric_limits<double>::infinity(), {}};
    boxes_.search([&](std::uint32_t l, std::uint32_t i) { return distance_squared(boxes_.level(l)[i], p); },
                  limit,
                  [&](std::uint32_t i) {
                      const Vec3d point = get_point(i);
                      const double d = length_squared(point - p);
                      if (!(d < best.squared)) return;
                      best = {i, d, point};
                      limit = std::min(limit, d);
                  });
    return best;
}

void MeshSolid::distance(std::span<const Vec3> points, std::span<FieldSample> out) const {
    std::uint32_t hint = 0;
    // Points closer to `center` than the surface are on the same side, because the mesh has no border.
    struct {
        Vec3d center;
        double radius = -1;
        bool inside = false;
    } ball;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3d p(points[i]);
        const Nearest n = nearest(p, hint);
        if (!std::isfinite(n.squared)) {
            out[i] = {std::numeric_limits<float>::infinity(), {}};
            continue;
        }
        hint = n.triangle;
        const double d = std::sqrt(n.squared);
        bool inside = false;
        if (watertight_ && length(p - ball.center) < 0.999 * ball.radius) {
            inside = ball.inside;
        } else if (distance_squared(bounds_, p) == 0) {
            inside = winding(p) > 0.5;
            ball = {p, d, inside};
        }
        const double sign = inside ? -1 : 1;
        const Corners& t = triangles_[n.triangle];
        const Vec3d outward = area_vector(Vec3d(t.a), Vec3d(t.b), Vec3d(t.c)) * orientation_;
        const Vec3d gradient = d > 0 ? (p - n.point) * (sign / d) : normalized(outward);
        out[i] = {static_cast<float>(sign * d), Vec3(gradient)};
    }
}

}  // namespace coppice
