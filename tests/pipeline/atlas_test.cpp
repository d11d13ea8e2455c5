#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/mesh/face_view.h"
#include "coppice/pipeline/face_budget.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/random_tree.h"
#include "zoo.h"

namespace coppice {
namespace {

using Point = std::array<std::int64_t, 2>;  // [2^-24]
using Corners = std::array<Point, 3>;

MeshOptions with_atlas(MeshMethod method = MeshMethod::quads, int size = 4096) {
    MeshOptions options;
    options.method = method;
    options.texture.coordinates = TextureCoordinates::atlas;
    options.texture.atlas_size = size;
    return options;
}

Skeleton stem(float radius, float length) {
    return {{NodeId::none(), NodeId(0), NodeId(1)},
            {{0, 0, 0}, {0, 0, length / 2}, {0, 0, length}},
            {radius, radius, radius}};
}

std::int64_t doubled_area(const Point& a, const Point& b, const Point& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
}

// Cuts a triangle by the three sides of another one, and returns twice the area that remains.
double doubled_intersection(const Corners& a, const Corners& b) {
    std::vector<std::array<double, 2>> polygon;
    const auto relative = [&](const Point& p) {
        return std::array{static_cast<double>(p[0] - b[0][0]), static_cast<double>(p[1] - b[0][1])};
    };
    for (const Point& p : a) polygon.push_back(relative(p));
    for (std::size_t k = 0; k < 3; ++k) {
        const auto from = relative(b[k]), to = relative(b[(k + 1) % 3]);
        const auto side = [&](const std::array<double, 2>& p) {
            return (to[0] - from[0]) * (p[1] - from[1]) - (p[0] - from[0]) * (to[1] - from[1]);
        };
        std::vector<std::array<double, 2>> kept;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const auto &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
            const double sp = side(p), sq = side(q);
            if (sp >= 0) kept.push_back(p);
            if ((sp > 0 && sq < 0) || (sp < 0 && sq > 0)) {
                const double t = sp / (sp - sq);
                kept.push_back({p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])});
            }
        }
        polygon = std::move(kept);
    }
    double out = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
        out += (polygon[i][0] - polygon[0][0]) * (polygon[i + 1][1] - polygon[0][1]) -
               (polygon[i + 1][0] - polygon[0][0]) * (polygon[i][1] - polygon[0][1]);
    return out;
}

// The triangles of an atlas, and the face of each. All faces must be convex.
struct Triangles {
    std::vector<Corners> corners;
    std::vector<std::uint32_t> face;
};

Triangles find_triangles(const MeshResult& made) {
    const PolygonMesh mesh = to_polygons(made);
    const auto& points = made.texture->points;
    EXPECT_EQ(points.size(), mesh.corners.size());
    Triangles out;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const std::size_t n = mesh.face(f).size();
        std::vector<Point> face;
        for (std::size_t k = 0; k < n; ++k) {
            const TexturePoint p = points[mesh.first[f] + k];
            EXPECT_TRUE(p.u >= 0 && p.u <= 1 && p.v >= 0 && p.v <= 1);
            face.push_back(
                {std::llround(std::ldexp(double{p.u}, 24)), std::llround(std::ldexp(double{p.v}, 24))});
            EXPECT_EQ(std::ldexp(static_cast<float>(face[k][0]), -24), p.u);  // no digits are lost
            EXPECT_EQ(std::ldexp(static_cast<float>(face[k][1]), -24), p.v);
        }
        for (std::size_t k = 0; k < n; ++k)
            EXPECT_GT(doubled_area(face[k], face[(k + 1) % n], face[(k + 2) % n]), 0);
        for (std::size_t k = 1; k + 1 < n; ++k) {
            out.corners.push_back({face[0], face[k], face[k + 1]});
            out.face.push_back(f);
        }
    }
    return out;
}

// Returns the number of pairs of triangles of different faces that overlap; all areas must be positive.
int count_overlaps(const Triangles& t) {
    constexpr std::int64_t kCell = 1 << 16, kCells = 257;
    std::vector<std::vector<std::size_t>> cells(kCells * kCells);
    int out = 0;
    const auto bounds = [&](std::size_t i, std::size_t axis) {
        return std::minmax({t.corners[i][0][axis], t.corners[i][1][axis], t.corners[i][2][axis]});
    };
    for (std::size_t i = 0; i < t.corners.size(); ++i) {
        EXPECT_GT(doubled_area(t.corners[i][0], t.corners[i][1], t.corners[i][2]), 0);
        const auto [left, right] = bounds(i, 0);
        const auto [bottom, top] = bounds(i, 1);
        for (std::int64_t x = left / kCell; x <= right / kCell; ++x) {
            for (std::int64_t y = bottom / kCell; y <= top / kCell; ++y) {
                auto& cell = cells[static_cast<std::size_t>(y * kCells + x)];
                for (const std::size_t j : cell) {
                    const auto [l, r] = bounds(j, 0);
                    const auto [b, h] = bounds(j, 1);
                    if (t.face[i] == t.face[j] || l >= right || left >= r || b >= top || bottom >= h)
                        continue;
                    // A millionth of the smaller area is more than the rounding of the cuts.
                    const double area = static_cast<double>(
                        std::min(doubled_area(t.corners[i][0], t.corners[i][1], t.corners[i][2]),
                                 doubled_area(t.corners[j][0], t.corners[j][1], t.corners[j][2])));
                    if (doubled_intersection(t.corners[i], t.corners[j]) > 1e-6 * area) ++out;
                }
                cell.push_back(i);
            }
        }
    }
    return out;
}

