#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/implicit/shape/smoothest_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kMaxNormals = 1000;
constexpr double kCoincident = 1e-6;  // [size] minimum distance of points
constexpr int kMaxHalvings = 12;

struct Constraint {
    Vec3d position;
    double value;
};

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

/// Returns points on the surface, and some next to it: so near to their own points that no other is nearer.
std::vector<Constraint> constraints(std::vector<Constraint> points, std::span<const Vec3> normals,
                                    double offset, const char* subject, const Context& ctx) {
    const std::size_t n = points.size(), normal_count = std::min(n, kMaxNormals);
    std::vector<Neighbour> neighbour(n);
    parallel_for(ctx, n, 64, [&](std::size_t i) { neighbour[i] = nearest(points, points[i].position, i); });
    for (std::size_t i = 0; i < n; ++i)
        if (neighbour[i].distance < kCoincident)
            throw InvalidInput(fmt::format("{}: points {} and {} coincide; remove one", subject,
                                           std::min(i, neighbour[i].index) + 1,
                                           std::max(i, neighbour[i].index) + 1));
    std::vector<Constraint> offset_points(normal_count);
    parallel_for(ctx, normal_count, 64, [&](std::size_t k) {
        const std::size_t i = k * n / normal_count;
        const Vec3d normal = normalized(Vec3d(normals[i]));
        double d = offset;
        for (int halvings = 0; halvings < kMaxHalvings; ++halvings, d *= 0.5)
            if (nearest(points, points[i].position + normal * d, i).distance > d) break;
        offset_points[k] = {points[i].position + normal * d, d};
    });
    points.insert(points.end(), offset_points.begin(), offset_points.end());
    return points;
}

[[noreturn]] void refuse_dense_points(const char* subject) {
    throw InvalidInput(fmt::format(
        "{}: the points are too close together for a smooth surface; use fewer of them", subject));
}

/// Solves a x = b for a symmetric, positive definite a, which becomes its Cholesky factor: by blocks, with a
/// check of the stop token before each.
Eigen::VectorXd solve_positive(Eigen::Ref<Eigen::MatrixXd> a, Eigen::VectorXd b, const char* subject,
                               const Context& ctx) {
    constexpr Eigen::Index kBlock = 64;
    const Eigen::Index n = a.rows();
    for (Eigen::Index k = 0; k < n; k += kBlock) {
        const Eigen::Index size = std::min(kBlock, n - k), rest = n - k - size;
        const auto left = static_cast<float>(n - k) / static_cast<float>(n);
        ctx.throw_if_cancelled();
        ctx.report(1 - left * left * left);
        auto corner = a.block(k, k, size, size), below = a.block(k + size, k, rest, size);
        const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(corner);
        if (factor.info() != Eigen::Success) refuse_dense_points(subject);
        if (rest == 0) break;
        factor.matrixU().solveInPlace<Eigen::OnTheRight>(below);
        a.bottomRightCorner(rest, rest).selfadjointView<Eigen::Lower>().rankUpdate(below, -1);
    }
    a.triangularView<Eigen::Lower>().solveInPlace(b);
    a.triangularView<Eigen::Lower>().adjoint().solveInPlace(b);
    return b;
}

/// Weights are orthogonal to the linear functions: Q of the factorization Q R of these turns the system into
/// one for the remaining unknowns that is positive definite, and is solved in place.
SmoothestFunction solve(std::span<const Constraint> points, Bending bending, const char* subject,
                        const Context& ctx) {
    const auto n = static_cast<Eigen::Index>(points.size());
    const Eigen::Index terms = bending == Bending::in_space ? 4 : 3;  // 1, x, y and in space z
    Eigen::MatrixXd a(n, n), linear(n, terms);
    Eigen::VectorXd f(n);
    parallel_for(ctx, points.size(), 16, [&](std::size_t column) {
        const auto j = static_cast<Eigen::Index>(column);
        const Vec3d p = points[column].position;
        f[j] = points[column].value;
        const Eigen::Vector4d row(1, p.x, p.y, p.z);
        linear.row(j) = row.head(terms);
        for (std::size_t i = 0; i < points.size(); ++i) {
            a(static_cast<Eigen::Index>(i), j) =
                bending_kernel(bending, length_squared(points[i].position - p));
        }
    });
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(linear);
    const auto top = qr.matrixQR().topRows(terms);
    if (!(top.diagonal().cwiseAbs().minCoeff() > 1e-6 * std::sqrt(static_cast<double>(n)))) {
        throw InvalidInput(
            bending == Bending::in_space
                ? fmt::format("{}: all points and normals are in one plane; use points around the solid",
                              subject)
                : fmt::format("{}: all points and normals are on one line; use points around the area",
                              subject));
    }
    ctx.throw_if_cancelled();
    a.applyOnTheLeft(qr.householderQ().adjoint());
    a.applyOnTheRight(qr.householderQ());
    f.applyOnTheLeft(qr.householderQ().adjoint());
    ctx.throw_if_cancelled();

    const Eigen::Index rest = n - terms;
    Eigen::VectorXd y = Eigen::VectorXd::Zero(n);
    y.tail(rest) = solve_positive(a.bottomRightCorner(rest, rest), f.tail(rest), subject, ctx);
    const Eigen::VectorXd constant_and_slopes = top.triangularView<Eigen::Upper>().solve(
        f.head(terms) - a.topRightCorner(terms, rest) * y.tail(rest));
    y.applyOnTheLeft(qr.householderQ());
    if (!y.allFinite() || !constant_and_slopes.allFinite()) refuse_dense_points(subject);
    SmoothestFunction out;
    for (const Constraint& c : points) out.centers.push_back(c.position);
    out.weight.assign(y.begin(), y.end());
    out.constant = constant_and_slopes[0];
    for (int axis = 0; axis + 1 < terms; ++axis) out.linear[axis] = constant_and_slopes[axis + 1];
    return out;
}

}  // namespace

double bending_kernel(Bending bending, double squared) {
    if (bending == Bending::in_space) return squared * std::sqrt(squared);
    return squared > 0 ? 0.5 * squared * std::log(squared) : 0;
}

SmoothestFunction smoothest_function(std::span<const Vec3d> points, std::span<const Vec3> normals,
                                     double offset, Bending bending, const char* subject,
                                     const Context& ctx) {
    std::vector<Constraint> surface;
    for (const Vec3d p : points) surface.push_back({p, 0});
    return solve(constraints(std::move(surface), normals, offset, subject, ctx), bending, subject, ctx);
}

}  // namespace coppice
