#include "coppice/tetra/march/march.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <map>
#include <set>

#include "coppice/mesh/topology.h"
#include "coppice/tetra/march/snapping_internal.h"
#include "described_options.h"
#include "tetra/support.h"
#include "tetra/surfaces.h"

namespace coppice {
namespace {

using Local = TetraPattern::Local;
using tetra_internal::Samples;

Samples sampled(const TetraRefinement& refinement, FieldRef field, float snap) {
    const tetra_internal::HeldVertices none{tetra_internal::RankedBits(refinement.vertex_count()), {}, {}};
    return tetra_internal::sample_vertices(refinement, field, snap, none, {}, {});
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

void expect_sound(const MarchResult& r) {
    ASSERT_TRUE(r.open.empty());
    ASSERT_FALSE(r.mesh.triangles.empty());
    const TopologyReport topo = topology(polygons(r.mesh));
    EXPECT_TRUE(topo.watertight()) << topo.open_edges << " open, " << topo.non_manifold_edges << " and "
                                   << topo.non_manifold_vertices << " not manifold, "
                                   << topo.misoriented_edges << " misoriented";
    EXPECT_EQ(topo.vertices, r.mesh.positions.size()) << "a vertex without a triangle";
    EXPECT_TRUE(std::ranges::all_of(r.mesh.positions, [](Vec3 p) { return is_finite(p); }));
}

/// Random values on a grid of cells, constant in each, and below the iso value near the hull of [0, side]^3.
AnyField noise(std::uint64_t seed, float side, float per_cell, float low = -1, float high = 1) {
    return {
        [=](Vec3 p) {
            const float margin = 1.01f;
            if (std::min({p.x, p.y, p.z}) < margin || std::max({p.x, p.y, p.z}) > side - margin) return -1.0f;
            const auto q = [&](float x) { return static_cast<std::uint64_t>(x * per_cell); };
            const CounterRandom random(seed, 3);
            return static_cast<float>(random.uniform((q(p.x) * 4096 + q(p.y)) * 4096 + q(p.z), low, high));
        },
        0, 0.03f};
}

// All faces of a single tetrahedron are on the hull, so that march() would reject it: sampling and extraction
// only.
TEST(March, CutsOneTetrahedronInAllSixteenCases) {
    const TetraMesh mesh = one_tetra();
    for (std::uint32_t inside = 0; inside < 16; ++inside) {
        SCOPED_TRACE(inside);
        // A linear field: 1 at the corners inside, -3 at the others, so that edges are cut at a quarter.
        const auto at = [&](std::uint32_t i) { return (inside >> i & 1) != 0 ? 1.0f : -3.0f; };
        const AnyField field{[&](Vec3 p) {
            return at(0) + p.x * (at(1) - at(0)) + p.y * (at(2) - at(0)) + p.z * (at(3) - at(0));
        }};
        const TetraRefinement refinement(mesh, 0);
        Samples samples = sampled(refinement, FieldRef(field), 0);
        const auto [cut, solid, crossed] = tetra_internal::extract(
            refinement, FieldRef(field), samples, {tetra_internal::CrossedTetra(refinement, samples, {}), {}},
            0, false, {});
        const int count = std::popcount(inside);
        const std::size_t edges = count == 0 || count == 4 ? 0 : count == 2 ? 4 : 3;
        EXPECT_EQ(cut.positions.size(), edges);
        EXPECT_EQ(cut.triangles.size(), edges == 0 ? 0 : edges - 2);
        EXPECT_EQ(crossed, edges == 0 ? 0u : 1u);
        std::set<std::array<float, 3>> found, expected;
        for (const Vec3 p : cut.positions) found.insert({p.x, p.y, p.z});
        for (std::uint32_t a = 0; a < 4; ++a) {
            for (std::uint32_t b = 0; b < 4; ++b) {
                if ((inside >> a & 1) == 0 || (inside >> b & 1) != 0) continue;
                const Vec3 p = lerp(mesh.positions[a], mesh.positions[b], 0.25f);
                expected.insert({p.x, p.y, p.z});
            }
        }
        EXPECT_EQ(found, expected);
        for (const Triangle& t : cut.triangles) {
            for (std::uint32_t v = 0; v < 4; ++v) {
                const double side = volume6(Vec3d(cut.positions[t[0]]), Vec3d(cut.positions[t[1]]),
                                            Vec3d(cut.positions[t[2]]), Vec3d(mesh.positions[v]));
                EXPECT_EQ(side < 0, (inside >> v & 1) != 0) << "vertex " << v;
            }
        }
    }
}

TEST(March, CornersOnTheSurfaceReplaceCuts) {
    for (std::uint32_t inside = 0; inside < 16; ++inside) {
        for (std::uint32_t on = 0; on < 16; ++on) {
            if ((inside & on) != 0) continue;
            SCOPED_TRACE(testing::Message() << inside << " inside, " << on << " on");
            const auto& cut = tetra_internal::kCuts[16 * inside + on];
            const int in = std::popcount(inside), at = std::popcount(on), out = 4 - in - at;
            // Cut edges, and corners on the surface with an inner neighbour and another neighbour off the
            // surface.
            const int corners = in == 0 || in == 4 ? 0 : in * out + (in + at == 4 && in > 1 ? 0 : at);
            EXPECT_EQ(cut.size, corners >= 3 ? corners : 0);
            std::set<int> seen;
            for (std::size_t i = 0; i < cut.size; ++i) {
                const int c = cut.corners[i];
                EXPECT_TRUE(seen.insert(c).second);
                if (c >= tetra_internal::kCutVertex) {
                    EXPECT_NE(on >> (c - tetra_internal::kCutVertex) & 1, 0u);
                } else {
                    const std::uint32_t ends = 1u << kTetraEdges[c][0] | 1u << kTetraEdges[c][1];
                    EXPECT_EQ(std::popcount(ends & inside), 1);
                    EXPECT_EQ(ends & on, 0u);
                }
            }
        }
    }
}

/// Reference implementation of marching tetrahedra: a map from edges to vertices.
TriMesh march_plainly(const TetraMesh& fine, const AnyField& field) {
    TriMesh out;
    std::map<std::array<std::uint32_t, 2>, std::uint32_t> vertex_on;
    const auto value = [&](std::uint32_t v) { return field.value(fine.positions[v]); };
    const auto vertex = [&](std::uint32_t a, std::uint32_t b) {
        const std::array<std::uint32_t, 2> key{std::min(a, b), std::max(a, b)};
        const auto [at, is_new] = vertex_on.emplace(key, static_cast<std::uint32_t>(vertex_on.size()));
        if (is_new) {
            const float t = std::clamp(value(key[0]) / (value(key[0]) - value(key[1])), 0.01f, 0.99f);
            out.positions.push_back(lerp(fine.positions[key[0]], fine.positions[key[1]], t));
        }
        return at->second;
    };
    const auto add = [&](std::array<std::uint32_t, 3> t, std::uint32_t inner) {
        if (volume6(Vec3d(out.positions[t[0]]), Vec3d(out.positions[t[1]]), Vec3d(out.positions[t[2]]),
                    Vec3d(fine.positions[inner])) > 0)
            std::swap(t[1], t[2]);
        out.triangles.push_back(t);
    };
    for (const Tetra& t : fine.tetra) {
        std::vector<std::uint32_t> in, outer;
        for (const std::uint32_t v : t) (value(v) > 0 ? in : outer).push_back(v);
        if (in.size() == 1)
            add({vertex(in[0], outer[0]), vertex(in[0], outer[1]), vertex(in[0], outer[2])}, in[0]);
        if (in.size() == 3)
            add({vertex(in[0], outer[0]), vertex(in[1], outer[0]), vertex(in[2], outer[0])}, in[0]);
        if (in.size() != 2) continue;
        const std::uint32_t a = vertex(in[0], outer[0]), b = vertex(in[0], outer[1]),
                            c = vertex(in[1], outer[1]), d = vertex(in[1], outer[0]);
        const auto p = [&](std::uint32_t v) { return out.positions[v]; };
        if (distance(p(a), p(c)) < distance(p(b), p(d))) {
            add({a, b, c}, in[0]);
            add({a, c, d}, in[1]);
        } else {
            add({a, b, d}, in[0]);
            add({b, c, d}, in[1]);
        }
    }
    return out;
}

TEST(March, MatchesAReferenceImplementation) {
    const TetraMesh mesh = shuffled(bent(bcc_block({5, 5, 5}, 1, {0, 0, 0}), 0.1f, 21), 22);
    for (int levels = 0; levels <= 2; ++levels) {
        SCOPED_TRACE(levels);
        // Two balls that overlap, with values that are not distances.
        const AnyField field{[](Vec3 p) {
            return std::max(1.1f - distance(p, {2.3f, 2.4f, 2.2f}),
                            0.9f - 1.3f * distance(p, {2.9f, 3.0f, 2.7f}));
        }};
        const MarchResult r = march(mesh, FieldRef(field), {.levels = levels, .snap = 0, .refinements = 0});
        expect_sound(r);
        const TetraRefinement refinement(mesh, levels);
        const TriMesh plain = march_plainly(fine_mesh(refinement), field);
        ASSERT_EQ(r.mesh.positions.size(), plain.positions.size());
        ASSERT_EQ(r.mesh.triangles.size(), plain.triangles.size());
        std::vector<std::uint32_t> same;
        for (const Vec3 p : r.mesh.positions) {
            const auto near =
                std::ranges::min_element(plain.positions, {}, [&](Vec3 q) { return length_squared(q - p); });
            ASSERT_LT(distance(*near, p), 1e-5f);
            same.push_back(static_cast<std::uint32_t>(near - plain.positions.begin()));
        }
        EXPECT_EQ(std::set<std::uint32_t>(same.begin(), same.end()).size(), same.size());
        const auto sorted = [](Triangle t) {
            std::rotate(t.begin(), std::ranges::min_element(t), t.end());
            return t;
        };
        std::set<Triangle> found, expected;
        for (const Triangle& t : r.mesh.triangles) found.insert(sorted({same[t[0]], same[t[1]], same[t[2]]}));
        for (const Triangle& t : plain.triangles) expected.insert(sorted(t));
        EXPECT_EQ(found, expected);
    }
}

TEST(March, MeasuresVolumeAndAreaOfABall) {
    // Fine edges of about half a radius.
    const TetraMesh mesh = bcc_block({6, 6, 6}, 2.3f, {-6.9f, -6.9f, -6.9f});
    const KernelField field = ball_field({0.12f, 0.22f, 0.31f}, 1);
    for (const float snap : {0.0f, 0.4f, 0.5f}) {
        const MarchResult r = march(mesh, FieldRef(field), {.snap = snap});
        expect_sound(r);
        EXPECT_EQ(topology(polygons(r.mesh)).euler, 2);
        double error = 0;
        for (const Vec3 p : r.mesh.positions) error += std::abs(distance(p, field.center) - 1);
        EXPECT_LT(error / static_cast<double>(r.mesh.positions.size()), 0.003);
        // Flat faces with their corners on the sphere: up to 9 % of the volume is missing.
        EXPECT_NEAR(volume(r.mesh), 4.18879, 0.1 * 4.18879);
        EXPECT_NEAR(area(r.mesh), 12.56637, 0.05 * 12.56637);
        EXPECT_EQ(r.report.snapped > 0, snap > 0);
        EXPECT_EQ(r.report.tetra, mesh.tetra.size() * 64);
    }
    const MarchResult fine = march(mesh, FieldRef(field), {.levels = 4});
    // Edges a quarter as long: a sixteenth of the error remains.
    EXPECT_NEAR(volume(fine.mesh), 4.18879, 0.006 * 4.18879);
    EXPECT_NEAR(area(fine.mesh), 12.56637, 0.05 / 16 * 12.56637);
}

TEST(March, SnappingImprovesTheAnglesOfTriangles) {
    const TetraMesh mesh = bcc_block({8, 8, 8}, 1, {-4, -4, -4});
    const KernelField field = ball_field({0.12f, 0.22f, 0.31f}, 2.2f);
    const auto plain = min_angles(march(mesh, FieldRef(field), {.snap = 0}).mesh);
    const auto moved = min_angles(march(mesh, FieldRef(field)).mesh);
    EXPECT_LT(plain[plain.size() / 100], 3);
    EXPECT_GT(moved[moved.size() / 100], 24);
    EXPECT_GT(moved.front(), 14);
}

/// Expects that every tetrahedron with moved vertices keeps its orientation.
void expect_unfolded(const TetraMesh& mesh, FieldRef field, const MarchOptions& options) {
    const TetraRefinement refinement(mesh, options.levels);
    Samples samples = sampled(refinement, field, options.snap);
    TetraMesh fine = fine_mesh(refinement);
    std::vector<double> before;
    for (const Tetra& t : fine.tetra) before.push_back(volume6(fine, t));
    const auto kept = tetra_internal::unsnap_vertices(refinement, samples, {});
    EXPECT_EQ(kept.used.size(), samples.place.size());
    for (std::uint32_t v = 0; v < refinement.vertex_count(); ++v) {
        if (samples.on.test(v)) fine.positions[v] = samples.place[samples.placed.rank(v)];
    }
    for (std::size_t t = 0; t < before.size(); ++t) ASSERT_GT(volume6(fine, fine.tetra[t]), 0.02 * before[t]);
}

TEST(March, IsClosedAndManifoldOnNoise) {
    std::uint64_t freed = 0;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        TetraMesh mesh = bcc_block({5, 5, 5}, 1, {0, 0, 0});
        if (seed % 2 == 1) mesh = shuffled(bent(mesh, 0.12f, seed), seed);
        for (int levels = 0; levels <= (seed < 2 ? 3 : 2); ++levels) {
            for (const float snap : {0.0f, 0.1f, 0.4f, 0.5f}) {
                SCOPED_TRACE(testing::Message()
                             << "seed " << seed << " levels " << levels << " snap " << snap);
                const AnyField field = noise(seed, 5, 1.7f * static_cast<float>(1 << levels));
                const MarchResult r = march(mesh, FieldRef(field), {.levels = levels, .snap = snap});
                if (levels == 0 && r.open.empty() && r.mesh.triangles.empty()) continue;
                expect_sound(r);
                EXPECT_GT(volume(r.mesh), 0);
                freed += r.report.freed;
                if (levels <= 2) expect_unfolded(mesh, FieldRef(field), {.levels = levels, .snap = snap});
            }
        }
    }
    EXPECT_GT(freed, 0u) << "there is no vertex in which two sheets would meet, so the test has no effect";
}

/// Fields as smooth as distances, with many values near the limits of the lattice.
std::vector<std::pair<const char*, AnyField>> nasty_fields() {
    const auto ball = [](Vec3 p, Vec3 c, float r) { return r - distance(p, c); };
    return {
        {"touching balls", {[=](Vec3 p) {
             return std::max(ball(p, {2, 2.5f, 2.5f}, 0.5f), ball(p, {3, 2.5f, 2.5f}, 0.5f));
         }}},
        {"thin sheet", {[=](Vec3 p) {
             return std::min(0.03f - std::abs(p.z - 2.51f), ball(p, {2.5f, 2.5f, 2.5f}, 1.2f));
         }}},
        {"sheets through the lattice's own planes", {[=](Vec3 p) {
             const float wave = 0.125f - std::abs(p.z * 2 - std::round(p.z * 2));
             return std::min(wave, ball(p, {2.5f, 2.5f, 2.5f}, 1.2f));
         }}},
        {"thin gap", {[=](Vec3 p) {
             return std::min(std::abs(p.z - 2.51f) - 0.02f, ball(p, {2.5f, 2.5f, 2.5f}, 1.2f));
         }}},
        {"cone to a point", {[=](Vec3 p) {
             const float x = p.x - 2.5f, y = p.y - 2.5f, z = p.z - 2.5f;
             return std::min(std::abs(z) * 0.6f - std::sqrt(x * x + y * y), 1.0f - std::abs(z));
         }}},
        {"many small balls", {[=](Vec3 p) {
             const auto c = [](float x) { return std::clamp(std::round(x * 5), 7.0f, 18.0f) / 5; };
             return ball(p, {c(p.x), c(p.y), c(p.z)}, 0.1f);
         }}},
        {"values in steps",
         {[=](Vec3 p) {
              return std::round(4 * ball(p, {2.5f, 2.5f, 2.5f}, 1.1f)) / 4;
          },
          0, 0.1f}},
    };
}

TEST(March, SeparatesSheets) {
    const TetraMesh mesh = bcc_block({5, 5, 5}, 1, {0, 0, 0});
    std::uint64_t freed = 0;
    for (const auto& [name, field] : nasty_fields()) {
        for (int levels = 1; levels <= 3; ++levels) {
            for (const float snap : {0.0f, 0.4f, 0.5f}) {
                SCOPED_TRACE(testing::Message() << name << " levels " << levels << " snap " << snap);
                const MarchResult r = march(mesh, FieldRef(field), {.levels = levels, .snap = snap});
                EXPECT_TRUE(r.open.empty());
                freed += r.report.freed;
                if (r.mesh.triangles.empty()) continue;  // thinner than an edge: lost
                expect_sound(r);
                EXPECT_GE(volume(r.mesh), 0);
                if (r.mesh.triangles.size() < 4000) {
                    EXPECT_EQ(crossings(r.mesh), 0u);
                }
            }
        }
    }
    EXPECT_GT(freed, 0u);
}

TEST(March, HasNoSelfIntersectionsOnNoise) {
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
        const TetraMesh mesh = bent(bcc_block({4, 4, 4}, 1, {0, 0, 0}), 0.1f, seed);
        const AnyField field = noise(seed, 4, 2.9f);
        for (const float snap : {0.0f, 0.4f, 0.5f}) {
            const MarchResult r = march(mesh, FieldRef(field), {.levels = 1, .snap = snap});
            expect_sound(r);
            EXPECT_EQ(crossings(r.mesh), 0u);
        }
    }
}

TEST(March, CrossingsFindsAnIntersection) {
    TriMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2f, 0.2f, -1}, {0.3f, 0.2f, 1}, {0.2f, 0.3f, 1}};
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    EXPECT_GT(crossings(mesh), 0u);
}

