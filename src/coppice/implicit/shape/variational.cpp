#include "coppice/implicit/shape/variational.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/check_fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/implicit/shape/smoothest_internal.h"
#include "coppice/implicit/shape/variational_internal.h"
#include "coppice/implicit/solid/input_internal.h"

namespace coppice {
namespace {

void check_input(std::span<const Vec3> points, std::span<const Vec3> normals) {
    const std::size_t n = points.size();
    if (n < 4 || n > Variational::kMaxPoints)
        throw InvalidInput(fmt::format(
            "variational: needs 4 to {} points, but has {}; give fewer, or a triangle mesh instead",
            Variational::kMaxPoints, n));
    if (normals.size() != n)
        throw InvalidInput(fmt::format("variational: each of the {} points needs a normal, but there are {}",
                                       n, normals.size()));
    for (std::size_t i = 0; i < n; ++i) {
        for (int axis = 0; axis < 3; ++axis) check_coordinate(points[i][axis], "variational", "point", i);
        if (!is_finite(normals[i]) || !(length(Vec3d(normals[i])) > 1e-20))
            throw InvalidInput(
                fmt::format("variational: normal {} has no direction; specify a non-zero vector", i + 1));
    }
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
    if (!(size_ > 0)) throw InvalidInput("variational: all points coincide; use points around the solid");
    box_ = box_.inflated(static_cast<float>(options.margin * size_));

    std::vector<Vec3d> scaled;
    for (const Vec3 p : points) scaled.push_back((Vec3d(p) - center_) / size_);
    SmoothestFunction f =
        smoothest_function(scaled, normals, options.offset, Bending::in_space, "variational", ctx);
    for (const Vec3d c : f.centers) {
        x_.push_back(c.x);
        y_.push_back(c.y);
        z_.push_back(c.z);
    }
    weight_ = std::move(f.weight);
    constant_ = f.constant;
    linear_ = f.linear;
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
        // f squared limits the quotient to the size of the box where f has an extremum.
        const double squared = std::max(length_squared(g) + f * f, 1e-300), root = std::sqrt(squared);
        const Vec3d hg{s.xx * g.x + s.xy * g.y + s.xz * g.z, s.xy * g.x + s.yy * g.y + s.yz * g.z,
                       s.xz * g.x + s.yz * g.y + s.zz * g.z};
        const double value = size_ * f / root;
        const Vec3d gradient = g / root - (hg + g * f) * (f / (squared * root));
        out[i] = value >= box.value ? FieldSample{static_cast<float>(value), Vec3(gradient)}
                                    : FieldSample{static_cast<float>(box.value), Vec3(box.gradient)};
    }
}

void list_fields(VariationalOptions& o, FieldList& list) {
    list.add(
        Field{"offset",
              "Distance along the normals at which the value is prescribed, in sizes of the points' box.",
              Unit::none, 1e-4, 0.2},
        o.offset);
    list.add(Field{"margin", "Distance from the points' box at which the solid ends, in sizes of that box.",
                   Unit::none, 0, 1},
             o.margin);
}

}  // namespace coppice
