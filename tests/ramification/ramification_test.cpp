#include "coppice/ramification/ramification.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coppice/base/random.h"
#include "coppice/cage/separate_branches.h"
#include "coppice/mesh/topology.h"
#include "coppice/skeleton/random_tree.h"
#include "errors.h"
#include "zoo.h"

namespace coppice {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

RamificationMesh make_ramification(const Skeleton& s, const RamificationOptions& options = {},
                                   const ControlOptions& ends = {}, const Context& ctx = {}) {
    return build_ramifications(s, ends, 2, options, ctx);
}

void expect_spheres(const ControlMesh& m, const Skeleton& s) {
    const TopologyReport t = topology(m.cage);
    EXPECT_TRUE(t.watertight());
    EXPECT_EQ(t.components, s.tree_count());
    EXPECT_EQ(t.euler, 2 * static_cast<std::int64_t>(s.tree_count()));
    EXPECT_EQ(t.vertices, m.cage.positions.size());
    EXPECT_EQ(m.anchors.size(), m.cage.positions.size());
    EXPECT_EQ(m.region.size(), m.cage.quads.size());
    for (const Vec3 p : m.cage.positions) ASSERT_TRUE(is_finite(p));
    for (const Vec3 p : m.anchors) ASSERT_TRUE(is_finite(p));
}

/// Returns a trunk and laterals of equal radius from its only inner node, at these angles about it.
Skeleton whorl(const std::vector<float>& angles, float radius = 0.04f) {
    std::vector<NodeId> parents{NodeId::none(), NodeId(0), NodeId(1)};
    std::vector<Vec3> positions{{0, 0, 0}, {0, 0, 1}, {0, 0, 2}};
    std::vector<float> radii{0.1f, 0.1f, 0.1f};
    for (const float a : angles) {
        parents.push_back(NodeId(1));
        positions.push_back({std::cos(a), std::sin(a), 1});
        radii.push_back(radius);
    }
    return Skeleton(parents, positions, radii);
}

TEST(Ramification, ZooHasOneSpherePerTree) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        for (const bool additional : {false, true}) {
            const RamificationOptions options{.all_additional = additional,
                                              .no_connection_optimisation = additional};
            expect_spheres(make_ramification(skeleton, options).control, skeleton);
            expect_spheres(make_ramification(separate_branches(skeleton, {}, {}).skeleton, options).control,
                           skeleton);
        }
        const ControlOptions flat{.tips = TipShape::flat}, round{.base = BaseShape::round};
        expect_spheres(make_ramification(skeleton, {}, flat).control, skeleton);
        expect_spheres(make_ramification(skeleton, {.printed_angles = true}, round).control, skeleton);
    }
}

TEST(Ramification, JoinsFourToNineBranchesInAnyDirection) {
    const CounterRandom random(7, 0);
    std::uint64_t draw = 0;
    const auto between = [&](double low, double high) {
        return static_cast<float>(random.uniform(draw++, low, high));
    };
    for (std::uint32_t branches = 4; branches <= 9; ++branches) {
        for (int i = 0; i < 100; ++i) {
            SCOPED_TRACE(std::to_string(branches) + ", " + std::to_string(i));
            std::vector<NodeId> parents{NodeId::none(), NodeId(0)};
            std::vector<Vec3> positions{{0, 0, 0}, {0, 0, 1}};
            std::vector<float> radii{0.1f, 0.1f};
            for (std::uint32_t b = 0; b < branches; ++b) {
                const float z = between(-1, 1);
                const float a = between(0, 2 * std::numbers::pi), s = std::sqrt(1 - z * z);
                parents.push_back(NodeId(1));
                positions.push_back({s * std::cos(a), s * std::sin(a), 1 + z});
                radii.push_back(between(0.02, 0.1));
            }
            const Skeleton skeleton(parents, positions, radii);
            expect_spheres(make_ramification(skeleton).control, skeleton);
            expect_spheres(make_ramification(skeleton, {.all_additional = true}).control, skeleton);
        }
    }
}

