#include "coppice/tetra/polyhedron/polyhedron.h"

#include <gtest/gtest.h>

#include <string>

#include "coppice/base/error.h"
#include "coppice/base/hash.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/tetra/lattice/cone_internal.h"
#include "coppice/tetra/lattice/refinement.h"
#include "tetra/lattice_support.h"
#include "tetra/support.h"
#include "zoo.h"

namespace coppice {
namespace {

using lattice_test::contains;
using lattice_test::get_corners;

Polyhedron around(const Skeleton& skeleton, const Context& ctx = {}) {
    return Polyhedron(skeleton, segment_axes(skeleton), {}, ctx);
}

Skeleton rod(std::uint32_t segments, float step, float radius) {
    std::vector<NodeId> parent{NodeId::none()};
    std::vector<Vec3> position{{0, 0, 0}};
    for (std::uint32_t i = 1; i <= segments; ++i) {
        parent.emplace_back(i - 1);
        position.push_back({0.3f * step * static_cast<float>(i), 0, step * static_cast<float>(i)});
    }
    return {parent, position, std::vector<float>(segments + 1, radius)};
}

std::vector<std::pair<std::string, Skeleton>> scenes() {
    std::vector<std::pair<std::string, Skeleton>> out;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        if (skeleton.size() < 500) out.emplace_back(name, skeleton);
    }
    out.emplace_back("random_tree", random_tree(150, 3));
    out.emplace_back("random_hard", random_tree(150, 4, true));
    return out;
}

/// Calls visit(r, t) for the tetrahedra that contain a point, with their regions.
template <class Visit>
void visit_holders(const TetraMesh& mesh, Vec3d p, const Visit& visit) {
    for (std::uint32_t r = 0; r < mesh.region_count(); ++r) {
        for (std::uint32_t t = mesh.first[r]; t < mesh.first[r + 1]; ++t) {
            if (contains(get_corners(mesh, mesh.tetra[t]), p)) visit(r, t);
        }
    }
}

TEST(Polyhedron, IsConformingForEverySkeleton) {
    for (const auto& [name, skeleton] : scenes()) {
        SCOPED_TRACE(name);
        const Polyhedron polyhedron = around(skeleton);
        const TetraMesh& mesh = polyhedron.mesh();
        ASSERT_GT(mesh.tetra.size(), 0u);
        ASSERT_EQ(mesh.first.back(), mesh.tetra.size());
        EXPECT_EQ(polyhedron.report().tetra, mesh.tetra.size());
        ASSERT_EQ(polyhedron.passing().size(), mesh.region_count());
        for (const Tetra& t : mesh.tetra) ASSERT_GT(volume6(mesh, t), 0);
        // Rejects tetrahedra that share a face with more than one other.
        EXPECT_NO_THROW(TetraRefinement(mesh, 0));
    }
}

TEST(Polyhedron, ContainsEverySurfaceAndEveryAxis) {
    for (const auto& [name, skeleton] : scenes()) {
        if (skeleton.size() > 80) continue;
        SCOPED_TRACE(name);
        const Polyhedron polyhedron = around(skeleton);
        const std::vector<Segment> axes = segment_axes(skeleton);
        for (std::uint32_t s = 0; s < axes.size(); ++s) {
            const RoundCone cone = growing_cone(axes[s], {});
            const CounterRandom random(s, 5);
            for (std::uint64_t k = 0; k < 20; ++k) {
                const double t = random.uniform(5 * k);
                const Vec3d way{random.uniform(5 * k + 1, -1, 1), random.uniform(5 * k + 2, -1, 1),
                                random.uniform(5 * k + 3, -1, 1)};
                for (const double far : {0.0, 1.1}) {
                    const Vec3d p = cone.point(t) + normalized(way) * (far * cone.radius(t));
                    unsigned held = 0;
                    visit_holders(polyhedron.mesh(), p, [&](std::uint32_t r, std::uint32_t) {
                        ++held;
                        if (far == 0) {
                            EXPECT_TRUE(std::ranges::binary_search(polyhedron.passing()[r], s));
                        }
                    });
                    EXPECT_GE(held, 1u);
                }
            }
        }
    }
}

TEST(Polyhedron, TetrahedraDoNotOverlap) {
    for (const char* name : {"random_hard_2", "forest", "soma"}) {
        SCOPED_TRACE(name);
        const Polyhedron polyhedron = around(zoo_skeleton(name));
        const TetraMesh& mesh = polyhedron.mesh();
        const CounterRandom random(1, 2);
        for (std::uint64_t k = 0; k < 500; ++k) {
            const auto t = static_cast<std::size_t>(random.uniform(4 * k, 0, double(mesh.tetra.size())));
            const auto c = get_corners(mesh, mesh.tetra[t]);
            const double x = random.uniform(4 * k + 1, 0.01, 1), y = random.uniform(4 * k + 2, 0.01, 1),
                         z = random.uniform(4 * k + 3, 0.01, 1), w = 0.1;
            unsigned held = 0;
            visit_holders(mesh, (x * c[0] + y * c[1] + z * c[2] + w * c[3]) * (1 / (x + y + z + w)),
                          [&](std::uint32_t, std::uint32_t) { ++held; });
            EXPECT_EQ(held, 1u);
        }
    }
}

TEST(Polyhedron, DividesABoxIntoFive) {
    for (const std::uint32_t segments : {1u, 2u, 10u}) {
        const Polyhedron polyhedron = around(rod(segments, 5, 1));
        EXPECT_EQ(polyhedron.report().sections, segments + 1);
        EXPECT_EQ(polyhedron.report().auxiliary, 0u);
        EXPECT_EQ(polyhedron.report().added, 0u);
        EXPECT_EQ(polyhedron.report().tetra, 5 * segments);
    }
}

TEST(Polyhedron, HasSeveralTetrahedraPerSegment) {
    // Rhus of [Zhu2013] has 2,064; the paper does not state its number of segments.
    const PolyhedronReport r = around(random_tree(288, 1)).report();
    EXPECT_GT(r.tetra, 5 * 288u);
    EXPECT_LT(r.tetra, 18 * 288u);
    EXPECT_GT(r.auxiliary, 0u);
}

TEST(Polyhedron, GrowsAcrossFacesUntilItFillsItsBox) {
    Polyhedron polyhedron = around(random_tree(30, 1));
    const std::size_t before = polyhedron.mesh().tetra.size();
    const auto hull = [&] {
        std::vector<TetraFace> out;
        const TetraRefinement refinement(polyhedron.mesh(), 0);
        for (std::uint32_t t = 0; t < polyhedron.mesh().tetra.size(); ++t) {
            for (std::uint32_t group = 10; group < 14; ++group) {
                if (refinement.on_hull(t, group)) out.push_back({t, 0});
            }
        }
        for (std::size_t i = 0, n = out.size(); i < n; ++i) {
            for (std::uint32_t face = 1; face < 4; ++face) out.push_back({out[i].tetra, face});
        }
        return out;
    };
    EXPECT_FALSE(polyhedron.grow({}));
    ASSERT_TRUE(polyhedron.grow(hull()));
    EXPECT_GT(polyhedron.mesh().tetra.size(), before);
    EXPECT_EQ(polyhedron.report().tetra, polyhedron.mesh().tetra.size());
    EXPECT_NO_THROW(TetraRefinement(polyhedron.mesh(), 0));
    while (polyhedron.grow(hull())) {
    }
    double volume = 0;
    Box3 box;
    for (const Vec3 p : polyhedron.mesh().positions) box.extend(p);
    for (const Tetra& t : polyhedron.mesh().tetra) volume += volume6(polyhedron.mesh(), t) / 6;
    const Vec3d size = Vec3d(box.high) - Vec3d(box.low);
    EXPECT_NEAR(volume / (size.x * size.y * size.z), 1, 1e-6);
}

TEST(Polyhedron, RejectsSegmentsTooThinForTheirCoordinates) {
    const Skeleton thin({NodeId::none(), NodeId(0)}, {{0, 0, 0}, {0, 0, 100}}, {1e-6f, 1e-6f});
    try {
        around(thin);
        FAIL();
    } catch (const InvalidInput& e) {
        EXPECT_NE(std::string(e.what()).find("segment 0 has a radius of 1e-06 m"), std::string::npos);
    }
    const Skeleton huge({NodeId::none(), NodeId(0)}, {{0, 0, 0}, {0, 0, 3e38f}}, {1e38f, 1e38f});
    EXPECT_THROW(around(huge), InvalidInput);
}

TEST(Polyhedron, IsBitIdenticalForAnyNumberOfThreads) {
    const Skeleton skeleton = random_tree(600, 4, true);
    const auto hash = [&](unsigned threads) {
        const Polyhedron p = around(skeleton, {.threads = threads});
        return Hash()
            .add(std::span<const Vec3>(p.mesh().positions))
            .add(std::span<const Tetra>(p.mesh().tetra))
            .add(std::span<const std::uint32_t>(p.passing().items))
            .value();
    };
    EXPECT_EQ(hash(1), hash(2));
    EXPECT_EQ(hash(1), hash(7));
}

}  // namespace
}  // namespace coppice
