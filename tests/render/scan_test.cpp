#include "coppice/render/scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace coppice {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

PolygonMesh joined(const PolygonMesh& a, const PolygonMesh& b) {
    PolygonMesh m = a;
    const auto first = static_cast<std::uint32_t>(a.positions.size());
    m.positions.insert(m.positions.end(), b.positions.begin(), b.positions.end());
    for (std::uint32_t f = 0; f < b.face_count(); ++f) {
        std::vector<std::uint32_t> face(b.face(f).begin(), b.face(f).end());
        for (std::uint32_t& v : face) v += first;
        m.add_face(face);
    }
    return m;
}

PolygonMesh box(Vec3 low, Vec3 high) {
    PolygonMesh m;
    for (int i = 0; i < 8; ++i)
        m.positions.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
    const std::uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& f : faces) m.add_face(f);
    return m;
}

/// A square perpendicular to the x axis with its centre at (x, y, 0).
PolygonMesh plate(float x, float y, float half) {
    PolygonMesh m;
    m.positions = {{x, y - half, -half}, {x, y + half, -half}, {x, y + half, half}, {x, y - half, half}};
    const std::uint32_t face[4] = {0, 1, 2, 3};
    m.add_face(face);
    return m;
}

/// One scanner on the +x side, at the height of the centre of an object from -1 to 1.
ScanOptions from_x(int points, float noise = 0) {
    return {.points = points, .positions = 1, .distance = 10, .height = 1, .azimuth = 0, .noise = noise};
}

std::size_t count_if(const PointSet& points, const auto& is) {
    return static_cast<std::size_t>(std::count_if(points.positions.begin(), points.positions.end(), is));
}

TEST(Scan, PointsAreOnTheSurfaceInAboutTheRequestedNumber) {
    const PolygonMesh cube = box({-1, -1, -1}, {1, 1, 1});
    for (const int wanted : {100, 3000, 50000}) {
        const PointSet points = scan(cube, {.points = wanted, .distance = 5, .noise = 0});
        EXPECT_NEAR(static_cast<double>(points.size()), wanted, 0.05 * wanted + 20) << wanted;
        for (const Vec3 p : points.positions) {
            ASSERT_NEAR(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), 1, 1e-6);
        }
    }
}

TEST(Scan, ScannerMeasuresTheSidesThatFaceIt) {
    const PolygonMesh cube = box({-1, -1, -1}, {1, 1, 1});
    const PointSet one = scan(cube, from_x(2000));
    EXPECT_EQ(count_if(one, [](Vec3 p) { return p.x > 1 - 1e-6f; }), one.size());
    ScanOptions all = from_x(2000);
    all.positions = 4;
    const PointSet four = scan(cube, all);
    for (const auto side :
         {+[](Vec3 p) { return p.x > 1 - 1e-6f; }, +[](Vec3 p) { return p.x < -1 + 1e-6f; },
          +[](Vec3 p) { return p.y > 1 - 1e-6f; }, +[](Vec3 p) { return p.y < -1 + 1e-6f; }})
        EXPECT_NEAR(static_cast<double>(count_if(four, side)), 500, 50);
    ScanOptions above = from_x(2000);
    above.height = 12;
    EXPECT_GT(count_if(scan(cube, above), [](Vec3 p) { return p.z > 1 - 1e-6f; }), 500u);
}

TEST(Scan, NoPointsAreBehindAnOccluder) {
    // The shield is between the scanner at x = 10 and the cube, and its shadow is larger than the cube.
    const PolygonMesh both = joined(box({-1, -0.5f, -0.5f}, {0, 0.5f, 0.5f}), plate(1, 0, 1));
    const PointSet points = scan(both, from_x(5000));
    EXPECT_EQ(count_if(points, [](Vec3 p) { return p.x < 1 - 1e-6f; }), 0u);
    ScanOptions back = from_x(5000);
    back.azimuth = kPi;
    EXPECT_GT(count_if(scan(both, back), [](Vec3 p) { return p.x < 1 - 1e-6f; }), 100u);
}

TEST(Scan, DensityDecreasesWithTheSquareOfTheDistance) {
    // The centre of both is (4, 0), so that the scanner is at (12, 0), 4 and 12 metres from the plates.
    const PolygonMesh two = joined(plate(8, 2.5f, 0.5f), plate(0, -2.5f, 0.5f));
    ScanOptions o = from_x(20000);
    o.height = 0.5f;
    o.distance = 8;
    const PointSet points = scan(two, o);
    const auto near = static_cast<double>(count_if(points, [](Vec3 p) { return p.x > 7; }));
    const auto far = static_cast<double>(points.size()) - near;
    // Solid angle of a small plate: area times the cosine of the incidence angle over the squared distance.
    const auto angle = [](double x, double y) { return x / std::pow(x * x + y * y, 1.5); };
    EXPECT_NEAR(near / far, angle(4, 2.5) / angle(12, 2.5), 0.3);
}