TEST(March, ReportsOpenFaces) {
    const TetraMesh mesh = bcc_block({4, 4, 4}, 1, {0, 0, 0});
    const auto field = ball_field({0.9f, 2, 2}, 0.8f);
    const MarchResult r = march(mesh, FieldRef(field), {.levels = 3});
    ASSERT_FALSE(r.open.empty());
    EXPECT_TRUE(r.mesh.triangles.empty());
    // Reference result: hull faces with fine vertices on both sides.
    const auto sides = face_sides(mesh);
    std::vector<TetraFace> expected;
    for (std::uint32_t t = 0; t < mesh.tetra.size(); ++t) {
        for (std::uint32_t k = 0; k < 4; ++k) {
            std::array<std::uint32_t, 3> f{};
            for (std::size_t i = 0; i < 3; ++i) f[i] = mesh.tetra[t][kTetraFaces[k][i]];
            const auto p = [&](std::size_t i) { return Vec3d(mesh.positions[f[i]]); };
            int in = 0, all = 0;
            for (int a = 0; a <= 8; ++a) {
                for (int b = 0; a + b <= 8; ++b) {
                    const Vec3d q = p(0) * (a / 8.0) + p(1) * (b / 8.0) + p(2) * ((8 - a - b) / 8.0);
                    in += distance(q, Vec3d(field.center)) < field.radius ? 1 : 0;
                    ++all;
                }
            }
            std::ranges::sort(f);
            if (sides.at(f).size() == 1 && in > 0 && in < all) expected.push_back({t, k});
        }
    }
    EXPECT_EQ(r.open, expected);
}

