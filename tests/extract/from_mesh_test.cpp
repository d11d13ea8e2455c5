#include "coppice/extract/mesh/from_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "coppice/base/error.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/base/random.h"
#include "coppice/skeleton/measure.h"
#include "extract/mesh_support.h"

namespace coppice {
namespace {

using shapes::both;
using shapes::card;
using shapes::fork;
using shapes::inverted;
using shapes::make_surface;
using shapes::soup;
using shapes::torus;
using shapes::tube;
using shapes::TubeOptions;

constexpr TubeOptions kOpen{.closed = false};

double distance_to_axis(const Skeleton& s, Vec3 p) {
    double best = std::numeric_limits<double>::infinity();
    for (const NodeId n : nodes(s)) {
        const Vec3 a = s.is_root(n) ? s.position(n) : s.position(s.parent(n)), d = s.position(n) - a;
        const float l2 = length_squared(d), t = l2 > 0 ? std::clamp(dot(p - a, d) / l2, 0.0f, 1.0f) : 0;
        best = std::min(best, static_cast<double>(distance(p, a + d * t)));
    }
    return best;
}

/// Returns the maximum distance of a's axis from that of b.
double farthest(const Skeleton& a, const Skeleton& b) {
    double worst = 0;
    for (const NodeId n : nodes(a)) {
        if (a.is_root(n)) continue;
        for (int i = 0; i <= 10; ++i)
            worst = std::max(worst, distance_to_axis(b, lerp(a.position(a.parent(n)), a.position(n),
                                                             0.1f * static_cast<float>(i))));
    }
    return worst;
}

class BothMethods : public testing::TestWithParam<MeshSkeletonMethod> {
  public:
    FromMeshOptions options() const {
        FromMeshOptions o;
        o.method = GetParam();
        return o;
    }
};
INSTANTIATE_TEST_SUITE_P(FromMesh, BothMethods,
                         testing::Values(MeshSkeletonMethod::rings, MeshSkeletonMethod::contraction),
                         [](const auto& which) { return std::string(name_of(which.param)); });

// A tube with flat ends: the axis extends from face to face.
TEST_P(BothMethods, AClosedTubeHasItsAxis) {
    const FromMeshResult r = extract_from_mesh(tube({0, 0, 1}, {0, 0, 3}, 0.1f), options());
    const SkeletonMeasures m = measure(r.skeleton);
    EXPECT_EQ(m.trees, 1u);
    EXPECT_EQ(m.tips, 1u);
    EXPECT_EQ(m.branch_nodes, 0u);
    EXPECT_NEAR(m.length, 2, 0.02);
    EXPECT_NEAR(r.skeleton.position(NodeId(0)).z, 1, 0.02);
    for (const NodeId n : nodes(r.skeleton)) {
        EXPECT_LT(std::hypot(r.skeleton.position(n).x, r.skeleton.position(n).y), 0.003);
        EXPECT_NEAR(r.skeleton.radius(n), 0.1, 0.005);
    }
    EXPECT_LT(r.report.residual, 0.02);
}

TEST(FromMesh, AnOpenTubeHasItsAxis) {
    const FromMeshResult r = extract_from_mesh(tube({0, 0, 0}, {1, 0, 2}, 0.15f, kOpen));
    EXPECT_EQ(measure(r.skeleton).branch_nodes, 0u);
    EXPECT_NEAR(measure(r.skeleton).length, std::sqrt(5.0), 0.1);
    EXPECT_EQ(r.repairs.open_edges, 32u);
    EXPECT_LT(farthest(r.skeleton, Skeleton({NodeId(), NodeId(0)}, {{0, 0, 0}, {1, 0, 2}}, {0.1f, 0.1f})),
              0.02);
}

TEST_P(BothMethods, PreservesTaper) {
    const FromMeshResult r =
        extract_from_mesh(tube({0, 0, 0}, {0, 0, 4}, 0.3f, {.rings = 41, .radius_end = 0.1f}), options());
    EXPECT_NEAR(measure(r.skeleton).length, 4, 0.5);  // within a radius at either end
    for (const NodeId n : nodes(r.skeleton)) {
        // Distance of a point at height z on the cone from its axis.
        const double z = r.skeleton.position(n).z;
        EXPECT_NEAR(r.skeleton.radius(n), 0.3 - 0.05 * z, 0.015) << z;
    }
}

TEST_P(BothMethods, FindsAForkAtItsPosition) {
    const Skeleton truth = fork();
    // Contraction creates tips that the fit moves only part of the way.
    const double tip = GetParam() == MeshSkeletonMethod::rings ? 0.05 : 0.15;
    const FromMeshResult r = extract_from_mesh(make_surface(truth, 0.05f), options());
    const SkeletonMeasures m = measure(r.skeleton);
    EXPECT_EQ(m.tips, 2u);
    ASSERT_EQ(m.branch_nodes, 1u);
    for (const NodeId n : nodes(r.skeleton)) {
        if (r.skeleton.children(n).size() > 1) {
            EXPECT_LT(distance(r.skeleton.position(n), Vec3(0, 0, 2)), 0.1);
        }
        if (!r.skeleton.is_tip(n)) continue;
        const Vec3 p = r.skeleton.position(n);
        EXPECT_LT(std::min(distance(p, truth.position(NodeId(2))), distance(p, truth.position(NodeId(3)))),
                  tip);
    }
    EXPECT_LT(farthest(truth, r.skeleton), 0.05);
    EXPECT_LT(farthest(r.skeleton, truth), 0.03 + tip);
    EXPECT_LT(distance(r.skeleton.position(NodeId(0)), Vec3()), 0.05);
}

TEST_P(BothMethods, MapsEveryVertexToANodeNearIt) {
    const FromMeshResult r = extract_from_mesh(make_surface(fork(), 0.05f), options());
    ASSERT_EQ(r.nodes.size(), r.vertices.size());
    ASSERT_EQ(r.vertices.size(), r.report.samples);
    for (std::size_t v = 0; v < r.nodes.size(); ++v) {
        const NodeId n(r.nodes[v]);
        ASSERT_LT(n.index(), r.skeleton.size());
        const NodeId p = r.skeleton.is_root(n) ? n : r.skeleton.parent(n);
        const Vec3d at = r.vertices.world(v) - r.skeleton.origin(), from(r.skeleton.position(p)),
                    along = Vec3d(r.skeleton.position(n)) - from;
        EXPECT_LT(distance(at, from + along * closest_parameter(at, from, along)), 0.3) << v;
    }
}

// A wedge: its vertices have two distances from the axis, so that their mean differs from their median.
TEST(FromMesh, ThicknessIsTheMedianOrTheMean) {
    PolygonMesh wedge = tube({0, 0, 0}, {0, 0, 4}, 0.2f, {.sides = 12, .rings = 40});
    for (Vec3& p : wedge.positions)
        if (p.x > 0.15f) p.x *= 2;
    FromMeshOptions options{.method = MeshSkeletonMethod::contraction, .fit = false};
    const auto middle = [&](Thickness thickness) {
        options.thickness = thickness;
        const Skeleton s = extract_from_mesh(wedge, options).skeleton;
        double sum = 0;
        for (const NodeId n : nodes(s)) sum += double{s.radius(n)} / s.size();
        return sum;
    };
    EXPECT_LT(middle(Thickness::mean), 0.98 * middle(Thickness::median));
}

// Six arms from one node: at most five forks, six ends.
TEST_P(BothMethods, FindsAllArmsOfAStar) {
    std::vector<NodeId> parent{NodeId()};
    std::vector<Vec3> at{{0, 0, 0}};
    for (const Vec3 d :
         {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)}) {
        parent.push_back(NodeId(0));
        at.push_back(d);
    }
    const Skeleton star(parent, at, std::vector<float>(7, 0.1f));
    const FromMeshResult r = extract_from_mesh(make_surface(star, 0.04f), options());
    EXPECT_EQ(measure(r.skeleton).tips, 5u);  // the lowest arm's end is the root
    EXPECT_LT(r.skeleton.position(NodeId(0)).z, -0.95f);
    EXPECT_LT(farthest(star, r.skeleton), 0.1);
}

TEST_P(BothMethods, CutsARingOnce) {
    const float circumference = 2 * std::numbers::pi_v<float>;
    const FromMeshResult r = extract_from_mesh(torus(1, 0.1f, 120, 16), options());
    EXPECT_EQ(r.report.loops, 1u);
    EXPECT_EQ(r.report.trees, 1u);
    EXPECT_NEAR(measure(r.skeleton).length, circumference, 0.6);
    for (const NodeId n : nodes(r.skeleton))
        EXPECT_NEAR(std::hypot(r.skeleton.position(n).x, r.skeleton.position(n).y), 1, 0.05);
}

TEST_P(BothMethods, TwoTreesHaveTwoRoots) {
    const PolygonMesh two = both(tube({0, 0, 0}, {0, 0, 2}, 0.1f), tube({5, 0, 1}, {5, 0, 4}, 0.2f));
    const FromMeshResult r = extract_from_mesh(two, options());
    EXPECT_EQ(r.report.components, 2u);
    EXPECT_EQ(r.skeleton.tree_count(), 2u);
    EXPECT_NEAR(measure(r.skeleton).length, 5, 0.1);
}

TEST_P(BothMethods, IsBitIdenticalForAnyNumberOfThreads) {
    const PolygonMesh mesh = make_surface(fork(), 0.05f);
    Context ctx;
    ctx.threads = 1;
    const FromMeshResult one = extract_from_mesh(mesh, options(), ctx);
    for (const unsigned threads : {2u, 7u}) {
        ctx.threads = threads;
        const FromMeshResult many = extract_from_mesh(mesh, options(), ctx);
        EXPECT_TRUE(std::ranges::equal(one.skeleton.positions(), many.skeleton.positions()));
        EXPECT_TRUE(std::ranges::equal(one.skeleton.radii(), many.skeleton.radii()));
        EXPECT_TRUE(std::ranges::equal(one.skeleton.parents(), many.skeleton.parents()));
        EXPECT_EQ(one.report, many.report);
    }
}

TEST_P(BothMethods, StopsWhenCancelled) {
    std::stop_source source;
    source.request_stop();
    Context ctx;
    ctx.stop = source.get_token();
    EXPECT_THROW(extract_from_mesh(tube({0, 0, 0}, {0, 0, 2}, 0.1f), options(), ctx), Cancelled);
}

// The skeleton does not depend on the representation of the surface.
TEST(FromMesh, IgnoresSplitVerticesAndInwardFaces) {
    const PolygonMesh mesh = make_surface(fork(), 0.05f);
    const FromMeshResult plain = extract_from_mesh(mesh);
    const FromMeshResult repaired = extract_from_mesh(inverted(soup(mesh)));
    EXPECT_GT(repaired.repairs.welded, 0u);
    EXPECT_GT(repaired.repairs.flipped, 0u);
    EXPECT_LT(farthest(plain.skeleton, repaired.skeleton), 0.02);
    EXPECT_EQ(measure(plain.skeleton).tips, measure(repaired.skeleton).tips);
}

TEST(FromMesh, ExcludesLeaves) {
    PolygonMesh mesh = make_surface(fork(), 0.05f);
    const FromMeshResult bare = extract_from_mesh(mesh);
    for (int i = 0; i < 20; ++i) mesh = both(mesh, card({1, 0, 3 + 0.1f * static_cast<float>(i)}, 0.2f));
    const FromMeshResult leafy = extract_from_mesh(mesh);
    EXPECT_EQ(leafy.repairs.cards, 20u);
    EXPECT_EQ(leafy.skeleton.tree_count(), 1u);
    EXPECT_LT(farthest(leafy.skeleton, bare.skeleton), 0.01);
}

// A lateral tube with an open base on the axis of the trunk, as generators create them.
TEST(FromMesh, JoinsOverlappingTubes) {
    const PolygonMesh mesh =
        both(tube({0, 0, 0}, {0, 0, 3}, 0.2f, kOpen), tube({0, 0, 1.5f}, {1.5f, 0, 2.5f}, 0.1f, kOpen));
    const FromMeshResult r = extract_from_mesh(mesh);
    EXPECT_EQ(r.report.joined, 1u);
    EXPECT_EQ(r.skeleton.tree_count(), 1u);
    EXPECT_EQ(measure(r.skeleton).tips, 2u);
    ASSERT_EQ(measure(r.skeleton).branch_nodes, 1u);
    for (const NodeId n : nodes(r.skeleton))
        if (r.skeleton.children(n).size() > 1) {
            EXPECT_LT(distance(r.skeleton.position(n), Vec3(0, 0, 1.5f)), 0.1);
        }
    FromMeshOptions apart;
    apart.join = 0;
    EXPECT_EQ(extract_from_mesh(mesh, apart).skeleton.tree_count(), 2u);
}

TEST(FromMesh, RootFollowsTheOptions) {
    const PolygonMesh mesh = make_surface(fork(), 0.05f);
    FromMeshOptions options;
    options.root = Vec3d(1, 0, 3);
    const Skeleton s = extract_from_mesh(mesh, options).skeleton;
    EXPECT_LT(distance(s.position(NodeId(0)), Vec3(1.06f, 0, 3.06f)), 0.1);
    options = {};
    options.up = UpAxis::x;  // the end of the branch towards -x is the lowest
    EXPECT_LT(distance(extract_from_mesh(mesh, options).skeleton.position(NodeId(0)), Vec3(-1.06f, 0, 3.06f)),
              0.1);
}

TEST(FromMesh, PreservesTheOrigin) {
    PolygonMesh mesh = tube({0, 0, 0}, {0, 0, 2}, 0.1f);
    mesh.origin = {500000, 4e6, 100};
    FromMeshOptions options;
    options.root = Vec3d(500000, 4e6, 102);
    const Skeleton s = extract_from_mesh(mesh, options).skeleton;
    EXPECT_EQ(s.origin(), mesh.origin);
    EXPECT_NEAR(s.position(NodeId(0)).z, 2, 0.05);
}

// A bump as wide as the trunk and a quarter of its radius high is bark, not a branch.
TEST(FromMesh, NoiseCausesNoTwigs) {
    PolygonMesh mesh = tube({0, 0, 0}, {0, 0, 4}, 0.2f, {.sides = 32, .rings = 161});
    const CounterRandom random(1, 1);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const auto draw = [&](std::uint64_t k) {
            return static_cast<float>(random.uniform(3 * v + k, -0.01, 0.01));
        };
        mesh.positions[v] += Vec3(draw(0), draw(1), draw(2));
    }
    const FromMeshResult r = extract_from_mesh(mesh);
    EXPECT_EQ(measure(r.skeleton).tips, 1u);
    EXPECT_NEAR(measure(r.skeleton).length, 4, 0.2);
}

