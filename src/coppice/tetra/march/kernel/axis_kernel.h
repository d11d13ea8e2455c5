#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/kernel/host_device.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/base/vec.h"
#include "coppice/skeleton/skeleton.h"
#include "coppice/tetra/lattice/shape_kernel.h"

// Finds the fine vertices that hold an axis: those with the maximum of the four weights at some point of it.

namespace coppice::tetra_kernel {

/// Barycentric coordinates.
using Weights = std::array<double, 4>;

/// Weights this far below a bound count as equal to it: rounding may add a vertex, but never omits one.
inline constexpr double kWeightSlack = 1e-6;

/// The part of a line, from 0 to 1, in which linear functions are not negative.
struct LineRange {
    double from = 0;  ///< start
    double to = 1;    ///< end; less than `from` if the part is empty

    /// Restricts the part to where one more function is not negative.
    COPPICE_HOST_DEVICE void clip(double at_start, double at_end) {
        at_start += kWeightSlack;
        at_end += kWeightSlack;
        if (at_start < 0 && at_end < 0) {
            to = -1;
        } else if (at_start < 0) {
            from = std::max(from, at_start / (at_start - at_end));
        } else if (at_end < 0) {
            to = std::min(to, at_start / (at_start - at_end));
        }
    }
    /// Returns whether the part is empty.
    COPPICE_HOST_DEVICE bool empty() const { return from > to; }
};

/// The weights (barycentric coordinates) in a tetrahedron as linear functions of space.
class WeightFunctions {
  public:
    /// Requires a tetrahedron with positive volume.
    COPPICE_HOST_DEVICE explicit WeightFunctions(const Corners& p) : origin_(p[0]) {
        const Vec3d x = p[1] - p[0], y = p[2] - p[0], z = p[3] - p[0];
        const double volume = dot(cross(x, y), z);
        slope_[0] = cross(y, z) / volume;
        slope_[1] = cross(z, x) / volume;
        slope_[2] = cross(x, y) / volume;
    }
    /// Returns the weights of a point.
    COPPICE_HOST_DEVICE Weights at(Vec3d p) const {
        const Vec3d w = p - origin_;
        const double x = dot(slope_[0], w), y = dot(slope_[1], w), z = dot(slope_[2], w);
        return {1 - x - y - z, x, y, z};
    }

  private:
    Vec3d origin_;
    std::array<Vec3d, 3> slope_;
};

/// Returns the part of the line between two points that is inside the tetrahedron.
COPPICE_HOST_DEVICE inline LineRange part_within(const Weights& start, const Weights& end) {
    LineRange out;
    for (std::size_t i = 0; i < 4; ++i) {
        // Usually the line misses the tetrahedron, which can be detected without a division.
        if (start[i] < -kWeightSlack && end[i] < -kWeightSlack) return {1, 0};
    }
    for (std::size_t i = 0; i < 4; ++i) out.clip(start[i], end[i]);
    return out;
}

/// Interpolates weights.
COPPICE_HOST_DEVICE inline Weights weights_between(const Weights& a, const Weights& b, double part) {
    Weights out{};
    for (std::size_t i = 0; i < 4; ++i) out[i] = std::clamp(a[i] + (b[i] - a[i]) * part, 0.0, 1.0);
    return out;
}

/// Iterates over the parameters at which a number that changes linearly from `start` to `start` + `change` is
/// an integer.
class WholePlaces {
  public:
    /// Starts at parameter 0, which is itself excluded.
    COPPICE_HOST_DEVICE WholePlaces(double start, double change)
        : start_(start),
          change_(change),
          next_(change > 0 ? std::ceil(start) : std::floor(start)),
          last_(change > 0 ? std::floor(start + change) : std::ceil(start + change)) {}

    /// Returns the first such parameter after `place`, or 1. Requires ascending calls.
    COPPICE_HOST_DEVICE double beyond(double place) {
        if (change_ == 0) return 1;
        const double step = change_ > 0 ? 1 : -1;
        for (; (last_ - next_) * step >= 0; next_ += step) {
            const double t = (next_ - start_) / change_;
            if (t > place) return std::min(t, 1.0);
        }
        return 1;
    }