TEST(March, AcceptsAHullInsideTheSurface) {
    // A shell of tetrahedra around the ball's surface.
    const Vec3 center{3, 3, 3};
    const TetraMesh mesh = bcc_block({6, 6, 6}, 1, {0, 0, 0}, [&](Vec3 p) {
        const float d = distance(p, center);
        return d > 0.9f && d < 2.9f;
    });
    const auto field = ball_field(center, 1.8f);
    const MarchResult r = march(mesh, FieldRef(field));
    expect_sound(r);
    const MarchResult whole = march(bcc_block({6, 6, 6}, 1, {0, 0, 0}), FieldRef(field));
    EXPECT_EQ(r.mesh.triangles.size(), whole.mesh.triangles.size());
    EXPECT_NEAR(volume(r.mesh), volume(whole.mesh), 1e-4);
}

TEST(March, NeverSnapsToTheHull) {
    // The surface is so close to the hull that its vertices would be moved.
    const TetraMesh mesh = bcc_block({4, 4, 4}, 1, {0, 0, 0});
    const AnyField field{[](Vec3 p) { return 1.45f - std::abs(p.z - 2); }};
    const TetraRefinement refinement(mesh, 2);
    const Samples samples = sampled(refinement, FieldRef(field), 0.5f);
    std::size_t moved = 0;
    for (std::uint32_t t = 0; t < mesh.tetra.size(); ++t) {
        for (std::size_t v = 0; v < refinement.pattern(t).weights.size(); ++v) {
            if (!samples.placed.test(refinement.vertex(t, static_cast<Local>(v)))) continue;
            ++moved;
            EXPECT_FALSE(refinement.on_hull(t, refinement.pattern(t).group[v]));
        }
    }
    EXPECT_GT(moved, 0u);
}

