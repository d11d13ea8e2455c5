#include "coppice/measure/predicates_internal.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace coppice {
namespace {

constexpr double kHalfUlp = std::numeric_limits<double>::epsilon() / 2;

int sign(double x) { return (x > 0) - (x < 0); }

/// A sum without rounding error: components of increasing magnitude with non-overlapping digits.
class ExactSum {
  public:
    void add(double x) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < size_; ++i) {
            const double sum = x + part_[i];
            const double shared = sum - x;
            const double error = (x - (sum - shared)) + (part_[i] - shared);
            if (error != 0) part_[kept++] = error;
            x = sum;
        }
        if (x != 0) part_[kept++] = x;
        size_ = kept;
    }
    /// Adds a * b * c of single precision numbers: a * b is exact in double precision, and the rest is one
    /// error term.
    void add_product(float a, float b, float c) {
        const double ab = static_cast<double>(a) * b;
        const double high = ab * c;
        add(std::fma(ab, static_cast<double>(c), -high));
        add(high);
    }
    int compute_sign() const { return size_ == 0 ? 0 : sign(part_[size_ - 1]); }

  private:
    std::array<double, 48> part_{};
    std::size_t size_ = 0;
};

/// Adds the determinant of the rows a, b, c.
void add_determinant(ExactSum& sum, Vec3 a, Vec3 b, Vec3 c) {
    sum.add_product(a.x, b.y, c.z);
    sum.add_product(-a.x, b.z, c.y);
    sum.add_product(a.y, b.z, c.x);
    sum.add_product(-a.y, b.x, c.z);
    sum.add_product(a.z, b.x, c.y);
    sum.add_product(-a.z, b.y, c.x);
}

int exact_orientation(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    ExactSum sum;
    add_determinant(sum, b, c, d);
    add_determinant(sum, -a, c, d);
    add_determinant(sum, a, b, d);
    add_determinant(sum, -a, b, c);
    return sum.compute_sign();
}

/// Returns the axis along which the triangle can be projected without becoming degenerate.
int flat_axis(const TrianglePoints& t) {
    for (int axis = 0; axis < 2; ++axis) {
        if (orientation_2d(t[0], t[1], t[2], axis) != 0) return axis;
    }
    return 2;
}

bool has_both_signs(int a, int b, int c) { return std::min({a, b, c}) < 0 && std::max({a, b, c}) > 0; }

/// The arguments of the next three functions are coplanar.
bool point_in_triangle(Vec3 p, const TrianglePoints& t, int axis) {
    return !has_both_signs(orientation_2d(t[0], t[1], p, axis), orientation_2d(t[1], t[2], p, axis),
                           orientation_2d(t[2], t[0], p, axis));
}

bool ranges_overlap(float a, float b, float c, float d) {
    return std::max(std::min(a, b), std::min(c, d)) <= std::min(std::max(a, b), std::max(c, d));
}

bool segments_meet(Vec3 a, Vec3 b, Vec3 c, Vec3 d, int axis) {
    const int ac = orientation_2d(a, b, c, axis), ad = orientation_2d(a, b, d, axis);
    const int ca = orientation_2d(c, d, a, axis), cb = orientation_2d(c, d, b, axis);
    if (ac == 0 && ad == 0 && ca == 0 && cb == 0) {
        return ranges_overlap(a.x, b.x, c.x, d.x) && ranges_overlap(a.y, b.y, c.y, d.y) &&
               ranges_overlap(a.z, b.z, c.z, d.z);
    }
    return ac * ad <= 0 && ca * cb <= 0;
}

bool flat_segment_meets(Vec3 p, Vec3 q, const TrianglePoints& t, int axis) {
    return point_in_triangle(p, t, axis) || segments_meet(p, q, t[0], t[1], axis) ||
           segments_meet(p, q, t[1], t[2], axis) || segments_meet(p, q, t[2], t[0], axis);
}

/// `side_p` and `side_q` are the sides of the plane of t on which p and q are.
bool segment_meets(Vec3 p, Vec3 q, int side_p, int side_q, const TrianglePoints& t) {
    if (side_p * side_q > 0) return false;
    if (side_p == 0 && side_q == 0) return flat_segment_meets(p, q, t, flat_axis(t));
    const int a = orientation(p, q, t[0], t[1]), b = orientation(p, q, t[1], t[2]);
    return a * b >= 0 && !has_both_signs(a, b, orientation(p, q, t[2], t[0]));
}