TEST(Ramification, PlacesHundredsOfLateralsAtANode) {
    std::vector<float> angles;
    for (int i = 0; i < 500; ++i) angles.push_back(0.7f * static_cast<float>(i));
    const Skeleton brush = whorl(angles);
    for (const bool additional : {false, true}) {
        const RamificationMesh made = make_ramification(brush, {.all_additional = additional});
        expect_spheres(made.control, brush);
        EXPECT_EQ(made.report.connectable + made.report.additional, 500u);
        EXPECT_GT(made.report.crowded, 100u);
    }
}

// The faces of the cube have the directions 0, 90, 180 and 270 degrees from the thickest lateral, here the
// first of equals; a lateral with an exit within 10 degrees of an edge, or at an occupied face, is
// additional.
TEST(Ramification, ConnectsLateralsWithAFaceOfTheirOwn) {
    const auto additional = [](const std::vector<float>& degrees, bool printed = false) {
        std::vector<float> angles;
        for (const float d : degrees) angles.push_back(d * kPi / 180);
        return make_ramification(whorl(angles), {.printed_angles = printed}).report.additional;
    };
    EXPECT_EQ(additional({0}), 0u);
    EXPECT_EQ(additional({0, 90, 180, 270}), 0u);
    EXPECT_EQ(additional({0, 110}), 0u);
    EXPECT_EQ(additional({0, 45}), 1u);
    EXPECT_EQ(additional({0, 127}), 1u);
    EXPECT_EQ(additional({0, 20}), 1u);
    // Modulo 45 degrees, 90 is 0, less than 10; therefore all except one are additional.
    EXPECT_EQ(additional({0, 90, 180, 270}, true), 3u);
}

// Two rows of eight sides are between units, rings and ends, and each ring is shared with its neighbour.
TEST(Ramification, ReportsTheTubesOfQuads) {
    for (const bool additional : {false, true}) {
        const Skeleton tree = random_tree(200, 2);
        const RamificationMesh made = make_ramification(tree, {.all_additional = additional});
        const ControlMesh& m = made.control;
        ASSERT_EQ(m.region_node.size(), made.tubes.size());
        ASSERT_EQ(made.wrapping.size(), tree.size());
        std::vector<std::uint32_t> sides(made.tubes.size(), 0), caps(sides), forks(sides), wraps(sides);
        std::vector<std::uint32_t> first(made.tubes.size(), 0);
        for (std::uint32_t q = 0; q < m.region.size(); ++q) {
            const std::uint32_t r = m.region[q];
            if (m.part[q] == TubeFace::side && sides[r]++ == 0) first[r] = q;
            caps[r] += m.part[q] == TubeFace::start || m.part[q] == TubeFace::end ? 1 : 0;
            forks[r] += m.part[q] == TubeFace::fork ? 1 : 0;
        }
        for (std::size_t n = 0; n < tree.size(); ++n) {
            for (const NodeId t : made.wrapping[n]) ++wraps[t.index()];
        }
        for (const NodeId t : nodes(made.tubes)) {
            const std::uint32_t i = t.index();
            const std::size_t children = made.tubes.children(t).size();
            EXPECT_EQ(sides[i], made.tubes.is_root(t) ? 0u : 8u);
            EXPECT_EQ(forks[i] > 0, children > 1);
            EXPECT_EQ(wraps[i] > 0, !made.tubes.is_root(t));
            if (children == 0) {
                EXPECT_GT(caps[i], 0u);
            }
            if (children != 1 || made.tubes.is_root(t)) continue;
            const std::uint32_t next = first[made.tubes.children(t)[0].index()];
            for (std::uint32_t k = 0; k < 8; ++k) {
                EXPECT_EQ(m.part[first[i] + k], TubeFace::side);
                EXPECT_EQ(m.cage.quads[first[i] + k][1], m.cage.quads[first[i] + (k + 1) % 8][0]);
                bool meets = false;
                for (std::uint32_t l = 0; l < 8; ++l)
                    meets |= m.cage.quads[next + l][0] == m.cage.quads[first[i] + k][3];
                EXPECT_TRUE(meets);
            }
        }
    }
}

