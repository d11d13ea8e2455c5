#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "coppice/base/disjoint_sets.h"
#include "coppice/mesh/topology.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/tetra/lattice/lattice.h"
#include "coppice/tetra/march/held_internal.h"
#include "coppice/tetra/march/march.h"
#include "tetra/lattice_support.h"
#include "tetra/support.h"
#include "tetra/surfaces.h"
#include "zoo.h"

// Tests that the axes of a skeleton stay connected: Lattice::passing, and march with InsideAxes.

namespace coppice {
namespace {

using lattice_test::collect_segments;
using lattice_test::contains;
using lattice_test::get_corners;

/// A field with one constant value.
struct Constant {
    float value;
    float level() const { return 0; }
    void sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
        for (std::size_t i = 0; i < points.size(); ++i) out[i] = {value, {}};
    }
};

/// Positive inside balls.
struct Balls {
    std::vector<std::array<float, 4>> balls;  ///< center and radius; a negative radius makes a hollow
    float level() const { return 0; }
    void sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
        for (std::size_t i = 0; i < points.size(); ++i) {
            float value = -1;
            for (const auto& [x, y, z, r] : balls) {
                const float deep = std::abs(r) - distance(points[i], Vec3{x, y, z});
                value = r > 0 ? std::max(value, deep) : std::min(value, -deep);
            }
            out[i] = {value, {}};
        }
    }
};

std::vector<std::pair<std::string, Skeleton>> scenes() {
    std::vector<std::pair<std::string, Skeleton>> out;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        if (skeleton.size() < 300) out.emplace_back(name, skeleton);
    }
    out.emplace_back("random_tree", random_tree(100, 3));
    out.emplace_back("random_hard", random_tree(100, 4, true));
    return out;
}

std::size_t tree_count(const Skeleton& skeleton) {
    std::size_t count = 0;
    for (const NodeId n : nodes(skeleton)) count += skeleton.is_root(n) ? 1 : 0;
    return count;
}

CompressedRows<std::uint32_t> all_pass(const TetraMesh& mesh, std::uint32_t segments) {
    return compress_rows<std::uint32_t>(mesh.region_count(), [&](const auto& put) {
        for (std::size_t r = 0; r < mesh.region_count(); ++r) {
            for (std::uint32_t s = 0; s < segments; ++s) put(r, s);
        }
    });
}

TEST(LatticeAxes, AreListedByTheRegionsThatTheyPass) {
    for (const float inside : {0.0f, 0.8f}) {
        for (const float cell : {0.5f, 2.0f}) {
            const std::vector<Segment> segments = collect_segments(random_tree(40, 5, true));
            const Lattice lattice(segments, {.cell = cell, .inside = inside});
            const TetraMesh& mesh = lattice.mesh();
            ASSERT_EQ(lattice.passing().size(), mesh.region_count());
            std::vector<std::uint32_t> covered(segments.size());
            constexpr std::uint32_t kSamples = 20;
            for (std::uint32_t r = 0; r < mesh.region_count(); ++r) {
                Box3 box;
                for (std::uint32_t t = mesh.first[r]; t < mesh.first[r + 1]; ++t) {
                    for (const std::uint32_t v : mesh.tetra[t]) box.extend(mesh.positions[v]);
                }
                const auto named = lattice.passing()[r];
                for (std::uint32_t s = 0; s < segments.size(); ++s) {
                    if (!box.overlaps(capsule_box(segments[s].a, segments[s].b, 0))) continue;
                    for (std::uint32_t k = 0; k < kSamples; ++k) {
                        const double part = (k + 0.5) / kSamples;
                        const Vec3d p = lerp(Vec3d(segments[s].a), Vec3d(segments[s].b), part);
                        for (std::uint32_t t = mesh.first[r]; t < mesh.first[r + 1]; ++t) {
                            if (!contains(get_corners(mesh, mesh.tetra[t]), p, true)) continue;
                            ++covered[s];
                            EXPECT_TRUE(std::ranges::binary_search(named, s));
                        }
                    }
                }
            }
            for (const std::uint32_t found : covered) EXPECT_EQ(found, kSamples);
        }
    }
}