/// Counts samples, and those outside the box of their region.
struct RegionField {
    KernelField field;
    std::vector<Box3> boxes;
    std::atomic<std::uint64_t>* outside;
    std::atomic<std::uint64_t>* samples;
    float level() const { return field.level(); }
    void sample(std::uint32_t region, std::span<const Vec3> points, std::span<FieldSample> out) const {
        field.sample(region, points, out);
        *samples += points.size();
        for (const Vec3 p : points) {
            Box3 point;
            point.extend(p);
            *outside += boxes.at(region).inflated(1e-4f).overlaps(point) ? 0 : 1;
        }
    }
};

TEST(March, SamplesEveryRegionInsideItself) {
    const TetraMesh mesh = bcc_block({6, 6, 6}, 1, {-3, -3, -3});
    std::atomic<std::uint64_t> outside = 0, samples = 0;
    const RegionField field{ball_field({}, 1.7f), region_boxes(mesh), &outside, &samples};
    const MarchResult r = march(mesh, FieldRef(field), {.snap = 0, .refinements = 0});
    EXPECT_EQ(outside, 0u);
    EXPECT_EQ(samples, r.report.vertices) << "each fine vertex once";
    march(mesh, FieldRef(field), {.snap = 0, .refinements = 3});
    EXPECT_EQ(samples, 2 * r.report.vertices + 3 * r.mesh.positions.size());
    EXPECT_EQ(outside, 0u);
}

