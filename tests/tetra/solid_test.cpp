#include <gtest/gtest.h>

#include <map>
#include <string>

#include "coppice/mesh/topology.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/tetra/lattice/lattice.h"
#include "coppice/tetra/march/march.h"
#include "tetra/lattice_support.h"
#include "tetra/surfaces.h"
#include "zoo.h"

// Tests of the tetrahedra inside a surface.

namespace coppice {
namespace {

using lattice_test::collect_segments;

/// The height of the closest round cone: 1 at the axis, 0 at the radius.
struct Cones {
    std::vector<Segment> segments;
    float level() const { return 0; }
    void sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
        for (std::size_t i = 0; i < points.size(); ++i) {
            out[i] = {-10, {}};
            for (const Segment& s : segments) {
                const auto closest = round_cone<double>(Vec3d(s.a), Vec3d(s.b), s.radius_a, s.radius_b)
                                         .closest_point(Vec3d(points[i]));
                const auto value = static_cast<float>(1 - closest.distance() / closest.radius);
                if (value > out[i].value)
                    out[i] = {value, Vec3(closest.offset *
                                          (-1 / (closest.radius * std::max(closest.distance(), 1e-9))))};
            }
        }
    }
};

/// Returns a triangle rotated such that its smallest corner is first.
std::array<std::uint32_t, 3> turned(std::array<std::uint32_t, 3> t) {
    std::rotate(t.begin(), std::ranges::min_element(t), t.end());
    return t;
}

void expect_fills(const MarchResult& r) {
    ASSERT_FALSE(r.solid.tetra.empty());
    ASSERT_GE(r.solid.positions.size(), r.mesh.positions.size());
    EXPECT_TRUE(std::equal(r.mesh.positions.begin(), r.mesh.positions.end(), r.solid.positions.begin()));
    // Faces shared by two tetrahedra occur in both orientations; the others are the surface.
    std::map<std::array<std::uint32_t, 3>, int> faces;
    double sum = 0;
    std::size_t flat = 0;
    std::vector<bool> used(r.solid.positions.size());
    for (const auto& t : r.solid.tetra) {
        const auto at = [&](std::size_t i) { return Vec3d(r.solid.positions[t[i]]); };
        const double six = volume6(at(0), at(1), at(2), at(3));
        flat += six > 0 ? 0 : 1;
        sum += six / 6;
        for (const auto& f : kTetraFaces) ++faces[turned({t[f[0]], t[f[1]], t[f[2]]})];
        for (const std::uint32_t v : t) used[v] = true;
    }
    EXPECT_EQ(flat, 0u);
    EXPECT_TRUE(std::ranges::all_of(used, [](bool b) { return b; }));
    std::vector<std::array<std::uint32_t, 3>> left;
    for (const auto& [face, count] : faces) {
        EXPECT_EQ(count, 1);
        if (!faces.contains(turned({face[0], face[2], face[1]}))) left.push_back(face);
    }
    std::vector<std::array<std::uint32_t, 3>> surface;
    for (const Triangle& t : r.mesh.triangles) surface.push_back(turned({t[0], t[1], t[2]}));
    std::ranges::sort(surface);
    EXPECT_EQ(left, surface);
    EXPECT_NEAR(sum / volume(r.mesh), 1, 1e-4);
}

MarchResult filled(const std::vector<Segment>& segments, const MarchOptions& options, float cell) {
    Lattice lattice(segments, {.cell = cell, .inside = 0});
    const Cones field{segments};
    MarchResult r;
    do {
        r = march_solid(lattice.mesh(), FieldRef(field), {segments, lattice.passing()}, options);
    } while (!r.open.empty() && lattice.grow(r.open));
    return r;
}

TEST(MarchSolid, FillsTheSurfaceWithConformingTetrahedra) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        if (skeleton.size() > 7) continue;
        const std::vector<Segment> segments = collect_segments(skeleton);
        for (const auto& [levels, snap] : {std::pair(0, 0.0f), std::pair(1, 0.45f)}) {
            SCOPED_TRACE(name + ", level " + std::to_string(levels) + ", snap " + std::to_string(snap));
            expect_fills(filled(segments, {.levels = levels, .snap = snap}, 2.0f));
        }
    }
}

TEST(MarchSolid, HasFewSlivers) {
    const MarchResult r = filled(collect_segments(random_tree(8, 3)), {.levels = 1}, 2.8f);
    std::vector<double> least;
    for (const auto& t : r.solid.tetra) {
        std::array<Vec3d, 4> corners;
        for (std::size_t i = 0; i < 4; ++i) corners[i] = Vec3d(r.solid.positions[t[i]]);
        least.push_back(lattice_test::dihedral_range(corners)[0]);
    }
    std::ranges::sort(least);
    EXPECT_GT(least[least.size() / 100], 10);
}

TEST(MarchSolid, IsBitIdenticalForAnyNumberOfThreads) {
    const std::vector<Segment> segments = collect_segments(random_tree(8, 4, true));
    const Lattice lattice(segments, {.cell = 2, .inside = 0});
    const Cones field{segments};
    const InsideAxes axes{segments, lattice.passing()};
    const MarchResult one = march_solid(lattice.mesh(), FieldRef(field), axes, {.levels = 1}, {.threads = 1});
    const MarchResult many =
        march_solid(lattice.mesh(), FieldRef(field), axes, {.levels = 1}, {.threads = 5});
    EXPECT_EQ(one.solid.tetra, many.solid.tetra);
    EXPECT_TRUE(one.solid.positions == many.solid.positions);
    EXPECT_EQ(one.open, many.open);
}

TEST(MarchSolid, ExcludesBodiesWithoutAnAxis) {
    // A second branch that is not among the axes.
    std::vector<Segment> both{{{0, 0, 0}, {0, 0, 2}, 0.5f, 0.5f}, {{3, 0, 0}, {3, 0, 2}, 0.5f, 0.5f}};
    Lattice lattice(both, {.cell = 2, .inside = 0});
    const Cones field{both};
    const std::vector<Segment> first{both[0]};
    MarchResult r;
    do {
        const auto passing =
            compress_rows<std::uint32_t>(lattice.mesh().region_count(), [&](const auto& put) {
                for (std::size_t region = 0; region < lattice.mesh().region_count(); ++region)
                    put(region, 0u);
            });
        r = march_solid(lattice.mesh(), FieldRef(field), {first, passing}, {.levels = 1});
    } while (!r.open.empty() && lattice.grow(r.open));
    EXPECT_EQ(r.report.dropped, 1u);
    expect_fills(r);
    EXPECT_EQ(topology(polygons(r.mesh)).components, 1u);
}

}  // namespace
}  // namespace coppice