  private:
    double start_, change_, next_, last_;
};

/// The fine tetrahedra that a line passes in one coarse tetrahedron with corners along a path of edges around
/// the diagonal: in coordinates along these edges, x >= y >= z from 0 to n, they are the cells between the
/// planes on which a coordinate, or the difference of two, is an integer [Freudenthal1942].
struct FineLine {
    int n;                                 ///< 2^levels
    std::array<std::uint8_t, 4> path;      ///< corners
    std::span<const std::uint16_t> local;  ///< fine vertices, indexed by place()

    /// Returns the index in `local`, of (n + 1)^3, of the fine vertex with these coordinates.
    COPPICE_HOST_DEVICE std::size_t place(const std::array<int, 3>& p) const {
        const auto side = static_cast<std::size_t>(n) + 1;
        return (static_cast<std::size_t>(p[0]) * side + static_cast<std::size_t>(p[1])) * side +
               static_cast<std::size_t>(p[2]);
    }

    /// Calls use(vertex) for the vertices with the maximum weight somewhere between two points, which must be
    /// inside.
    template <class Use>
    COPPICE_HOST_DEVICE void visit_maximum(const Weights& start, const Weights& end, const Use& use) const {
        const Vec3d from = along_path(start), way = along_path(end) - from;
        WholePlaces x(from.x, way.x), y(from.y, way.y), z(from.z, way.z);
        WholePlaces xy(from.x - from.y, way.x - way.y), yz(from.y - from.z, way.y - way.z),
            xz(from.x - from.z, way.x - way.z);
        for (double stop = 0; stop < 1;) {
            const double next =
                std::min(std::min(std::min(x.beyond(stop), y.beyond(stop)), z.beyond(stop)),
                         std::min(std::min(xy.beyond(stop), yz.beyond(stop)), xz.beyond(stop)));
            visit_piece(from + way * stop, from + way * next, use);
            stop = next;
        }
    }

  private:
    COPPICE_HOST_DEVICE Vec3d along_path(const Weights& w) const {
        const double z = n * w[path[3]], y = z + n * w[path[2]];
        return {y + n * w[path[1]], y, z};
    }

    /// Visits the section between two points of one fine tetrahedron, which contains their midpoint.
    template <class Use>
    COPPICE_HOST_DEVICE void visit_piece(Vec3d a, Vec3d b, const Use& use) const {
        const Vec3d middle = 0.5 * (a + b);
        std::array<int, 3> corner{};
        std::array<double, 3> rest{};
        for (int axis = 0; axis < 3; ++axis) {
            // Coordinates decrease along the path and stay below n, except for rounding.
            const int most = axis == 0 ? n - 1 : corner[static_cast<std::size_t>(axis) - 1];
            const int whole = std::clamp(static_cast<int>(std::floor(middle[axis])), 0, most);
            corner[static_cast<std::size_t>(axis)] = whole;
            rest[static_cast<std::size_t>(axis)] = middle[axis] - whole;
        }
        const std::array<int, 3> order = descending(rest);
        std::array<std::uint16_t, 4> vertex{local[place(corner)]};
        Weights at_a{}, at_b{};
        double left_a = 1, left_b = 1;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto axis = static_cast<std::size_t>(order[i]);
            const double next_a = a[order[i]] - corner[axis], next_b = b[order[i]] - corner[axis];
            at_a[i] = left_a - next_a;
            at_b[i] = left_b - next_b;
            left_a = next_a;
            left_b = next_b;
        }
        at_a[3] = left_a;
        at_b[3] = left_b;
        for (std::size_t i = 0; i < 3; ++i) {
            ++corner[static_cast<std::size_t>(order[i])];
            vertex[i + 1] = local[place(corner)];
        }
        for (std::size_t i = 0; i < 4; ++i) {
            LineRange largest;
            for (std::size_t j = 0; j < 4; ++j) {
                if (j != i) largest.clip(at_a[i] - at_a[j], at_b[i] - at_b[j]);
            }
            if (!largest.empty()) use(vertex[i]);
        }
    }