TEST(March, RefinementsReduceTheError) {
    const TetraMesh mesh = bcc_block({6, 6, 6}, 1, {-3, -3, -3});
    const AnyField field{[](Vec3 p) { return std::pow(1.7f, 3.0f) - std::pow(length(p), 3.0f); }};
    std::vector<double> errors;
    for (const int refinements : {0, 1, 2, 6}) {
        const MarchResult r =
            march(mesh, FieldRef(field), {.levels = 1, .snap = 0, .refinements = refinements});
        double sum = 0;
        for (const Vec3 p : r.mesh.positions) sum += std::abs(double(length(p)) - 1.7);
        errors.push_back(sum / static_cast<double>(r.mesh.positions.size()));
    }
    EXPECT_GT(errors[0], 0.01);
    EXPECT_LT(errors[1], 0.3 * errors[0]);
    EXPECT_LT(errors[2], 0.5 * errors[1]);
    EXPECT_LT(errors[3], 0.0005);  // vertices stay 1 % of an edge away from its ends
}

TEST(March, IsBitIdenticalForAnyNumberOfThreads) {
    const TetraMesh mesh = bent(bcc_block({9, 9, 9}, 1, {0, 0, 0}), 0.1f, 4);
    const AnyField rough = noise(3, 9, 2.7f);
    const KernelField smooth = ball_field({4.4f, 4.5f, 4.6f}, 2.6f);
    for (const FieldRef& field : {FieldRef(rough), FieldRef(smooth)}) {
        const auto with = [&](unsigned threads) {
            Context ctx;
            ctx.threads = threads;
            return march(mesh, field, {}, ctx);
        };
        const MarchResult one = with(1);
        ASSERT_FALSE(one.mesh.triangles.empty());
        for (const unsigned threads : {2u, 7u}) {
            const MarchResult many = with(threads);
            EXPECT_EQ(print(many.mesh), print(one.mesh));
            EXPECT_EQ(many.report, one.report);
        }
    }
}

