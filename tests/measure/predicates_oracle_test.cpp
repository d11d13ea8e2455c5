// Compares the predicates with CGAL's exact ones, on triangles that often touch, overlap and degenerate.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <gtest/gtest.h>

#include "coppice/base/random.h"
#include "coppice/measure/predicates_internal.h"

namespace coppice {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 exact(Vec3 p) { return {p.x, p.y, p.z}; }
Kernel::Triangle_3 exact(const TrianglePoints& t) { return {exact(t[0]), exact(t[1]), exact(t[2])}; }
Kernel::Segment_3 segment(Vec3 a, Vec3 b) { return {exact(a), exact(b)}; }

/// Points of a small grid, sometimes moved by single ulps, optionally rotated.
class Points {
  public:
    explicit Points(std::uint64_t seed) : random_(seed, 0) {}
    Vec3 next() {
        const auto pick = [&](std::uint64_t n) { return random_.bits(count_++) % n; };
        Vec3 p{coordinate(pick(4)), coordinate(pick(4)), coordinate(pick(4))};
        if (pick(3) == 0) p[static_cast<int>(pick(3))] += (pick(2) == 0 ? 1 : -1) * 0x1p-23f;
        return p;
    }
    TrianglePoints triangle() {
        for (;;) {
            const TrianglePoints t{next(), next(), next()};
            if (!is_degenerate(t)) return t;
        }
    }

  private:
    static float coordinate(std::uint64_t i) { return 0.1f + 0.3f * static_cast<float>(i); }
    CounterRandom random_;
    std::uint64_t count_ = 0;
};

constexpr int kTrials = 40'000;

TEST(PredicatesOracle, OrientationMatchesCgal) {
    Points points(1);
    int zeros = 0;
    for (int i = 0; i < kTrials; ++i) {
        const Vec3 a = points.next(), b = points.next(), c = points.next(), d = points.next();
        const int ours = orientation(a, b, c, d);
        zeros += ours == 0;
        ASSERT_EQ(ours, static_cast<int>(CGAL::orientation(exact(a), exact(b), exact(c), exact(d))));
        ASSERT_EQ(is_degenerate({a, b, c}), exact(TrianglePoints{a, b, c}).is_degenerate());
    }
    EXPECT_GT(zeros, kTrials / 20);
}

TEST(PredicatesOracle, TrianglesMeetMatchesCgal) {
    Points points(2);
    int met = 0;
    for (int i = 0; i < kTrials; ++i) {
        const TrianglePoints s = points.triangle(), t = points.triangle();
        const bool ours = triangles_meet(s, t);
        met += ours;
        ASSERT_EQ(ours, CGAL::do_intersect(exact(s), exact(t))) << "trial " << i;
        ASSERT_EQ(triangles_meet(t, s), ours) << "trial " << i;
    }
    EXPECT_GT(met, kTrials / 10);
    EXPECT_LT(met, kTrials * 9 / 10);
}

TEST(PredicatesOracle, TrianglesMeetInOnePlaneMatchesCgal) {
    Points points(3);
    int met = 0;
    for (int i = 0; i < kTrials; ++i) {
        TrianglePoints s = points.triangle(), t = points.triangle();
        for (int k = 0; k < 3; ++k) s[k].z = t[k].z = i % 2 == 0 ? 0.7f : s[k].x;
        for (int k = 0; k < 3; ++k) t[k].z = i % 2 == 0 ? 0.7f : t[k].x;
        if (is_degenerate(s) || is_degenerate(t)) continue;
        const bool ours = triangles_meet(s, t);
        met += ours;
        ASSERT_EQ(ours, CGAL::do_intersect(exact(s), exact(t))) << "trial " << i;
    }
    EXPECT_GT(met, kTrials / 10);
}

TEST(PredicatesOracle, TrianglesThatShareACornerMatchCgal) {
    Points points(4);
    int met = 0;
    for (int i = 0; i < kTrials; ++i) {
        const TrianglePoints s = points.triangle();
        TrianglePoints t = points.triangle();
        t[0] = s[0];
        if (is_degenerate(t)) continue;
        const bool ours = triangles_meet_beyond_corner(s, t);
        met += ours;
        ASSERT_EQ(ours, CGAL::do_intersect(segment(s[1], s[2]), exact(t)) ||
                            CGAL::do_intersect(segment(t[1], t[2]), exact(s)))
            << "trial " << i;
    }
    EXPECT_GT(met, kTrials / 10);
}

TEST(PredicatesOracle, TrianglesThatShareAnEdgeMatchCgal) {
    Points points(5);
    int met = 0;
    for (int i = 0; i < kTrials; ++i) {
        const TrianglePoints s = points.triangle();
        const TrianglePoints t{s[0], s[1], points.next()};
        if (is_degenerate(t)) continue;
        const bool flat = CGAL::coplanar(exact(s[0]), exact(s[1]), exact(s[2]), exact(t[2]));
        const bool theirs = flat && CGAL::coplanar_orientation(exact(s[0]), exact(s[1]), exact(s[2]),
                                                               exact(t[2])) == CGAL::POSITIVE;
        met += theirs;
        ASSERT_EQ(triangles_overlap_beyond_edge(s, t), theirs) << "trial " << i;
    }
    EXPECT_GT(met, kTrials / 50);
}

}  // namespace
}  // namespace coppice