int side(const TrianglePoints& t, Vec3 p) { return orientation(t[0], t[1], t[2], p); }

/// The sides of a plane on which the corners of a triangle are.
struct Sides {
    std::array<int, 3> at;
    Sides(const TrianglePoints& plane, const TrianglePoints& t)
        : at{side(plane, t[0]), side(plane, t[1]), side(plane, t[2])} {}
    bool apart() const { return at[0] != 0 && at[0] == at[1] && at[1] == at[2]; }
    bool flat() const { return at[0] == 0 && at[1] == 0 && at[2] == 0; }
};

bool an_edge_meets(const TrianglePoints& s, const Sides& sides, const TrianglePoints& t) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        if (segment_meets(s[i], s[j], sides.at[i], sides.at[j], t)) return true;
    }
    return false;
}

}  // namespace

int orientation(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    const Vec3d origin(a), p = Vec3d(b) - origin, q = Vec3d(c) - origin, r = Vec3d(d) - origin;
    const double yz = q.y * r.z, zy = q.z * r.y, zx = q.z * r.x, xz = q.x * r.z, xy = q.x * r.y,
                 yx = q.y * r.x;
    const double value = p.x * (yz - zy) + p.y * (zx - xz) + p.z * (xy - yx);
    const double size = std::fabs(p.x) * (std::fabs(yz) + std::fabs(zy)) +
                        std::fabs(p.y) * (std::fabs(zx) + std::fabs(xz)) +
                        std::fabs(p.z) * (std::fabs(xy) + std::fabs(yx));
    const double error = (7 + 56 * kHalfUlp) * kHalfUlp * size;
    if (std::fabs(value) > error || size == 0) return sign(value);
    return exact_orientation(a, b, c, d);
}

int orientation_2d(Vec3 a, Vec3 b, Vec3 c, int axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double au = a[u], av = a[v], bu = b[u], bv = b[v], cu = c[u], cv = c[v];
    const double left = (bu - au) * (cv - av), right = (bv - av) * (cu - au);
    const double error = (3 + 16 * kHalfUlp) * kHalfUlp * (std::fabs(left) + std::fabs(right));
    if (std::fabs(left - right) > error) return sign(left - right);
    ExactSum sum;
    for (const double product : {au * bv, -av * bu, bu * cv, -bv * cu, cu * av, -cv * au}) sum.add(product);
    return sum.compute_sign();
}

bool is_degenerate(const TrianglePoints& t) {
    for (int axis = 0; axis < 3; ++axis) {
        if (orientation_2d(t[0], t[1], t[2], axis) != 0) return false;
    }
    return true;
}

bool triangles_meet(const TrianglePoints& s, const TrianglePoints& t) {
    const Sides s_sides(t, s);
    if (s_sides.apart()) return false;
    if (s_sides.flat()) {
        // If no edges of two coplanar triangles intersect, one may still contain the other.
        return an_edge_meets(s, s_sides, t) || point_in_triangle(t[0], s, flat_axis(s));
    }
    const Sides t_sides(s, t);
    return !t_sides.apart() && (an_edge_meets(s, s_sides, t) || an_edge_meets(t, t_sides, s));
}

bool triangles_meet_beyond_corner(const TrianglePoints& s, const TrianglePoints& t) {
    // A triangle on one side of the other's plane touches it only in the shared corner.
    const int s1 = side(t, s[1]), s2 = side(t, s[2]);
    if (s1 * s2 > 0) return false;
    const int t1 = side(s, t[1]), t2 = side(s, t[2]);
    if (t1 * t2 > 0) return false;
    return segment_meets(s[1], s[2], s1, s2, t) || segment_meets(t[1], t[2], t1, t2, s);
}

bool triangles_overlap_beyond_edge(const TrianglePoints& s, const TrianglePoints& t) {
    if (side(s, t[2]) != 0) return false;
    const int axis = flat_axis(s);
    return orientation_2d(s[0], s[1], s[2], axis) == orientation_2d(s[0], s[1], t[2], axis);
}

}  // namespace coppice