TEST(March, AcceptsAnyField) {
    const TetraMesh mesh = bcc_block({5, 5, 5}, 1, {0, 0, 0});
    const Vec3 center{2.51f, 2.47f, 2.53f};
    const auto make_field = [&](float inside, float outside, float level) {
        return AnyField{[=](Vec3 p) { return distance(p, center) < 1.1f ? inside : outside; }, level, 0.05f};
    };
    // Zero slope, infinite slope, not a number; two iso values: values are transformed for one of them.
    for (const float inside : {1.5f, 1e30f, std::numeric_limits<float>::max(), kInfinity}) {
        for (const float outside : {0.0f, -1e30f, -kInfinity, kNan, 1.0f, std::nextafter(1.0f, 0.0f)}) {
            for (const float level : {1.0f, 0.0f}) {
                if (level == 0 && outside > 0) continue;
                SCOPED_TRACE(testing::Message() << inside << " " << outside << " level " << level);
                const AnyField field = make_field(inside, outside, level);
                const MarchResult r = march(mesh, FieldRef(field));
                expect_sound(r);
                EXPECT_NEAR(volume(r.mesh), 5.575, 2);  // within a third of an edge
            }
        }
    }
    // The smallest value above the iso value is inside.
    const AnyField hair = make_field(std::nextafter(1.0f, 2.0f), 0, 1);
    expect_sound(march(mesh, FieldRef(hair)));
    // A value equal to the iso value is outside: the surface is empty.
    const AnyField level = make_field(1, 1, 1);
    EXPECT_TRUE(march(mesh, FieldRef(level)).mesh.triangles.empty());
    const AnyField nothing = make_field(kNan, kNan, 1);
    EXPECT_TRUE(march(mesh, FieldRef(nothing)).mesh.triangles.empty());
    const AnyField everything = make_field(2, 2, 1);
    const MarchResult all = march(mesh, FieldRef(everything));
    EXPECT_TRUE(all.mesh.triangles.empty());
    EXPECT_TRUE(all.open.empty());
}