TEST(FromMesh, BridgesHoles) {
    const PolygonMesh whole = tube({0, 0, 0}, {0, 0, 3}, 0.2f, {.sides = 24, .rings = 61});
    PolygonMesh holed;
    holed.positions = whole.positions;
    for (std::uint32_t f = 0; f < whole.face_count(); ++f) {
        const Vec3 p = whole.positions[whole.face(f)[0]];
        if (distance(p, Vec3(0.2f, 0, 1)) < 0.2f || distance(p, Vec3(-0.2f, 0, 2)) < 0.15f) continue;
        holed.add_face(whole.face(f));
    }
    const FromMeshResult r = extract_from_mesh(holed);
    EXPECT_EQ(measure(r.skeleton).tips, 1u);
    for (const NodeId n : nodes(r.skeleton))
        EXPECT_LT(std::hypot(r.skeleton.position(n).x, r.skeleton.position(n).y), 0.03);
}

TEST(FromMesh, ConfidenceCountsEveryVertexOnce) {
    const FromMeshResult r = extract_from_mesh(make_surface(fork(), 0.05f));
    ASSERT_EQ(r.confidence.size(), r.skeleton.size());
    std::uint64_t sum = 0;
    for (const NodeConfidence& c : r.confidence) {
        sum += c.samples;
        EXPECT_GE(c.residual, 0);
    }
    EXPECT_LE(sum, r.report.samples);
    EXPECT_GT(sum, r.report.samples * 9 / 10);
}