TEST(HeldVertices, OfOneAxisAreConnectedByFineEdges) {
    for (const int levels : {0, 1, 2}) {
        for (const auto& [name, skeleton] : scenes()) {
            SCOPED_TRACE(name + ", level " + std::to_string(levels));
            const std::vector<Segment> segments = collect_segments(skeleton);
            const Lattice lattice(segments, {.cell = 3});
            const TetraRefinement refinement(lattice.mesh(), levels);
            const auto held = tetra_internal::hold_axes(refinement, {segments, lattice.passing()}, {});
            DisjointSets sets(refinement.vertex_count());
            for (std::uint32_t t = 0; t < lattice.mesh().tetra.size(); ++t) {
                for (const auto& [a, b] : refinement.pattern(t).edges) {
                    const std::uint32_t v = refinement.vertex(t, a), w = refinement.vertex(t, b);
                    if (held.bits.test(v) && held.bits.test(w)) sets.join(v, w);
                }
            }
            std::set<std::uint32_t> found;
            for (const auto& h : held.list) found.insert(sets.find(h.vertex));
            // Trees that are close to each other may share vertices.
            EXPECT_LE(found.size(), tree_count(skeleton));
            EXPECT_GE(found.size(), 1u);
            EXPECT_EQ(held.of_each_set.size() == 1, tree_count(skeleton) == 1);
        }
    }
}

TEST(MarchAxes, HaveAtMostOneComponentPerTreeBelowTheIsoValue) {
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    for (const auto& [value, snap] : {std::pair(-1.0f, 0.45f), std::pair(kNaN, 0.0f)}) {
        for (const auto& [name, skeleton] : scenes()) {
            SCOPED_TRACE(name);
            const std::vector<Segment> segments = collect_segments(skeleton);
            Lattice lattice(segments, {.cell = 2});
            const Constant field{value};
            MarchResult r;
            do {
                r = march(lattice.mesh(), FieldRef(field), {segments, lattice.passing()},
                          {.levels = 1, .snap = snap});
            } while (!r.open.empty() && lattice.grow(r.open));
            ASSERT_TRUE(r.open.empty());
            const TopologyReport topo = topology(polygons(r.mesh));
            EXPECT_TRUE(topo.watertight());
            EXPECT_LE(topo.components, tree_count(skeleton));
            EXPECT_GE(topo.components, 1u);
            EXPECT_GT(volume(r.mesh), 0);
        }
    }
}

TEST(MarchAxes, HaveAboutTheirRadiusIfTheFieldIsBelowTheIsoValue) {
    const std::vector<Segment> segments{{{0, 0, 0}, {4, 1, 2}, 0.2f, 0.2f}};
    Lattice lattice(segments, {.cell = 5});
    const Constant field{-1};
    MarchResult r;
    do {
        r = march(lattice.mesh(), FieldRef(field), {segments, lattice.passing()}, {.levels = 1});
    } while (!r.open.empty() && lattice.grow(r.open));
    const Vec3d a(segments[0].a), along = Vec3d(segments[0].b) - a;
    double sum = 0;
    for (const Vec3 p : r.mesh.positions)
        sum += length(Vec3d(p) - a - along * closest_parameter(Vec3d(p), a, along));
    // At least half the radius; half an edge may be less than the whole radius.
    const double mean = sum / static_cast<double>(r.mesh.positions.size());
    EXPECT_GT(mean, 0.1);
    EXPECT_LT(mean, 0.22);
}

TEST(MarchAxes, ComponentsWithoutAnAxisAndHollowsAreRemoved) {
    const TetraMesh mesh = bcc_block({12, 6, 6}, 0.5f, {0, 0, 0});
    // A ball with a hollow in it, and a separate ball.
    const Balls field{{{1.6f, 1.5f, 1.5f, 1.2f}, {1.6f, 1.5f, 1.5f, -0.6f}, {4.5f, 1.5f, 1.5f, 0.7f}}};
    EXPECT_EQ(topology(polygons(march(mesh, FieldRef(field)).mesh)).components, 3u);
    const std::vector<Segment> first{{{0.7f, 1.5f, 1.5f}, {0.8f, 1.5f, 1.5f}, 0.1f, 0.1f}};
    const CompressedRows<std::uint32_t> passing = all_pass(mesh, 2);
    const MarchResult one = march(mesh, FieldRef(field), {first, all_pass(mesh, 1)});
    EXPECT_EQ(one.report.dropped, 2u);
    EXPECT_NEAR(volume(one.mesh), 4.18879 * 1.2 * 1.2 * 1.2, 0.4);
    EXPECT_TRUE(topology(polygons(one.mesh)).watertight());
    EXPECT_EQ(topology(polygons(one.mesh)).vertices, one.mesh.positions.size());
    std::vector<Segment> both = first;
    both.push_back({{4.4f, 1.5f, 1.5f}, {4.6f, 1.6f, 1.5f}, 0.1f, 0.1f});
    const MarchResult two = march(mesh, FieldRef(field), {both, passing});
    EXPECT_EQ(two.report.dropped, 1u);
    EXPECT_EQ(topology(polygons(two.mesh)).components, 2u);
}

}  // namespace
}  // namespace coppice
