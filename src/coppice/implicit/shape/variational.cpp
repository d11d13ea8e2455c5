#include "coppice/implicit/shape/variational.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "coppice/base/check_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/implicit/shape/variational_internal.h"
#include "coppice/implicit/solid/input_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kMostNormals = 1000;
constexpr double kCoincident = 1e-6;  // [size]
constexpr int kMostHalvings = 12;

struct Constraint {
    Vec3d position;
    double value;
};

void check_input(std::span<const Vec3> points, std::span<const Vec3> normals) {
    const std::size_t n = points.size();
    if (n < 4 || n > Variational::kMostPoints)
        throw InvalidInput(fmt::format(
            "variational: needs 4 to {} points, but has {}; give fewer, or a triangle mesh instead",
            Variational::kMostPoints, n));
    if (normals.size() != n)
        throw InvalidInput(fmt::format("variational: each of the {} points needs a normal, but there are {}",
                                       n, normals.size()));
    for (std::size_t i = 0; i < n; ++i) {
        for (int axis = 0; axis < 3; ++axis) check_coordinate(points[i][axis], "variational", "point", i);
        if (!is_finite(normals[i]) || !(length(Vec3d(normals[i])) > 1e-20))
            throw InvalidInput(fmt::format(
                "variational: normal {} has no direction; give a vector that is not zero", i + 1));
    }
}

struct Neighbour {
    std::size_t index = 0;
    double distance = std::numeric_limits<double>::infinity();
};

Neighbour nearest(std::span<const Constraint> points, Vec3d p, std::size_t besides) {
    Neighbour best;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (const double d = length_squared(points[i].position - p); i != besides && d < best.distance)
            best = {i, d};
    best.distance = std::sqrt(best.distance);
    return best;
}

/// Points on the surface, and some beside it: so near to their own points that no other is nearer.
std::vector<Constraint> constraints(std::vector<Constraint> points, std::span<const Vec3> normals,
                                    double offset, const Context& ctx) {
    const std::size_t n = points.size(), normal_count = std::min(n, kMostNormals);
    std::vector<Neighbour> neighbour(n);
    parallel_for(ctx, n, 64, [&](std::size_t i) { neighbour[i] = nearest(points, points[i].position, i); });
    for (std::size_t i = 0; i < n; ++i)
        if (neighbour[i].distance < kCoincident)
            throw InvalidInput(fmt::format("variational: points {} and {} coincide; leave one out",
                                           std::min(i, neighbour[i].index) + 1,
                                           std::max(i, neighbour[i].index) + 1));
    std::vector<Constraint> beside(normal_count);
    parallel_for(ctx, normal_count, 64, [&](std::size_t k) {
        const std::size_t i = k * n / normal_count;
        const Vec3d normal = normalized(Vec3d(normals[i]));
        double d = offset;
        for (int halvings = 0; halvings < kMostHalvings; ++halvings, d *= 0.5)
            if (nearest(points, points[i].position + normal * d, i).distance > d) break;
        beside[k] = {points[i].position + normal * d, d};
    });
    points.insert(points.end(), beside.begin(), beside.end());
    return points;
}

struct Solution {
    Eigen::VectorXd weight;
    Eigen::Vector4d polynomial;  // constant, x, y, z
};

[[noreturn]] void refuse_dense_points() {
    throw InvalidInput(
        "variational: the points lie too close together for a smooth surface; give fewer of them");
}

/// Solves a x = b for a symmetric, positive definite a, which becomes its Cholesky factor: by blocks, with a
/// look at the stop token before each.
Eigen::VectorXd solve_positive(Eigen::Ref<Eigen::MatrixXd> a, Eigen::VectorXd b, const Context& ctx) {
    constexpr Eigen::Index kBlock = 64;
    const Eigen::Index n = a.rows();
    for (Eigen::Index k = 0; k < n; k += kBlock) {
        const Eigen::Index size = std::min(kBlock, n - k), rest = n - k - size;
        const auto left = static_cast<float>(n - k) / static_cast<float>(n);
        ctx.throw_if_cancelled();
        ctx.report(1 - left * left * left);
        auto corner = a.block(k, k, size, size), below = a.block(k + size, k, rest, size);
        const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(corner);
        if (factor.info() != Eigen::Success) refuse_dense_points();
        if (rest == 0) break;
        factor.matrixU().solveInPlace<Eigen::OnTheRight>(below);
        a.bottomRightCorner(rest, rest).selfadjointView<Eigen::Lower>().rankUpdate(below, -1);
    }
    a.triangularView<Eigen::Lower>().solveInPlace(b);
    a.triangularView<Eigen::Lower>().adjoint().solveInPlace(b);
    return b;
}