// The skeleton has only the nodes that the surface requires.
TEST(FromMesh, StraightPartsHaveFewNodes) {
    EXPECT_LE(extract_from_mesh(tube({0, 0, 0}, {0, 0, 9}, 0.1f, {.rings = 181})).skeleton.size(), 6u);
}

TEST(FromMesh, RejectsComponentsWithoutAnAxis) {
    FromMeshOptions options;
    options.clean.cards = false;
    PolygonMesh point = card({0, 0, 0}, 0.1f);
    point.positions[2] = point.positions[3] = {0.1f, -0.1f, 1e-30f};
    EXPECT_THROW(extract_from_mesh(point, options), InvalidInput);
    options.prune = -1;
    EXPECT_THROW(extract_from_mesh(tube({0, 0, 0}, {0, 0, 2}, 0.1f), options), InvalidInput);
}

// A hub with 20,000 spokes: each of its collapses would visit all of them, 400 million in total.
TEST(FromMesh, ContractionRejectsHubs) {
    const PolygonMesh mesh = tube({0, 0, 0}, {0, 0, 3}, 1, {.sides = 20000, .rings = 2});
    EXPECT_NEAR(measure(extract_from_mesh(mesh).skeleton).length, 3, 0.5);
    FromMeshOptions options;
    options.method = MeshSkeletonMethod::contraction;
    EXPECT_THROW(extract_from_mesh(mesh, options), InvalidInput);
}

