#include "coppice/implicit/shape/variational_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/implicit/shape/smoothest_internal.h"
#include "coppice/implicit/solid/input_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kMaxPoints = 1000;
constexpr std::uint32_t kCells = 192;  // number along the longest side of the box
constexpr double kNearest = 1e-3;      // [cells] minimum distance between corners of a contour
constexpr int kMaxSteps = 60;          // maximum number towards the intersection of the curve and an edge

void check_points(std::span<const OrientedPoint> points) {
    if (points.size() < 3 || points.size() > kMaxPoints)
        throw InvalidInput(fmt::format("contour: needs 3 to {} points, but has {}; use fewer or more",
                                       kMaxPoints, points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) {
        check_coordinate(points[i].position.x, "contour", "point", i);
        check_coordinate(points[i].position.y, "contour", "point", i);
        const double l = std::hypot(points[i].normal.x, points[i].normal.y);
        if (!std::isfinite(l) || !(l > 1e-20))
            throw InvalidInput(
                fmt::format("contour: normal {} has no direction; specify a non-zero vector", i + 1));
    }
}

/// The function with the traced zeros, in coordinates where the points' box has size 1 and its centre is the
/// origin: negative inside, positive outside and beyond the margin.
class Plate {
  public:
    Plate(std::span<const Vec3d> points, std::span<const Vec3> normals, const VariationalOptions& options,
          const Context& ctx)
        : f_(smoothest_function(points, normals, options.offset, Bending::in_plane, "contour", ctx)) {
        for (const Vec3d p : points) {
            half_.x = std::max(half_.x, std::abs(p.x));
            half_.y = std::max(half_.y, std::abs(p.y));
        }
        half_ = half_ + Vec2d{1, 1} * static_cast<double>(options.margin);
    }

    Vec2d half() const { return half_; }  ///< half sides of the box at which the area ends

    double operator()(Vec2d p) const {
        const double beyond = std::max(std::abs(p.x) - half_.x, std::abs(p.y) - half_.y);
        const Vec3d q{p.x, p.y, 0};
        double sum = f_.constant + dot(f_.linear, q);
        for (std::size_t i = 0; i < f_.centers.size(); ++i)
            sum += f_.weight[i] * bending_kernel(Bending::in_plane, length_squared(q - f_.centers[i]));
        return std::max(sum, beyond);
    }

  private:
    SmoothestFunction f_;
    Vec2d half_{0, 0};
};

/// Marching squares: finds the sign changes of a function along the edges of a lattice, and their order, with
/// the inside on the left.
class Tracer {
  public:
    Tracer(const Plate& plate, const Context& ctx) : plate_(plate) {
        const Vec2d half = plate.half();
        cell_ = 2 * std::max(half.x, half.y) / kCells;
        // One additional cell on each side, which is outside.
        columns_ = static_cast<std::uint32_t>(std::ceil(2 * half.x / cell_)) + 3;
        rows_ = static_cast<std::uint32_t>(std::ceil(2 * half.y / cell_)) + 3;
        low_ = Vec2d{-0.5 * (columns_ - 1), -0.5 * (rows_ - 1)} * cell_;
        values_.resize(std::size_t{columns_} * rows_);
        parallel_for(ctx, rows_, 4, [&](std::size_t y) {
            if (ctx.stop.stop_requested()) return;
            for (std::uint32_t x = 0; x < columns_; ++x)
                values_[y * columns_ + x] = plate(node(x, static_cast<std::uint32_t>(y)));
        });
        ctx.throw_if_cancelled();
    }

    std::vector<std::vector<Vec2d>> contours() {
        for (std::uint32_t y = 0; y + 1 < rows_; ++y)
            for (std::uint32_t x = 0; x + 1 < columns_; ++x) link_cell(x, y);
        std::vector<std::vector<Vec2d>> out;
        for (const std::uint64_t start : starts_) {
            std::vector<Vec2d> contour;
            for (auto at = next_.find(start); at != next_.end(); at = next_.find(follow(at))) {
                const Vec2d p = crossing(at->first);
                if (contour.empty() || is_apart(p, contour.back())) contour.push_back(p);
            }
            while (contour.size() > 1 && !is_apart(contour.front(), contour.back())) contour.pop_back();
            if (contour.size() > 2) out.push_back(std::move(contour));
        }
        return out;
    }

  private:
    using Links = std::unordered_map<std::uint64_t, std::uint64_t>;

    Vec2d node(std::uint32_t x, std::uint32_t y) const { return low_ + Vec2d{double(x), double(y)} * cell_; }
    bool inside(std::uint32_t x, std::uint32_t y) const { return values_[std::size_t{y} * columns_ + x] < 0; }
    bool is_apart(Vec2d a, Vec2d b) const { return std::hypot(a.x - b.x, a.y - b.y) > kNearest * cell_; }

    /// Returns the index of an edge from a node along x (0) or y (1).
    std::uint64_t edge(std::uint32_t x, std::uint32_t y, std::uint32_t axis) const {
        return 2 * (std::uint64_t{y} * columns_ + x) + axis;
    }

    /// Each intersected edge is left by one of its two cells and entered by the other.
    std::uint64_t follow(Links::iterator at) {
        const std::uint64_t to = at->second;
        next_.erase(at);
        return to;
    }

    void link(std::uint64_t from, std::uint64_t to) {
        next_.emplace(from, to);
        starts_.push_back(from);
    }

    /// Traverses the cell counter-clockwise: a contour enters on the edge where that leaves the inside, and
    /// leaves the cell on the previous edge where the inside began. If two corners are inside on a diagonal,
    /// the centre decides whether they are connected.
    void link_cell(std::uint32_t x, std::uint32_t y) {
        const std::array<bool, 4> in{inside(x, y), inside(x + 1, y), inside(x + 1, y + 1), inside(x, y + 1)};
        const std::array<std::uint64_t, 4> side{edge(x, y, 0), edge(x + 1, y, 1), edge(x, y + 1, 0),
                                                edge(x, y, 1)};
        std::vector<std::size_t> out, back;  // sides on which the traversal leaves and enters the inside
        for (std::size_t k = 0; k < 4; ++k) {
            if (in[k] && !in[(k + 1) % 4]) out.push_back(k);
            if (!in[k] && in[(k + 1) % 4]) back.push_back(k);
        }
        if (out.size() == 1) link(side[out[0]], side[back[0]]);
        if (out.size() < 2) return;
        const bool joined = plate_(node(x, y) + Vec2d{0.5, 0.5} * cell_) < 0;
        for (const std::size_t k : out) link(side[k], side[(k + (joined ? 1 : 3)) % 4]);
    }

    /// Returns the zero of the function on an edge.
    Vec2d crossing(std::uint64_t number) const {
        const auto y = static_cast<std::uint32_t>(number / 2 / columns_),
                   x = static_cast<std::uint32_t>(number / 2 % columns_);
        const bool along_y = number % 2 != 0;
        Vec2d in = node(x, y), out = along_y ? node(x, y + 1) : node(x + 1, y);
        if (!inside(x, y)) std::swap(in, out);
        double low = plate_(in), high = plate_(out);
        for (int i = 0; i < kMaxSteps && is_apart_far(in, out); ++i) {
            // Alternates regula falsi and bisection, so that neither end is kept forever.
            const double t = i % 2 == 0 ? low / (low - high) : 0.5;
            const Vec2d p = in + (out - in) * t;
            const double v = plate_(p);
            (v < 0 ? in : out) = p;
            (v < 0 ? low : high) = v;
        }
        return (in + out) * 0.5;
    }
    bool is_apart_far(Vec2d a, Vec2d b) const { return std::hypot(a.x - b.x, a.y - b.y) > 1e-6 * cell_; }

    const Plate& plate_;
    double cell_;
    std::uint32_t columns_, rows_;
    Vec2d low_{0, 0};
    std::vector<double> values_;
    Links next_;
    std::vector<std::uint64_t> starts_;  ///< in the order of cells
};

}  // namespace

