// Surfaces do not depend on the unit of length: meshing contains no absolute size.

#include <gtest/gtest.h>

#include <cmath>

#include "coppice/base/random.h"
#include "coppice/mesh/topology.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/raw.h"

namespace coppice {
namespace {

/// A random tree of about 20 nodes near `base` with radii of about 1, including bends and acute forks.
std::vector<RawNode> random_nodes(std::uint64_t seed, Vec3d base) {
    const CounterRandom random(seed, 0);
    std::uint64_t drawn = 0;
    const auto next = [&] { return random.uniform(drawn++); };
    const auto size = 4 + static_cast<std::int64_t>(20 * next());
    std::vector<RawNode> nodes{{1, -1, base, 1, 1}};
    for (std::int64_t i = 1; i < size; ++i) {
        const bool goes_on = next() < 0.75;
        const RawNode& from = nodes[goes_on ? nodes.size() - 1 : static_cast<std::size_t>(next() * i)];
        const Vec3d step{next() - 0.5, next() - 0.5, next() - 0.2};
        nodes.push_back({i + 1, from.id, from.position + step * (8 * next() * from.radius),
                         from.radius * (0.6 + 0.4 * next()), static_cast<std::uint32_t>(i + 1)});
    }
    return nodes;
}

Skeleton scaled(std::vector<RawNode> nodes, double factor) {
    for (RawNode& n : nodes) {
        n.position = n.position * factor;
        n.radius *= factor;
    }
    return repair(nodes, "made up").skeleton;
}

QuadSurface make_surface(const Skeleton& skeleton, const MeshOptions& options = {}) {
    return mesh_skeleton(skeleton, options).quads();
}

TEST(Scale, PowersOfTwoScaleTheSurfaceExactly) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        for (const Vec3d base : {Vec3d{}, Vec3d{1e5, 2e4, -3e5}}) {
            const std::vector<RawNode> nodes = random_nodes(seed, base);
            const QuadSurface one = make_surface(scaled(nodes, 1));
            // Beyond, squares of gradients, which are per length, come close to the limits of floats.
            for (const int power : {-30, -20, -10, -1, 3, 10, 20}) {
                SCOPED_TRACE(testing::Message() << "seed " << seed << " at " << base.x << " by 2^" << power);
                const double factor = std::ldexp(1.0, power);
                const QuadSurface other = make_surface(scaled(nodes, factor));
                ASSERT_EQ(other.mesh.origin, one.mesh.origin * factor);
                ASSERT_EQ(other.mesh.quads, one.mesh.quads);
                ASSERT_EQ(other.mesh.positions.size(), one.mesh.positions.size());
                for (std::size_t v = 0; v < one.mesh.positions.size(); ++v)
                    ASSERT_EQ(other.mesh.positions[v], one.mesh.positions[v] * static_cast<float>(factor))
                        << v;
            }
        }
    }
}

// Coordinates times a power of ten are rounded. Where faces cross they are remeshed on a lattice, on which
// the smallest difference may change the faces, so remeshing is disabled here.
TEST(Scale, PowersOfTenPreserveTheFacesUpToRounding) {
    MeshOptions options;
    options.remesh_rounds = 0;
    int seeds_apart = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const std::vector<RawNode> nodes = random_nodes(seed, {1e5, 2e4, -3e5});
        const QuadSurface one = make_surface(scaled(nodes, 1), options);
        bool is_apart = false;
        for (const double factor : {1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9}) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << " times " << factor);
            const QuadSurface other = make_surface(scaled(nodes, factor), options);
            ASSERT_EQ(other.mesh.quads, one.mesh.quads);
            const Vec3d shift = other.mesh.origin * (1 / factor) - one.mesh.origin;
            for (std::size_t v = 0; v < one.mesh.positions.size(); ++v) {
                const Vec3d there = Vec3d(other.mesh.positions[v]) * (1 / factor) + shift;
                is_apart = is_apart || !(distance(there, Vec3d(one.mesh.positions[v])) < 1e-4);
            }
        }
        seeds_apart += is_apart ? 1 : 0;
    }
    // Whether a segment at the limit of its influence presses on a region depends on rounding.
    EXPECT_LE(seeds_apart, 1);
}

// Radii far below the resolution of floats at these positions.
TEST(Scale, NodesBeyondFloatPrecisionHaveAWatertightSurface) {
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        std::vector<NodeId> parent;
        std::vector<Vec3> position;
        std::vector<float> radius;
        for (const RawNode& n : random_nodes(seed, {})) {
            parent.push_back(n.parent < 0 ? NodeId::none()
                                          : NodeId(static_cast<std::uint32_t>(n.parent - 1)));
            position.push_back(Vec3{1e7f, 2e6f, -3e7f} + Vec3(n.position));
            radius.push_back(static_cast<float>(n.radius));
        }
        const TopologyReport t = topology(make_surface(Skeleton(parent, position, radius)).mesh);
        EXPECT_TRUE(t.watertight()) << seed;
    }
}

}  // namespace
}  // namespace coppice