// Random triangles: any result is accepted, but the function must return.
TEST(FromMesh, TerminatesOnRandomTriangles) {
    const CounterRandom random(3, 1);
    int answered = 0;
    for (std::uint64_t round = 0; round < 40; ++round) {
        PolygonMesh m;
        const auto count = 3 + static_cast<std::uint32_t>(random.bits(round) % 60);
        for (std::uint64_t v = 0; v < count; ++v) {
            const auto draw = [&](std::uint64_t k) {
                return static_cast<float>(random.uniform(1000 * round + 3 * v + k + 77, -1, 1));
            };
            m.positions.push_back({draw(0), draw(1), draw(2)});
        }
        for (std::uint64_t f = 0; f < 4 * count; ++f) {
            std::vector<std::uint32_t> face;
            for (std::uint64_t k = 0; k < 3; ++k)
                face.push_back(
                    static_cast<std::uint32_t>(random.bits(100000 + 1000 * round + 3 * f + k) % count));
            m.add_face(face);
        }
        for (const MeshSkeletonMethod method : {MeshSkeletonMethod::rings, MeshSkeletonMethod::contraction}) {
            FromMeshOptions options;
            options.method = method;
            try {
                // All corners are within 1 of the origin along each axis.
                const Box3 box = extract_from_mesh(m, options).skeleton.bounds();
                EXPECT_TRUE(is_finite(box.low) && is_finite(box.high));
                EXPECT_LT(box.diagonal(), 10);
                ++answered;
            } catch (const InvalidInput&) {
            }
        }
    }
    EXPECT_GT(answered, 20);
}

}  // namespace
}  // namespace coppice