TEST(March, FillsAHollowOfOneVertex) {
    // All inside except one lattice vertex exactly on the iso value: it is not moved and has no triangles.
    const TetraMesh mesh = bcc_block({4, 4, 4}, 1, {0, 0, 0});
    const AnyField field{[](Vec3 p) { return distance(p, {2.003f, 2.002f, 2}) - 0.01f; }};
    const MarchResult r = march(mesh, FieldRef(field), {.levels = 1, .snap = 0.25f});
    EXPECT_TRUE(r.open.empty());
    EXPECT_TRUE(r.mesh.triangles.empty());
    EXPECT_TRUE(r.mesh.positions.empty());
    const MarchResult kept = march(mesh, FieldRef(field), {.levels = 1, .snap = 0});
    EXPECT_EQ(topology(polygons(kept.mesh)).euler, 2);
}

TEST(March, OptionsAreDescribedAndChecked) {
    test::expect_described<MarchOptions>();

    const TetraMesh mesh = bcc_block({2, 2, 2}, 1, {0, 0, 0});
    const auto field = ball_field({1, 1, 1}, 0.2f);
    const auto expect_refused = [&](const MarchOptions& options, const std::string& word) {
        try {
            march(mesh, FieldRef(field), options);
            FAIL() << "taken: " << word;
        } catch (const InvalidInput& e) {
            EXPECT_NE(std::string(e.what()).find("march: " + word), std::string::npos) << e.what();
        }
    };
    expect_refused({.levels = -1}, "levels");
    expect_refused({.levels = 6}, "levels");
    expect_refused({.snap = -0.1f}, "snap");
    expect_refused({.snap = 0.51f}, "snap");
    expect_refused({.snap = kNan}, "snap");
    expect_refused({.refinements = -1}, "refinements");
    expect_refused({.refinements = 21}, "refinements");
}

TEST(March, StopsWhenCancelled) {
    std::stop_source source;
    source.request_stop();
    Context ctx;
    ctx.stop = source.get_token();
    const TetraMesh mesh = bcc_block({4, 4, 4}, 1, {0, 0, 0});
    const auto field = ball_field({2, 2, 2}, 1);
    EXPECT_THROW(march(mesh, FieldRef(field), {}, ctx), Cancelled);
}

TEST(March, AcceptsAnEmptyMesh) {
    const auto field = ball_field({2, 2, 2}, 1);
    const MarchResult r = march(TetraMesh{}, FieldRef(field));
    EXPECT_TRUE(r.mesh.triangles.empty());
    EXPECT_TRUE(r.open.empty());
}

}  // namespace
}  // namespace coppice