TEST(Scan, NoiseIsAlongTheBeam) {
    const PolygonMesh m = plate(0, 0, 1);
    const PointSet points = scan(m, from_x(40000, 0.01f));
    double sum = 0, square = 0;
    for (const Vec3 p : points.positions) {
        const Vec3d beam = Vec3d(p) - Vec3d{10, 0, 0};
        const double error = length(beam) * (1 - 10 / -beam.x);  // beyond where the beam meets x = 0
        sum += error;
        square += error * error;
    }
    const auto n = static_cast<double>(points.size());
    EXPECT_NEAR(sum / n, 0, 5 * 0.01 / std::sqrt(n));
    EXPECT_NEAR(std::sqrt(square / n), 0.01, 0.0003);
    const auto outliers = count_if(points, [](Vec3 p) { return std::abs(p.x) > 0.02f; });
    EXPECT_NEAR(static_cast<double>(outliers) / n, 0.0455, 0.006) << "beyond two standard deviations";
}

TEST(Scan, UniformPointsAreOnAllFaces) {
    const PolygonMesh nested =
        joined(box({-1, -1, -1}, {1, 1, 1}), box({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}));
    ScanOptions o{.pattern = ScanPattern::uniform, .points = 10000, .noise = 0};
    const PointSet points = scan(nested, o);
    ASSERT_EQ(points.size(), 10000u);
    const auto inner = count_if(points, [](Vec3 p) {
        return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < 0.75f;
    });
    EXPECT_NEAR(static_cast<double>(inner), 2000, 200) << "a fifth of the area";
    o.noise = 0.001f;
    double square = 0;
    const PointSet noisy = scan(nested, o);
    for (std::size_t i = 0; i < points.size(); ++i)
        square += length_squared(Vec3d(points.positions[i]) - Vec3d(noisy.positions[i]));
    EXPECT_NEAR(std::sqrt(square / 3e4), 0.001, 3e-5);
}

TEST(Scan, ScannerMayBeInsideTheMesh) {
    // Inside a box that it sees all around and up to the zenith.
    const PolygonMesh room = box({-10, -10, 0}, {10, 10, 5});
    const PointSet points = scan(room, {.points = 20000, .positions = 1, .distance = 1, .noise = 0});
    EXPECT_NEAR(static_cast<double>(points.size()), 20000, 1000);
    EXPECT_GT(count_if(points, [](Vec3 p) { return p.z > 5 - 1e-5f; }), 500u);
    EXPECT_GT(count_if(points, [](Vec3 p) { return p.x < -10 + 1e-5f; }), 500u);
    EXPECT_GT(count_if(points, [](Vec3 p) { return p.x > 10 - 1e-5f; }), 500u);
}

TEST(Scan, PreservesTheOrigin) {
    PolygonMesh cube = box({-1, -1, -1}, {1, 1, 1});
    cube.origin = {5e5, 4e6, 100};
    const PointSet points = scan(cube, from_x(500));
    EXPECT_EQ(points.origin, cube.origin);
    EXPECT_NEAR(points.world(0).x, 5e5 + 1, 1e-5);
}

TEST(Scan, FindsASmallMeshInALargeWindow) {
    // One beam of about 12,000 meets a cube.
    const PolygonMesh two =
        joined(box({0, 0, 0}, {0.05f, 0.05f, 0.05f}), box({9, 9, 9}, {9.05f, 9.05f, 9.05f}));
    const PointSet points = scan(two, {.points = 50, .noise = 0});
    EXPECT_GT(points.size(), 20u);
    EXPECT_THROW(scan(two, {.points = 20000}), InvalidInput) << "more beams than are sent";
}

TEST(Scan, IsBitIdenticalForAnyNumberOfThreads) {
    const PolygonMesh cube = box({-1, -1, -1}, {1, 1, 1});
    for (const ScanPattern pattern : {ScanPattern::scanner, ScanPattern::uniform}) {
        const ScanOptions o{.pattern = pattern, .points = 5000, .noise = 0.01f};
        const PointSet one = scan(cube, o, {.threads = 1});
        EXPECT_EQ(one, scan(cube, o, {.threads = 2}));
        EXPECT_EQ(one, scan(cube, o, {.threads = 7}));
        ScanOptions other = o;
        other.seed = 1;
        EXPECT_NE(one, scan(cube, other, {.threads = 2}));
    }
}

TEST(Scan, RejectsInvalidInput) {
    PolygonMesh cube = box({-1, -1, -1}, {1, 1, 1});
    EXPECT_THROW(scan({}), InvalidInput);
    EXPECT_THROW(scan(cube, {.points = 0}), InvalidInput);
    EXPECT_THROW(scan(cube, {.positions = 0}), InvalidInput);
    EXPECT_THROW(scan(cube, {.distance = 0}), InvalidInput);
    EXPECT_THROW(scan(cube, {.noise = std::numeric_limits<float>::quiet_NaN()}), InvalidInput);
    EXPECT_THROW(scan(box({1, 2, 3}, {1, 2, 3})), InvalidInput) << "a point";
    EXPECT_THROW(scan(box({0, 0, 1.5f}, {0, 0, 3}), {.positions = 1}), InvalidInput) << "a line";
    EXPECT_THROW(scan(box({1e20f, 0, 0}, {2e20f, 1, 1})), InvalidInput) << "too far away";
    cube.positions[3].y = std::numeric_limits<float>::infinity();
    EXPECT_THROW(scan(cube), InvalidInput);
}

TEST(Scan, StopsWhenCancelled) {
    std::stop_source source;
    Context ctx;
    ctx.stop = source.get_token();
    ctx.progress = [&](float) { source.request_stop(); };
    EXPECT_THROW(scan(box({-1, -1, -1}, {1, 1, 1}), {}, ctx), Cancelled);
}

}  // namespace
}  // namespace coppice