void expect_valid(const MeshResult& made, const std::string& name) {
    ASSERT_TRUE(made.texture && made.atlas) << name;
    EXPECT_EQ(count_overlaps(find_triangles(made)), 0) << name;
    EXPECT_EQ(made.texture->report.flipped, 0u) << name;
    EXPECT_GT(made.atlas->charts, 0u) << name;
    EXPECT_GT(made.atlas->used, 0.1) << name;
    EXPECT_LE(made.atlas->used, 1) << name;
}

TEST(Atlas, CoversNoPointTwiceOnAnySkeletonByAnyMethod) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        for (const MeshMethod method : {MeshMethod::quads, MeshMethod::bmesh, MeshMethod::ramifications,
                                        MeshMethod::tetrahedra, MeshMethod::cylinders}) {
            MeshOptions options = with_atlas(method);
            options.levels = 1;
            expect_valid(mesh_skeleton(skeleton, options), name + ' ' + std::string(name_of(method)));
        }
    }
}

TEST(Atlas, IsValidWithFewerQuadsAroundThinBranches) {
    const Skeleton tree = random_tree(300, 7);
    MeshOptions options = with_atlas();
    options.tube_sides = TubeSides::by_radius;
    expect_valid(mesh_skeleton(tree, options), "by_radius");
    options.fit = Fit::volume;
    expect_valid(mesh_skeleton(tree, options), "fit");
    expect_valid(mesh_with_faces(tree, PointSet{}, with_atlas(), 3000).result, "faces");
}

TEST(Atlas, UnrollsAStemWithOneDensity) {
    // Area 2 pi r (length + r) = 2.4 m^2, so that the stem is cut across: 4 m are more than a quarter of 1.5
    // m.
    const MeshResult made = mesh_skeleton(stem(0.1f, 4), with_atlas());
    expect_valid(made, "stem");
    EXPECT_GT(made.atlas->charts, 4u);
    EXPECT_GT(made.atlas->used, 0.5);
    EXPECT_NEAR(made.texture->report.density_p5, 1, 0.1);
    EXPECT_NEAR(made.texture->report.density_p50, 1, 0.05);
    EXPECT_NEAR(made.texture->report.density_p95, 1, 0.1);
}

TEST(Atlas, HasTwoPixelsBetweenCharts) {
    constexpr int kSize = 256;
    const MeshResult made = mesh_skeleton(random_tree(60, 5), with_atlas(MeshMethod::quads, kSize));
    const Triangles triangles = find_triangles(made);
    const QuadMesh& mesh = made.quads().mesh;
    // Faces belong to one chart if they share a vertex with the same coordinates.
    std::map<std::pair<std::uint32_t, std::pair<float, float>>, std::uint32_t> first;
    std::vector<std::uint32_t> chart(mesh.quads.size());
    for (std::uint32_t f = 0; f < chart.size(); ++f) chart[f] = f;
    const auto find = [&](std::uint32_t f) {
        while (chart[f] != f) f = chart[f];
        return f;
    };
    std::array<std::int64_t, 4> outside{1 << 24, 0, 1 << 24, 0};
    for (std::uint32_t f = 0; f < mesh.quads.size(); ++f) {
        for (std::size_t k = 0; k < 4; ++k) {
            const TexturePoint p = made.texture->points[4 * f + k];
            const auto [other, is_new] = first.try_emplace({mesh.quads[f][k], {p.u, p.v}}, f);
            if (!is_new) chart[find(f)] = find(other->second);
        }
    }
    std::map<std::uint32_t, std::array<std::int64_t, 4>> boxes;
    for (std::size_t i = 0; i < triangles.corners.size(); ++i) {
        auto& box = boxes.try_emplace(find(triangles.face[i]), outside).first->second;
        for (const Point& p : triangles.corners[i])
            box = {std::min(box[0], p[0]), std::max(box[1], p[0]), std::min(box[2], p[1]),
                   std::max(box[3], p[1])};
    }
    constexpr std::int64_t kMargin = 2 * (1 << 24) / kSize;
    for (auto a = boxes.begin(); a != boxes.end(); ++a) {
        const auto& p = a->second;
        EXPECT_TRUE(p[0] >= kMargin && p[2] >= kMargin);
        EXPECT_TRUE(p[1] <= (1 << 24) - kMargin && p[3] <= (1 << 24) - kMargin);
        for (auto b = std::next(a); b != boxes.end(); ++b) {
            const auto& q = b->second;
            const bool near_x = p[0] < q[1] + kMargin && q[0] < p[1] + kMargin;
            const bool near_y = p[2] < q[3] + kMargin && q[2] < p[3] + kMargin;
            EXPECT_FALSE(near_x && near_y);
        }
    }
}

TEST(Atlas, RefusesAnImageThatIsTooSmall) {
    EXPECT_THROW(mesh_skeleton(random_tree(3000, 4), with_atlas(MeshMethod::cylinders, 64)), InvalidInput);
}

TEST(Atlas, IsTheSameForAnyNumberOfThreads) {
    const Skeleton tree = random_tree(400, 3);
    for (const MeshMethod method : {MeshMethod::quads, MeshMethod::tetrahedra}) {
        const Texture one = *mesh_skeleton(tree, with_atlas(method), {.threads = 1}).texture;
        const Texture three = *mesh_skeleton(tree, with_atlas(method), {.threads = 3}).texture;
        EXPECT_TRUE(std::ranges::equal(one.points, three.points));
    }
}

}  // namespace
}  // namespace coppice
