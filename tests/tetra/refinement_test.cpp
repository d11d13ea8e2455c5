#include "coppice/tetra/lattice/refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <set>

#include "tetra/support.h"

namespace coppice {
namespace {

using Kind = TetraRefinement::Kind;
using Local = TetraPattern::Local;

struct Scene {
    const char* name;
    TetraMesh mesh;
};

std::vector<Scene> scenes() {
    std::vector<Scene> out;
    out.push_back({"one", one_tetra()});
    out.push_back({"two", tetra_mesh(std::array<Vec3, 5>{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0},
                                                         Vec3{0, 0, 1}, Vec3{1, 1, 1.5f}},
                                     std::array<Tetra, 2>{Tetra{3, 1, 0, 2}, Tetra{4, 2, 3, 1}})});
    out.push_back({"bcc", bcc_block({2, 2, 3}, 1, {0, 0, 0})});
    out.push_back({"bent", bent(bcc_block({3, 2, 2}, 0.25f, {-5, 3, 8}), 0.03f, 5)});
    out.push_back({"shuffled", shuffled(bent(bcc_block({2, 2, 2}, 1, {0, 0, 0}), 0.1f, 6), 7)});
    return out;
}

double volume(const TetraMesh& mesh) {
    double sum = 0;
    for (const Tetra& t : mesh.tetra) sum += volume6(mesh, t);
    return sum / 6;
}

TEST(TetraMesh, HasABoxAroundEachRegion) {
    const TetraMesh mesh = bcc_block({2, 1, 1}, 2, {1, 0, 0});
    const std::vector<Box3> boxes = region_boxes(mesh);
    ASSERT_EQ(boxes.size(), mesh.region_count());
    // The one face between two cells, and the centers on both sides.
    ASSERT_EQ(boxes.size(), 1u);
    EXPECT_EQ(boxes[0].low, (Vec3{2, 0, 0}));
    EXPECT_EQ(boxes[0].high, (Vec3{4, 2, 2}));
}

TEST(TetraRefinement, FillsEveryTetrahedronAndIsConforming) {
    for (const Scene& scene : scenes()) {
        for (int levels = 0; levels <= (scene.mesh.tetra.size() < 3 ? 4 : 2); ++levels) {
            SCOPED_TRACE(testing::Message() << scene.name << " levels " << levels);
            const TetraRefinement refinement(scene.mesh, levels);
            const TetraMesh fine = fine_mesh(refinement);
            ASSERT_EQ(fine.tetra.size(), scene.mesh.tetra.size() << 3 * levels);
            ASSERT_EQ(fine.tetra.size(), refinement.tetra_count());
            std::vector<char> seen(fine.positions.size());
            for (const Tetra& t : fine.tetra) {
                EXPECT_GT(volume6(fine, t), 0);
                for (const std::uint32_t v : t) seen[v] = 1;
            }
            EXPECT_TRUE(std::ranges::all_of(seen, [](char c) { return c == 1; }))
                << "a number without a vertex";
            EXPECT_NEAR(volume(fine), volume(scene.mesh), 1e-5 * volume(scene.mesh));
            const auto coarse_sides = face_sides(scene.mesh), sides = face_sides(fine);
            const auto lone = [](const FaceSides& s) {
                return std::ranges::count_if(s, [](const auto& f) { return f.second.size() == 1; });
            };
            EXPECT_EQ(lone(sides), lone(coarse_sides) << 2 * levels);
            for (const auto& [face, turns] : sides) {
                ASSERT_LE(turns.size(), 2u);
                if (turns.size() == 2) {
                    EXPECT_NE(turns[0], turns[1]);
                }
            }
        }
    }
}

TEST(TetraRefinement, SharedVerticesAreBitIdenticalFromEverySide) {
    for (const Scene& scene : scenes()) {
        const TetraRefinement refinement(scene.mesh, 3);
        std::map<std::uint32_t, Vec3> place;
        std::set<std::array<float, 3>> distinct;
        for (std::uint32_t t = 0; t < scene.mesh.tetra.size(); ++t) {
            for (std::size_t v = 0; v < refinement.pattern(t).weights.size(); ++v) {
                const Vec3 p = refinement.position(t, static_cast<Local>(v));
                const auto [at, is_new] = place.emplace(refinement.vertex(t, static_cast<Local>(v)), p);
                ASSERT_EQ(at->second, p) << scene.name;
                distinct.insert({p.x, p.y, p.z});
            }
        }
        EXPECT_EQ(place.size(), refinement.vertex_count()) << scene.name;
        EXPECT_EQ(distinct.size(), refinement.vertex_count()) << scene.name << ": two numbers for one point";
    }
}

/// Six edge lengths, ascending: two tetrahedra with equal lengths are congruent here, or mirror images.
std::array<double, 6> measure_shape(const TetraMesh& mesh, const Tetra& t) {
    std::array<double, 6> out;
    for (std::size_t e = 0; e < 6; ++e)
        out[e] = distance(Vec3d(mesh.positions[t[kTetraEdges[e][0]]]),
                          Vec3d(mesh.positions[t[kTetraEdges[e][1]]]));
    std::ranges::sort(out);
    return out;
}

TEST(TetraRefinement, DescendantsOfTheCubicLatticeAreCongruent) {
    const TetraMesh mesh = bcc_block({2, 2, 2}, 1, {0, 0, 0});
    for (int levels = 1; levels <= 4; ++levels) {
        const TetraRefinement refinement(mesh, levels);
        const TetraMesh fine = fine_mesh(refinement);
        const double part = 1.0 / (1 << levels);
        for (const Tetra& t : fine.tetra) {
            const auto shape = measure_shape(fine, t);
            for (std::size_t e = 0; e < 6; ++e)  // four of half a cell's diagonal, two of its side
                ASSERT_NEAR(shape[e], (e < 4 ? std::sqrt(0.75) : 1) * part, 1e-6);
        }
        for (std::uint32_t t = 0; t < mesh.tetra.size(); ++t) {
            EXPECT_NEAR(refinement.shortest_edge(t), std::sqrt(0.75) * part, 1e-6);
            EXPECT_NEAR(refinement.width(t), 0.5 * part, 1e-6);  // between the two long edges
        }
    }
}

TEST(TetraRefinement, SelectsTheShortestDiagonalInAnyOrder) {
    // The midpoints of 01 and 23 are 0.5 apart, the others at least 1.5.
    const std::array<Vec3, 4> p{Vec3{-1, 0, 0}, Vec3{1, 0, 0}, Vec3{0, -2, 0.5f}, Vec3{0, 2, 0.5f}};
    std::array<std::uint32_t, 4> order{0, 1, 2, 3};
    do {
        std::array<Vec3, 4> q;
        for (std::size_t i = 0; i < 4; ++i) q[order[i]] = p[i];
        const TetraMesh mesh = tetra_mesh(q, std::array<Tetra, 1>{Tetra{0, 1, 2, 3}});
        const TetraRefinement refinement(mesh, 1);
        const TetraMesh fine = fine_mesh(refinement);
        double shortest = 10;
        for (const Tetra& t : fine.tetra) shortest = std::min(shortest, measure_shape(fine, t)[0]);
        EXPECT_NEAR(shortest, 0.5, 1e-6);
        EXPECT_NEAR(refinement.shortest_edge(0), 0.5, 1e-6);
    } while (std::ranges::next_permutation(order).found);
}

/// Minimum distance of parallel planes around a tetrahedron, over all pairs of a face and a vertex and of
/// edges.
double compute_width(const TetraMesh& mesh, const Tetra& t) {
    std::array<Vec3d, 4> p;
    for (std::size_t i = 0; i < 4; ++i) p[i] = Vec3d(mesh.positions[t[i]]);
    double least = std::numeric_limits<double>::infinity();
    const auto try_normal = [&](Vec3d n) {
        n = normalized(n);
        double low = dot(n, p[0]), high = low;
        for (const Vec3d q : p) low = std::min(low, dot(n, q)), high = std::max(high, dot(n, q));
        least = std::min(least, high - low);
    };
    for (std::size_t a = 0; a < 6; ++a) {
        for (std::size_t b = a + 1; b < 6; ++b)
            try_normal(cross(p[kTetraEdges[a][1]] - p[kTetraEdges[a][0]],
                             p[kTetraEdges[b][1]] - p[kTetraEdges[b][0]]));
    }
    return least;
}

TEST(TetraRefinement, DescendantsHaveThreeShapesAndTheReportedWidths) {
    const CounterRandom random(11, 0);
    for (std::uint64_t i = 0; i < 40; ++i) {
        std::array<Vec3, 4> p;
        for (std::size_t k = 0; k < 4; ++k) {
            for (int axis = 0; axis < 3; ++axis)
                p[k][axis] =
                    static_cast<float>(random.uniform(12 * i + 3 * k + static_cast<std::size_t>(axis)));
        }
        const TetraMesh mesh = tetra_mesh(p, std::array<Tetra, 1>{Tetra{0, 1, 2, 3}});
        if (volume6(mesh, mesh.tetra[0]) < 0.01) continue;
        const TetraRefinement refinement(mesh, 3);
        const TetraMesh fine = fine_mesh(refinement);
        std::vector<std::array<double, 6>> shapes;
        double width = 1, shortest = 1;
        for (const Tetra& t : fine.tetra) {
            const auto shape = measure_shape(fine, t);
            const auto same = [&](const auto& other) {
                for (std::size_t e = 0; e < 6; ++e) {
                    if (std::abs(shape[e] - other[e]) > 1e-5) return false;
                }
                return true;
            };
            if (std::ranges::none_of(shapes, same)) shapes.push_back(shape);
            width = std::min(width, compute_width(fine, t));
            shortest = std::min(shortest, shape[0]);
        }
        EXPECT_LE(shapes.size(), 3u);
        EXPECT_NEAR(refinement.width(0), width, 1e-5);
        EXPECT_NEAR(refinement.shortest_edge(0), shortest, 1e-5);
    }
}

TEST(TetraRefinement, PlacesPartsAndOwnersAreConsistent) {
    for (const Scene& scene : scenes()) {
        SCOPED_TRACE(scene.name);
        const TetraRefinement refinement(scene.mesh, 3);
        std::set<std::array<std::uint32_t, 2>> owned;
        std::vector<int> sampled(refinement.vertex_count());
        for (std::uint32_t t = 0; t < scene.mesh.tetra.size(); ++t) {
            const TetraPattern& pattern = refinement.pattern(t);
            for (std::uint32_t g = 0; g < TetraPattern::kInside; ++g) {
                const auto kind = static_cast<Kind>(element_kind(g));
                const std::uint32_t part = refinement.elements(t)[g];
                const auto around = refinement.around(kind, part);
                EXPECT_TRUE(std::ranges::is_sorted(around));
                EXPECT_EQ(std::ranges::count(around, t), 1);
                EXPECT_EQ(refinement.group_in(t, kind, part), g);
                const bool owns = (refinement.owned(t) >> g & 1) != 0;
                EXPECT_EQ(owns, around.front() == t);
                if (!refinement.on_hull(t, g)) {
                    float shortest = refinement.shortest_edge(t);
                    for (const std::uint32_t other : around)
                        shortest = std::min(shortest, refinement.shortest_edge(other));
                    EXPECT_EQ(refinement.shortest_edge(t, g), shortest);
                }
                if (owns) {
                    EXPECT_TRUE(owned.insert({element_kind(g), part}).second);
                }
            }
            for (std::size_t v = 0; v < pattern.weights.size(); ++v) {
                const std::uint32_t number = refinement.vertex(t, static_cast<Local>(v));
                const auto place = refinement.place(number);
                const std::uint32_t g = pattern.group[v];
                EXPECT_EQ(static_cast<std::uint32_t>(place.kind), element_kind(g));
                EXPECT_EQ(place.part, g == TetraPattern::kInside ? t : refinement.elements(t)[g]);
                EXPECT_EQ(pattern.first_vertex[g] + place.index, v);
                if ((refinement.owned(t) >> g & 1) != 0) ++sampled[number];
            }
        }
        EXPECT_EQ(owned.size(),
                  scene.mesh.positions.size() + refinement.edge_count() + refinement.face_count());
        EXPECT_TRUE(std::ranges::all_of(sampled, [](int n) { return n == 1; }));
    }
}

TEST(TetraRefinement, ViewContainsEveryFineEdgeOnce) {
    for (const Scene& scene : scenes()) {
        for (int levels = 0; levels <= 3; ++levels) {
            SCOPED_TRACE(testing::Message() << scene.name << " levels " << levels);
            const TetraRefinement refinement(scene.mesh, levels);
            const RefinementView view = refinement.view();
            std::map<std::array<std::uint32_t, 2>, std::uint32_t> number_of;
            std::set<std::uint32_t> numbers;
            for (std::uint32_t t = 0; t < scene.mesh.tetra.size(); ++t) {
                const TetraPattern& pattern = refinement.pattern(t);
                for (std::size_t v = 0; v < pattern.weights.size(); ++v) {
                    const auto local = static_cast<Local>(v);
                    ASSERT_EQ(view.vertex(t, local), refinement.vertex(t, local));
                    ASSERT_EQ(view.position(t, local), refinement.position(t, local));
                    ASSERT_EQ(view.shortest_edge(t, pattern.group[v]),
                              refinement.shortest_edge(t, pattern.group[v]));
                }
                for (std::size_t e = 0; e < pattern.edges.size(); ++e) {
                    std::array<std::uint32_t, 2> ends{refinement.vertex(t, pattern.edges[e][0]),
                                                      refinement.vertex(t, pattern.edges[e][1])};
                    std::ranges::sort(ends);
                    const std::uint32_t number = view.edge(t, static_cast<Local>(e));
                    ASSERT_EQ(number_of.emplace(ends, number).first->second, number);
                    numbers.insert(number);
                    const FinePlace place = view.edges.place(number);
                    const std::uint32_t g = pattern.edge_group[e];
                    ASSERT_EQ(static_cast<std::uint32_t>(place.kind), element_kind(g));
                    ASSERT_EQ(pattern.first_edge[g] + place.index, e);
                }
            }
            EXPECT_EQ(number_of.size(), view.edge_count);
            EXPECT_EQ(numbers.size(), view.edge_count);
            EXPECT_EQ(*numbers.rbegin() + 1, view.edge_count);
        }
    }
}

TEST(TetraRefinement, OnHullMatchesTheFinestMesh) {
    for (const Scene& scene : scenes()) {
        SCOPED_TRACE(scene.name);
        const TetraRefinement refinement(scene.mesh, 2);
        const TetraMesh fine = fine_mesh(refinement);
        std::set<std::uint32_t> hull;  // fine vertices of faces with one tetrahedron
        for (const auto& [face, turns] : face_sides(fine)) {
            if (turns.size() == 1) hull.insert(face.begin(), face.end());
        }
        for (std::uint32_t t = 0; t < scene.mesh.tetra.size(); ++t) {
            const TetraPattern& pattern = refinement.pattern(t);
            for (std::size_t v = 0; v < pattern.weights.size(); ++v) {
                const bool is_on_hull = refinement.on_hull(t, pattern.group[v]);
                EXPECT_EQ(is_on_hull, hull.contains(refinement.vertex(t, static_cast<Local>(v))));
            }
        }
    }
}

TEST(TetraRefinement, PatternsContainVerticesEdgesAndStars) {
    for (int levels = 0; levels <= TetraPattern::kMaxLevels; ++levels) {
        const auto n = std::size_t{1} << levels;
        for (std::uint32_t d = 0; d < 3; ++d) {
            const TetraPattern p = tetra_pattern(levels, d);
            ASSERT_EQ(p.weights.size(), (n + 1) * (n + 2) * (n + 3) / 6);
            ASSERT_EQ(p.tetra.size(), n * n * n);
            // Euler characteristic of a ball. Every tetrahedron has four faces; outer ones count once, the
            // others twice.
            const std::size_t faces = (4 * p.tetra.size() + 4 * n * n) / 2;
            EXPECT_EQ(p.weights.size() + faces, p.edges.size() + p.tetra.size() + 1);
            for (std::size_t t = 0; t < p.tetra.size(); ++t) {
                for (std::size_t e = 0; e < 6; ++e) {
                    auto ends = p.edges[p.tetra_edges[t][e]];
                    std::array<Local, 2> expected{p.tetra[t][kTetraEdges[e][0]],
                                                  p.tetra[t][kTetraEdges[e][1]]};
                    std::ranges::sort(ends);
                    std::ranges::sort(expected);
                    ASSERT_EQ(ends, expected);
                }
                for (const Local v : p.tetra[t])
                    ASSERT_EQ(std::ranges::count(p.tetra_around(v), static_cast<Local>(t)), 1);
            }
            EXPECT_EQ(p.around.size(), 4 * p.tetra.size());
            EXPECT_EQ(p.tetra_masks.size(), levels <= 2 ? p.tetra.size() : 0);
        }
    }
}

TEST(TetraRefinement, IsBitIdenticalForAnyNumberOfThreads) {
    const TetraMesh mesh = shuffled(bent(bcc_block({12, 11, 10}, 1, {0, 0, 0}), 0.1f, 6), 9);
    const auto print = [&](unsigned threads) {
        Context ctx;
        ctx.threads = threads;
        const TetraRefinement r(mesh, 2, ctx);
        std::vector<std::uint32_t> out{r.edge_count(), r.face_count(), r.vertex_count()};
        for (std::uint32_t t = 0; t < mesh.tetra.size(); ++t) {
            out.insert(out.end(), r.elements(t).begin(), r.elements(t).end());
            out.insert(out.end(), {r.owned(t), r.mirrored(t)});
            for (std::uint32_t g = 0; g < TetraPattern::kGroups; ++g)
                out.push_back(std::bit_cast<std::uint32_t>(r.shortest_edge(t, g)));
        }
        return out;
    };
    const auto one = print(1);
    EXPECT_EQ(print(2), one);
    EXPECT_EQ(print(7), one);
}

void expect_refused(const TetraMesh& mesh, int levels, const std::string& word) {
    try {
        const TetraRefinement refinement(mesh, levels);
        FAIL() << "taken: " << word;
    } catch (const InvalidInput& e) {
        EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
}

TEST(TetraRefinement, RejectsInvalidInput) {
    const TetraMesh one = one_tetra();
    expect_refused(one, -1, "levels must be between 0 and 5");
    expect_refused(one, 6, "levels must be between 0 and 5");
    TetraMesh bad = one;
    bad.tetra[0][2] = 4;
    expect_refused(bad, 1, "tetrahedron 0");
    bad = one;
    std::swap(bad.tetra[0][0], bad.tetra[0][1]);
    expect_refused(bad, 1, "no positive volume");
    bad = one;
    bad.positions[3].x = std::numeric_limits<float>::quiet_NaN();
    expect_refused(bad, 1, "no positive volume");
    bad = one;
    bad.first = {0, 2};
    expect_refused(bad, 1, "regions");
    bad.first = {0, 1, 0, 1};
    expect_refused(bad, 1, "regions");
    // Three tetrahedra on one face.
    const TetraMesh crowded =
        tetra_mesh(std::array<Vec3, 6>{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1},
                                       Vec3{0, 0, 2}, Vec3{0, 0, -1}},
                   std::array<Tetra, 3>{Tetra{0, 1, 2, 3}, Tetra{0, 1, 2, 4}, Tetra{0, 1, 2, 5}});
    expect_refused(crowded, 1, "tetrahedron 2 has a face with more than one other");
    // 6545 fine vertices in each of 300,000 separate tetrahedra.
    TetraMesh many;
    for (std::uint32_t i = 0; i < 300000; ++i) {
        const auto x = static_cast<float>(i);
        for (const Vec3 p : {Vec3{x, 0, 0}, Vec3{x + 0.5f, 0, 0}, Vec3{x, 1, 0}, Vec3{x, 0, 1}})
            many.positions.push_back(p);
        many.tetra.push_back({4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3});
    }
    many.first = {0, 300000};
    expect_refused(many, 5, "levels = 5 makes more than");
}

TEST(TetraRefinement, AcceptsEmptyMeshesAndUnusedVertices) {
    const TetraMesh nothing;
    const TetraRefinement none(nothing, 2);
    EXPECT_EQ(none.vertex_count(), 0u);
    TetraMesh mesh = one_tetra();
    mesh.positions.push_back({5, 5, 5});
    const TetraRefinement refinement(mesh, 1);
    EXPECT_EQ(refinement.vertex_count(), 5u + 6u);
}

}  // namespace
}  // namespace coppice