    /// Returns the axes in descending order of the remainder; for equal ones the first axis comes first,
    /// which stays inside.
    COPPICE_HOST_DEVICE static std::array<int, 3> descending(const std::array<double, 3>& rest) {
        std::array<int, 3> order{0, 1, 2};
        const auto put_first = [&](std::size_t i, std::size_t j) {
            if (!(rest[static_cast<std::size_t>(order[j])] > rest[static_cast<std::size_t>(order[i])]))
                return;
            const int first = order[j];
            order[j] = order[i];
            order[i] = first;
        };
        put_first(0, 1);
        put_first(1, 2);
        put_first(0, 1);
        return order;
    }
};

/// A FineLine with its array.
class FineLineTable {
  public:
    /// Creates the table of the pattern along a diagonal.
    FineLineTable(const TetraPattern& pattern, std::uint32_t diagonal) {
        const auto ends = diagonal_corners(diagonal);
        line_ = {1, {ends[0], ends[2], ends[1], ends[3]}, {}};
        for (const std::uint8_t w : pattern.weights[0]) line_.n = std::max(line_.n, int{w});
        const auto side = static_cast<std::size_t>(line_.n) + 1;
        local_.resize(side * side * side);
        for (std::size_t v = 0; v < pattern.weights.size(); ++v) {
            const auto& w = pattern.weights[v];
            const int z = w[line_.path[3]], y = z + w[line_.path[2]], x = y + w[line_.path[1]];
            local_[line_.place({x, y, z})] = static_cast<std::uint16_t>(v);
        }
    }
    /// Returns a view that is valid as long as this object.
    FineLine line() const { return {line_.n, line_.path, local_}; }

  private:
    FineLine line_{};
    std::vector<std::uint16_t> local_;
};

/// An axis as a line.
struct AxisLine {
    Vec3d a;         ///< [m] start
    Vec3d along;     ///< [m] vector to its end
    double inverse;  ///< [1/m^2] inverse of the squared length; 0 for a point

    /// Creates the line of an axis.
    COPPICE_HOST_DEVICE explicit AxisLine(const Segment& axis) : a(axis.a), along(Vec3d(axis.b) - a) {
        const double squared = length_squared(along);
        inverse = squared > 0 ? 1 / squared : 0;
    }
};

/// A coarse tetrahedron for queries by axes that may pass through it; tests its bounding ball first.
class HeldTetra {
  public:
    /// Computes the ball around these corners.
    COPPICE_HOST_DEVICE explicit HeldTetra(const Corners& p)
        : middle_(0.25 * (p[0] + p[1] + p[2] + p[3])), reach_squared_(0) {
        for (std::size_t i = 0; i < 4; ++i)
            reach_squared_ = std::max(reach_squared_, length_squared(p[i] - middle_));
        reach_squared_ *= 1 + kWeightSlack;
    }
    /// Returns whether an axis intersects the ball.
    COPPICE_HOST_DEVICE bool is_near(const AxisLine& axis) const {
        const Vec3d w = middle_ - axis.a;
        const double t = std::clamp(dot(w, axis.along) * axis.inverse, 0.0, 1.0);
        return length_squared(w - axis.along * t) <= reach_squared_;
    }

  private:
    Vec3d middle_;
    double reach_squared_;
};

/// Calls use(fine vertex) for the vertices of a coarse tetrahedron that hold an axis; may repeat vertices.
template <class Use>
COPPICE_HOST_DEVICE void visit_held(const WeightFunctions& weights, const FineLine& line, const Segment& axis,
                                    const Use& use) {
    const Weights start = weights.at(Vec3d(axis.a)), end = weights.at(Vec3d(axis.b));
    const LineRange part = part_within(start, end);
    if (part.empty()) return;
    line.visit_maximum(weights_between(start, end, part.from), weights_between(start, end, part.to), use);
}

/// [m^2] Returns the squared distance from a point to the closest point of an axis.
COPPICE_HOST_DEVICE inline double squared_distance(const Segment& axis, Vec3d p) {
    const Vec3d a(axis.a), along = Vec3d(axis.b) - a;
    return length_squared(a + along * closest_parameter(p, a, along) - p);
}

}  // namespace coppice::tetra_kernel