TEST(Ramification, ReducesItsObjective) {
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
        const Skeleton tree = random_tree(300, seed);
        const RamificationReport r = make_ramification(tree).report;
        EXPECT_LT(r.after.connections, r.before.connections);
        EXPECT_LT(r.after.units + r.after.connections, r.before.units + r.before.connections);
        EXPECT_LT(r.after.total(), r.before.total());
        EXPECT_EQ(r.connectable + r.additional + 1, r.branches);
        const RamificationReport cubes = make_ramification(tree, {.no_connection_optimisation = true}).report;
        EXPECT_EQ(cubes.after.connections, cubes.before.connections);
        EXPECT_EQ(cubes.after.units, cubes.before.units);
        const RamificationReport pasted = make_ramification(tree, {.all_additional = true}).report;
        EXPECT_EQ(pasted.connectable, 0u);
        EXPECT_EQ(pasted.additional, pasted.branches - 1);
    }
}

// A lateral every millimetre: all units touch; none may grow without bound.
TEST(Ramification, AcceptsABrush) {
    constexpr std::uint32_t kLaterals = 20'000;
    std::vector<NodeId> parents{NodeId::none()};
    std::vector<Vec3> positions{{0, 0, 0}};
    std::vector<float> radii{0.1f};
    for (std::uint32_t i = 1; i <= kLaterals; ++i) {
        const float z = 0.001f * static_cast<float>(i), a = static_cast<float>(i);
        parents.push_back(i == 1 ? NodeId(0) : NodeId(2 * i - 3));
        positions.push_back({0, 0, z});
        radii.push_back(0.1f);
        parents.push_back(NodeId(2 * i - 1));
        positions.push_back({std::cos(a), std::sin(a), z});
        radii.push_back(0.01f);
    }
    const Skeleton brush(parents, positions, radii);
    const RamificationMesh made = make_ramification(brush);
    expect_spheres(made.control, brush);
    EXPECT_GE(made.report.units, kLaterals / 256);
}

// Every branch starts at the middle of the length of the previous one.
TEST(Ramification, AcceptsDeeplyNestedBranches) {
    constexpr std::uint32_t kDepth = 20'000;
    std::vector<NodeId> parents{NodeId::none(), NodeId(0), NodeId(1)};
    std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    std::vector<float> radii{0.1f, 0.1f, 0.1f};
    for (std::uint32_t d = 1; d <= kDepth; ++d) {
        const Vec3 way = d % 2 == 0 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
        const auto middle = static_cast<std::uint32_t>(parents.size()) - 2;
        const Vec3 from = positions[middle];
        for (std::uint32_t k = 1; k <= 2; ++k) {
            parents.push_back(k == 1 ? NodeId(middle) : NodeId(middle + 2));
            positions.push_back(from + way * static_cast<float>(k));
            radii.push_back(0.1f);
        }
    }
    const Skeleton stairs(parents, positions, radii);
    const RamificationMesh made = make_ramification(stairs);
    EXPECT_EQ(made.report.branches, kDepth + 1);
    expect_spheres(made.control, stairs);
}

TEST(Ramification, IsBitIdenticalForAnyNumberOfThreads) {
    const Skeleton tree = random_tree(500, 3);
    const RamificationMesh one = make_ramification(tree, {}, {}, {.threads = 1});
    const RamificationMesh many = make_ramification(tree, {}, {}, {.threads = 5});
    EXPECT_TRUE(one.control.cage.positions == many.control.cage.positions);
    EXPECT_TRUE(one.control.cage.quads == many.control.cage.quads);
    EXPECT_TRUE(one.control.anchors == many.control.anchors);
}

TEST(Ramification, RejectsAnOpenBaseAndOptionsOutOfRange) {
    const Skeleton tree = whorl({0});
    EXPECT_EQ(test::error_of([&] { make_ramification(tree, {}, {.base = BaseShape::open}); }),
              "mesh: ramifications make closed surfaces only; choose base flat or round");
    EXPECT_THROW(make_ramification(tree, {.additional_threshold = -1}), InvalidInput);
}

}  // namespace
}  // namespace coppice
