#include "coppice/implicit/solid/mesh_solid.h"

#include "implicit/shape_support.h"

namespace coppice {
namespace {

using Triangle = MeshSolid::Triangle;

struct Triangles {
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;

    void add(const Triangles& other) {
        const auto first = static_cast<std::uint32_t>(positions.size());
        positions.insert(positions.end(), other.positions.begin(), other.positions.end());
        for (const Triangle& t : other.triangles)
            triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    void turn() {
        for (Triangle& t : triangles) std::swap(t[1], t[2]);
    }
    MeshSolid solid(unsigned threads = 1) const {
        return MeshSolid(positions, triangles, {.threads = threads});
    }
};

Triangles box(Vec3 low, Vec3 high) {
    Triangles m;
    for (int i = 0; i < 8; ++i)
        m.positions.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
    m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return m;
}

Triangles sphere(std::uint32_t rings, float radius) {
    const std::uint32_t around = 2 * rings;
    Triangles m;
    for (std::uint32_t i = 1; i < rings; ++i)
        for (std::uint32_t k = 0; k < around; ++k) {
            const float u = std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(rings);
            const float v = std::numbers::pi_v<float> * static_cast<float>(k) / static_cast<float>(rings);
            m.positions.push_back(radius *
                                  Vec3{std::sin(u) * std::cos(v), std::sin(u) * std::sin(v), std::cos(u)});
        }
    const auto top = static_cast<std::uint32_t>(m.positions.size()), bottom = top + 1;
    m.positions.push_back({0, 0, radius});
    m.positions.push_back({0, 0, -radius});
    for (std::uint32_t k = 0; k < around; ++k) {
        const std::uint32_t l = (k + 1) % around, last = (rings - 2) * around;
        m.triangles.push_back({top, k, l});
        m.triangles.push_back({bottom, last + l, last + k});
        for (std::uint32_t i = 0; i + 2 < rings; ++i) {
            const std::uint32_t a = i * around + k, b = i * around + l;
            m.triangles.push_back({a, a + around, b});
            m.triangles.push_back({b, a + around, b + around});
        }
    }
    return m;
}

TEST(MeshSolid, ComputesTheDistanceToABox) {
    const MeshSolid solid = box({0, 0, 0}, {2, 4, 6}).solid();
    EXPECT_TRUE(solid.is_closed());
    EXPECT_TRUE(solid.is_watertight());
    EXPECT_FLOAT_EQ(at(solid, {1, 2, 3}).value, -1);
    EXPECT_FLOAT_EQ(at(solid, {0.5f, 2, 3}).value, -0.5f);
    EXPECT_LT(length(at(solid, {0.5f, 2, 3}).gradient - Vec3{-1, 0, 0}), 1e-6f);
    EXPECT_FLOAT_EQ(at(solid, {1, 2, 9}).value, 3);
    EXPECT_FLOAT_EQ(at(solid, {4, 7, 12}).value, 7);  // 2, 3 and 6 from the corner
    EXPECT_EQ(at(solid, {2, 1.7f, 3}).value, 0);
    EXPECT_LT(length(at(solid, {2, 1.7f, 3}).gradient - Vec3{1, 0, 0}), 1e-6f);
    EXPECT_EQ(solid.bounds().high, (Vec3{2, 4, 6}));
}

TEST(MeshSolid, WindingNumberMatchesTheSumOverTriangles) {
    const Triangles ball = sphere(40, 1);
    const MeshSolid solid = ball.solid();
    double worst = 0;
    for (const Vec3 p : points_in(solid.bounds(), 3000, 0.2f)) {
        // Sums over all triangles, without dipoles.
        double angle = 0;
        for (const Triangle& t : ball.triangles) {
            const Vec3d a = Vec3d(ball.positions[t[0]] - p), b = Vec3d(ball.positions[t[1]] - p);
            const Vec3d c = Vec3d(ball.positions[t[2]] - p);
            const double la = length(a), lb = length(b), lc = length(c);
            angle += 2 * std::atan2(dot(a, cross(b, c)),
                                    la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
        }
        const double exact = angle / (4 * std::numbers::pi);
        worst = std::max(worst, std::abs(solid.winding(Vec3d(p)) - exact));
        EXPECT_EQ(at(solid, p).value<0, exact> 0.5);
    }
    EXPECT_LT(worst, 0.05);
}

TEST(MeshSolid, ClosesSmallHoles) {
    Triangles ball = sphere(32, 1);
    std::erase_if(ball.triangles, [&](const Triangle& t) {
        const Vec3 p = ball.positions[t[0]];
        return p.z > 0.93f || (p.x > 0.95f && p.y > 0);
    });
    const MeshSolid solid = ball.solid();
    EXPECT_FALSE(solid.is_watertight());
    for (const Vec3 p : points_in(solid.bounds(), 2000, 0.3f)) {
        if (length(p) > 0.8f && length(p) < 1.15f) continue;  // the patches differ from the sphere
        EXPECT_EQ(at(solid, p).value < 0, length(p) < 1) << p.x << ' ' << p.y << ' ' << p.z;
    }
}

TEST(MeshSolid, OverlappingAndNestedPartsAreInside) {
    Triangles both = box({0, 0, 0}, {2, 2, 2});
    both.add(box({1, 0.5f, 0.5f}, {4, 1.5f, 1.5f}));
    const MeshSolid solid = both.solid();
    for (const Vec3 p : {Vec3{0.5f, 1, 1}, {1.5f, 1, 1}, {3, 1, 1}}) EXPECT_LT(at(solid, p).value, 0);
    EXPECT_NEAR(solid.winding({1.5, 1, 1}), 2, 0.05);

    Triangles hollow = box({0, 0, 0}, {4, 4, 4}), hole = box({1, 1, 1}, {3, 3, 3});
    hole.turn();
    hollow.add(hole);
    EXPECT_FLOAT_EQ(at(hollow.solid(), {2, 2, 2}).value, 1);
    EXPECT_FLOAT_EQ(at(hollow.solid(), {2, 2, 0.5f}).value, -0.5f);
}

TEST(MeshSolid, ReversesInsideOutMeshes) {
    Triangles m = box({0, 0, 0}, {2, 2, 2});
    m.turn();
    EXPECT_FLOAT_EQ(at(m.solid(), {1, 1, 1}).value, -1);
    EXPECT_LT(length(at(m.solid(), {2, 0.7f, 1}).gradient - Vec3{1, 0, 0}), 1e-6f);
}

TEST(MeshSolid, TriangleSoupIsWatertight) {
    const Triangles joined = box({0, 0, 0}, {2, 2, 2});
    Triangles soup;
    for (const Triangle& t : joined.triangles) {
        const auto first = static_cast<std::uint32_t>(soup.positions.size());
        for (const std::uint32_t v : t) soup.positions.push_back(joined.positions[v]);
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    EXPECT_TRUE(soup.solid().is_watertight());
    soup.triangles.pop_back();
    EXPECT_FALSE(soup.solid().is_watertight());
}

TEST(MeshSolid, IgnoresDegenerateTriangles) {
    Triangles m = box({0, 0, 0}, {2, 2, 2});
    m.triangles.push_back({0, 0, 1});
    m.triangles.push_back({5, 5, 5});
    EXPECT_TRUE(m.solid().is_watertight());
    EXPECT_FLOAT_EQ(at(m.solid(), {1, 1, 5}).value, 3);
}

TEST(MeshSolid, MatchesTheSphere) {
    const MeshSolid solid = sphere(100, 2).solid();
    for (const Vec3 p : points_in(solid.bounds(), 2000, 0.3f))
        EXPECT_NEAR(at(solid, p).value, length(p) - 2, 2e-3);
    EXPECT_LT(share_of_wrong_gradients(solid, points_in(solid.bounds(), 1000, 0.2f), 1e-3f, 0.03f), 0.05);
    expect_bounds_hold_the_inside(solid);
    expect_survives_strange_points(solid);
    expect_batch_does_not_matter(solid);
}

TEST(MeshSolid, IsBitIdenticalForAnyNumberOfThreads) {
    const Triangles m = sphere(80, 1);
    const MeshSolid one = m.solid(1), seven = m.solid(7);
    const std::vector<Vec3> points = points_in(one.bounds(), 500, 0.2f);
    const auto a = all_at(one, points), b = all_at(seven, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(a[i].value, b[i].value);
        EXPECT_EQ(one.winding(Vec3d(points[i])), seven.winding(Vec3d(points[i])));
    }
}

TEST(MeshSolid, RejectsInvalidMeshes) {
    const auto mesh = [](auto change) {
        Triangles m = box({0, 0, 0}, {1, 1, 1});
        change(m);
        return error_of([&] { m.solid(); });
    };
    EXPECT_NE(mesh([](Triangles& m) { m.triangles.clear(); }).find("enclose nothing"), std::string::npos);
    EXPECT_NE(mesh([](Triangles& m) { m.positions[3].x = kNan; }).find("position 4"), std::string::npos);
    EXPECT_NE(mesh([](Triangles& m) { m.triangles[2][1] = 8; }).find("triangle 3 names position 9"),
              std::string::npos);
    EXPECT_NE(mesh([](Triangles& m) {
                  for (Vec3& p : m.positions) p.z = 0;
              }).find("enclose nothing"),
              std::string::npos);
    EXPECT_NE(error_of([] { MeshSolid({}, {}); }).find("enclose nothing"), std::string::npos);
}

}  // namespace
}  // namespace coppice