Profile variational_profile(std::span<const OrientedPoint> points, const VariationalOptions& options,
                            const Context& ctx) {
    check_fields(options, "contour");
    check_points(points);
    Vec2d low = points[0].position, high = low;
    for (const OrientedPoint& p : points) {
        low = {std::min(low.x, p.position.x), std::min(low.y, p.position.y)};
        high = {std::max(high.x, p.position.x), std::max(high.y, p.position.y)};
    }
    const Vec2d middle = (low + high) * 0.5;
    const double size = std::hypot(high.x - low.x, high.y - low.y);
    if (!(size > 0)) throw InvalidInput("contour: all points coincide; use points around the area");
    std::vector<Vec3d> scaled;
    std::vector<Vec3> normals;
    for (const OrientedPoint& p : points) {
        const Vec2d q = (p.position - middle) * (1 / size),
                    n = p.normal * (1 / std::hypot(p.normal.x, p.normal.y));
        scaled.push_back({q.x, q.y, 0});
        normals.push_back({static_cast<float>(n.x), static_cast<float>(n.y), 0});
    }
    const Plate plate(scaled, normals, options, ctx);
    auto contours = Tracer(plate, ctx).contours();
    if (contours.empty())
        throw InvalidInput("contour: the normals enclose no area; they must point out of the area");
    for (auto& contour : contours)
        for (Vec2d& p : contour) p = middle + p * size;
    return Profile(contours);
}

std::vector<OrientedPoint> with_normals(std::span<const Vec2d> points) {
    if (points.size() < 3)
        throw InvalidInput(fmt::format("contour: needs 3 points or more, but has {}", points.size()));
    const double turn = contour_area(points) < 0 ? -1 : 1;
    std::vector<OrientedPoint> out;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec2d before = points[(i + points.size() - 1) % points.size()],
                    after = points[(i + 1) % points.size()], chord = after - before;
        if (!(std::hypot(chord.x, chord.y) > 0))
            throw InvalidInput(fmt::format(
                "contour: the neighbours of point {} coincide; specify normals, as x,y,nx,ny", i + 1));
        out.push_back({points[i], Vec2d{chord.y, -chord.x} * turn});
    }
    return out;
}

}  // namespace coppice