/// Weights have no part in the polynomials: Q of polynomials = Q R turns the system into one for the
/// remaining n - 4 unknowns that is positive definite, and is solved in place.
Solution solve(std::span<const Constraint> points, const Context& ctx) {
    const auto n = static_cast<Eigen::Index>(points.size());
    Eigen::MatrixXd a(n, n), polynomials(n, 4);
    Eigen::VectorXd f(n);
    parallel_for(ctx, points.size(), 16, [&](std::size_t column) {
        const auto j = static_cast<Eigen::Index>(column);
        const Vec3d p = points[column].position;
        f[j] = points[column].value;
        polynomials.row(j) << 1, p.x, p.y, p.z;
        for (std::size_t row = 0; row < points.size(); ++row) {
            const double r = length(points[row].position - p);
            a(static_cast<Eigen::Index>(row), j) = r * r * r;
        }
    });
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(polynomials);
    const auto r = qr.matrixQR().topRows<4>().triangularView<Eigen::Upper>();
    const double flattest = qr.matrixQR().topRows<4>().diagonal().cwiseAbs().minCoeff();
    if (!(flattest > 1e-6 * std::sqrt(static_cast<double>(n))))
        throw InvalidInput(
            "variational: all points and normals lie in one plane; give points around the solid");
    ctx.throw_if_cancelled();
    a.applyOnTheLeft(qr.householderQ().adjoint());
    a.applyOnTheRight(qr.householderQ());
    f.applyOnTheLeft(qr.householderQ().adjoint());
    ctx.throw_if_cancelled();

    Eigen::VectorXd y = Eigen::VectorXd::Zero(n);
    y.tail(n - 4) = solve_positive(a.bottomRightCorner(n - 4, n - 4), f.tail(n - 4), ctx);
    Solution s;
    s.polynomial = r.solve(f.head<4>() - a.topRightCorner(4, n - 4) * y.tail(n - 4));
    y.applyOnTheLeft(qr.householderQ());
    s.weight = std::move(y);
    if (!s.weight.allFinite() || !s.polynomial.allFinite()) refuse_dense_points();
    return s;
}

/// Signed distance to a box, and its gradient.
struct BoxSample {
    double value;
    Vec3d gradient;
};

BoxSample box_sample(const Box3& box, Vec3d p) {
    Vec3d outside;
    double depth = -std::numeric_limits<double>::infinity();
    Vec3d face;
    for (int axis = 0; axis < 3; ++axis) {
        const double below = box.low[axis] - p[axis], above = p[axis] - box.high[axis];
        const double d = std::max(below, above), sign = below > above ? -1 : 1;
        if (d > 0) outside[axis] = sign * d;
        if (!(d > depth)) continue;
        depth = d;
        face = {};
        face[axis] = sign;
    }
    const double d = length(outside);
    return d > 0 ? BoxSample{d, outside / d} : BoxSample{depth, face};
}

}  // namespace

Variational::Variational(std::span<const Vec3> points, std::span<const Vec3> normals,
                         const VariationalOptions& options, const Context& ctx) {
    check_fields(options, "variational");
    check_input(points, normals);
    for (const Vec3 p : points) box_.extend(p);
    center_ = Vec3d(box_.center());
    size_ = box_.diagonal();
    if (!(size_ > 0)) throw InvalidInput("variational: all points coincide; give points around the solid");
    box_ = box_.inflated(static_cast<float>(options.margin * size_));

    std::vector<Constraint> surface;
    for (const Vec3 p : points) surface.push_back({(Vec3d(p) - center_) / size_, 0});
    const std::vector<Constraint> all = constraints(std::move(surface), normals, options.offset, ctx);
    const Solution solution = solve(all, ctx);
    for (const Constraint& c : all) {
        x_.push_back(c.position.x);
        y_.push_back(c.position.y);
        z_.push_back(c.position.z);
    }
    weight_.assign(solution.weight.begin(), solution.weight.end());
    constant_ = solution.polynomial[0];
    linear_ = {solution.polynomial[1], solution.polynomial[2], solution.polynomial[3]};
}

void Variational::distance(std::span<const Vec3> points, std::span<FieldSample> out) const {
    const CubeCenters centers{x_, y_, z_, weight_};
    for (std::size_t i = 0; i < points.size(); ++i) {
        const BoxSample box = box_sample(box_, Vec3d(points[i]));
        if (!is_finite(points[i])) {
            out[i] = {std::numeric_limits<float>::infinity(), {}};
            continue;
        }
        if (box.value >= 0) {
            out[i] = {static_cast<float>(box.value), Vec3(box.gradient)};
            continue;
        }
        const Vec3d p = (Vec3d(points[i]) - center_) / size_;
        const CubeSums s = sum_cubes(centers, p);
        const double f = s.value + dot(linear_, p) + constant_;
        const Vec3d g = s.gradient + linear_;
        // f squared keeps the quotient below the size of the box where f has an extremum.
        const double squared = std::max(length_squared(g) + f * f, 1e-300), root = std::sqrt(squared);
        const Vec3d hg{s.xx * g.x + s.xy * g.y + s.xz * g.z, s.xy * g.x + s.yy * g.y + s.yz * g.z,
                       s.xz * g.x + s.yz * g.y + s.zz * g.z};
        const double value = size_ * f / root;
        const Vec3d gradient = g / root - (hg + g * f) * (f / (squared * root));
        out[i] = value >= box.value ? FieldSample{static_cast<float>(value), Vec3(gradient)}
                                    : FieldSample{static_cast<float>(box.value), Vec3(box.gradient)};
    }
}

}  // namespace coppice
