#include "coppice/tetra/lattice/lattice.h"

#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <string>

#include "coppice/base/error.h"
#include "coppice/base/hash.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/spatial/box_tree.h"
#include "tetra/lattice_support.h"
#include "zoo.h"

namespace coppice {
namespace {

using namespace lattice_test;

const Segment kRod{{0, 0, 0}, {0, 0, 10}, 1, 1};

std::vector<std::pair<std::string, std::vector<Segment>>> scenes() {
    std::vector<std::pair<std::string, std::vector<Segment>>> out;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        if (skeleton.size() < 500) out.emplace_back(name, collect_segments(skeleton));
    }
    out.emplace_back("random_tree", collect_segments(random_tree(150, 3)));
    out.emplace_back("random_hard", collect_segments(random_tree(150, 4, true)));
    return out;
}

/// Expects that each face belongs to one tetrahedron, or to two on its two sides, and that the faces of only
/// one form a closed surface.
void expect_conforming(const TetraMesh& mesh) {
    const FaceUses uses = face_uses(mesh);
    std::map<std::array<std::uint32_t, 2>, unsigned> hull_edges;
    for (const auto& [f, use] : uses) {
        ASSERT_LE(use.size(), 2u);
        if (use.size() == 2) {
            ASSERT_NE(use[0].ascending, use[1].ascending);
        } else {
            ++hull_edges[{f[0], f[1]}], ++hull_edges[{f[1], f[2]}], ++hull_edges[{f[0], f[2]}];
        }
    }
    for (const auto& [edge, faces] : hull_edges) ASSERT_EQ(faces % 2, 0u);
}

void expect_well_formed(const TetraMesh& mesh) {
    ASSERT_EQ(mesh.first.front(), 0u);
    ASSERT_EQ(mesh.first.back(), mesh.tetra.size());
    for (std::uint32_t r = 0; r < mesh.region_count(); ++r) ASSERT_LT(mesh.first[r], mesh.first[r + 1]);
    std::vector<bool> used(mesh.positions.size());
    for (const Tetra& t : mesh.tetra) {
        for (const std::uint32_t v : t) {
            ASSERT_LT(v, mesh.positions.size());
            used[v] = true;
        }
        ASSERT_GT(volume_six(mesh, t), 0);
    }
    EXPECT_TRUE(std::ranges::all_of(used, [](bool u) { return u; }));
}

/// Finds the tetrahedra around a point with bounding boxes.
class Locator {
  public:
    explicit Locator(const TetraMesh& mesh) : mesh_(mesh), tree_(boxes(mesh), {}) {}

    template <class Visit>
    void visit(Vec3d p, const Visit& visit) const {
        Box3 box;
        box.extend(Vec3(p));
        tree_.visit_overlapping(box.inflated(1e-6f * (1 + length(Vec3(p)))), [&](std::uint32_t t) {
            if (contains(get_corners(mesh_, mesh_.tetra[t]), p)) visit(t);
        });
    }

  private:
    static std::vector<Box3> boxes(const TetraMesh& mesh) {
        std::vector<Box3> out(mesh.tetra.size());
        for (std::size_t t = 0; t < out.size(); ++t) {
            for (const std::uint32_t v : mesh.tetra[t]) out[t].extend(mesh.positions[v]);
        }
        return out;
    }

    const TetraMesh& mesh_;
    BoxTree tree_;
};

/// Returns whether the point is in some ball of the segment.
bool covers(const Segment& s, Vec3d p) { return holds_ball(growing_cone(s, {}), 1, p, 0); }

/// A point on the rounded cone of a segment and the radius of the ball that touches it there.
struct SurfacePoint {
    Vec3d position;
    double radius;
};
std::optional<SurfacePoint> surface_point(const Segment& s, const CounterRandom& random, std::uint64_t i) {
    const double t = std::clamp(random.uniform(4 * i, -0.2, 1.2), 0.0, 1.0);
    const double z = random.uniform(4 * i + 1, -1, 1), angle = random.uniform(4 * i + 2, 0, 6.2831853);
    const double h = std::sqrt(1 - z * z), radius = s.radius_a + t * (double(s.radius_b) - s.radius_a);
    const Vec3d out{h * std::cos(angle), h * std::sin(angle), z};
    const Vec3d p = lerp(Vec3d(s.a), Vec3d(s.b), t) + radius * 1.000001 * out;
    if (covers(s, p)) return std::nullopt;
    return SurfacePoint{p, radius};
}

double longest_edge(const std::array<Vec3d, 4>& c) {
    double out = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < i; ++j) out = std::max(out, distance(c[i], c[j]));
    }
    return out;
}

TEST(Lattice, IsConformingForEverySkeleton) {
    for (const auto& [name, segments] : scenes()) {
        SCOPED_TRACE(name);
        const Lattice lattice(segments);
        ASSERT_GT(lattice.mesh().tetra.size(), 0u);
        expect_well_formed(lattice.mesh());
        expect_conforming(lattice.mesh());
    }
}

TEST(Lattice, EnclosesEverySurfaceWithTetrahedraRelativeToTheRadius) {
    for (const auto& [name, segments] : scenes()) {
        SCOPED_TRACE(name);
        const LatticeOptions options;
        const Lattice lattice(segments, options);
        const Locator locator(lattice.mesh());
        for (std::size_t i = 0; i < segments.size(); ++i) {
            const CounterRandom random(i, 5);
            for (std::uint64_t k = 0; k < 40; ++k) {
                const auto at = surface_point(segments[i], random, k);
                if (!at) continue;
                if (std::ranges::any_of(segments, [&](const Segment& s) { return covers(s, at->position); }))
                    continue;
                unsigned found = 0;
                locator.visit(at->position, [&](std::uint32_t t) {
                    ++found;
                    // A cell of at most the requested size and one of twice its side: the centers are
                    // sqrt(11/4) sides apart, the center and a corner of the larger sqrt(3).
                    const auto corners = get_corners(lattice.mesh(), lattice.mesh().tetra[t]);
                    EXPECT_LE(longest_edge(corners), 1.7321 * double(options.cell) * at->radius * 1.00001);
                });
                EXPECT_GE(found, 1u);
            }
        }
    }
}

TEST(Lattice, PointsInsideAreInOneTetrahedron) {
    const std::vector<Segment> segments = collect_segments(random_tree(60, 1, true));
    const Lattice lattice(segments);
    const TetraMesh& mesh = lattice.mesh();
    const Locator locator(mesh);
    const CounterRandom random(1, 2);
    for (std::uint64_t k = 0; k < 4000; ++k) {
        const auto t = static_cast<std::size_t>(random.uniform(4 * k, 0, double(mesh.tetra.size())));
        const auto c = get_corners(mesh, mesh.tetra[t]);
        const double x = random.uniform(4 * k + 1, 0.01, 1), y = random.uniform(4 * k + 2, 0.01, 1),
                     z = random.uniform(4 * k + 3, 0.01, 1), w = 0.1;
        const Vec3d p = (x * c[0] + y * c[1] + z * c[2] + w * c[3]) * (1 / (x + y + z + w));
        unsigned found = 0;
        locator.visit(p, [&](std::uint32_t) { ++found; });
        EXPECT_EQ(found, 1u);
    }
}

TEST(Lattice, ExcludesTetrahedraFarOutsideOrDeepInside) {
    const std::vector<Segment> segments = collect_segments(random_tree(60, 2));
    for (const LatticeOptions& options : {LatticeOptions{}, LatticeOptions{1, 0.9f, 1.1f}}) {
        const Lattice lattice(segments, options);
        ASSERT_FALSE(lattice.mesh().tetra.empty());
        for (const Tetra& t : lattice.mesh().tetra) {
            const auto c = get_corners(lattice.mesh(), t);
            const Vec3d middle = 0.25 * (c[0] + c[1] + c[2] + c[3]);
            const double reach = longest_edge(c);
            EXPECT_TRUE(std::ranges::any_of(segments, [&](const Segment& s) {
                return thinnest_ball_meeting(growing_cone(s, {}), double(options.outside), middle, reach)
                    .has_value();
            }));
            // Except those that an axis passes through.
            if (std::ranges::any_of(segments, [&](const Segment& s) {
                    return growing_cone(s, {}).closest_point(middle).distance() < reach;
                }))
                continue;
            EXPECT_FALSE(std::ranges::any_of(segments, [&](const Segment& s) {
                return holds_ball(growing_cone(s, {}), double(options.inside), middle, reach);
            }));
        }
    }
}

TEST(Lattice, ARodOfOneRadiusHasOneSizeOfCell) {
    // The cells around it are half as large as allowed, except for the rounding of the cube's side to eighths
    // of a power of two: at most 9/8 between two of them. The shortest edge connects center and corner:
    // sqrt(3) / 2 sides.
    for (const float cell : {0.5f, 1.0f, 3.0f}) {
        const Lattice lattice(std::array{kRod}, {cell, 0.7f, 1.3f});
        for (const Tetra& t : lattice.mesh().tetra) {
            const auto c = get_corners(lattice.mesh(), t);
            double shortest = std::numeric_limits<double>::infinity();
            for (std::size_t i = 0; i < 4; ++i) {
                for (std::size_t j = 0; j < i; ++j) shortest = std::min(shortest, distance(c[i], c[j]));
            }
            EXPECT_GE(shortest, double(cell) * 0.866 / 2);
            EXPECT_LE(shortest, double(cell) * 0.867 / 2 * 9 / 8);
        }
    }
}

TEST(Lattice, IsBitIdenticalForAnyNumberOfThreadsAndAfterGrowth) {
    const std::vector<Segment> segments = collect_segments(random_tree(400, 5));
    const auto hash = [&](unsigned threads) {
        Context ctx;
        ctx.threads = threads;
        Lattice lattice(segments, {}, ctx);
        Hash h;
        const auto add = [&] {
            const TetraMesh& m = lattice.mesh();
            h.add(std::span<const Vec3>(m.positions)).add(std::span<const Tetra>(m.tetra));
            h.add(std::span<const std::uint32_t>(m.first));
        };
        add();
        EXPECT_TRUE(lattice.grow(compute_hull(face_uses(lattice.mesh())), ctx));
        add();
        return h.value();
    };
    const std::uint64_t one = hash(1);
    EXPECT_EQ(hash(2), one);
    EXPECT_EQ(hash(7), one);
}

TEST(Lattice, GrowsByNeighboursOnly) {
    Lattice lattice(std::array{kRod, Segment{{0, 0, 5}, {4, 0, 8}, 0.3f, 0.1f}});
    const std::set<Corners> before = tetra_set(lattice.mesh());
    const std::vector<TetraFace> hull = compute_hull(face_uses(lattice.mesh()));
    std::vector<TetraFace> some;
    std::set<std::set<std::array<float, 3>>> closed;
    for (std::size_t i = 0; i < hull.size(); i += 7) {
        some.push_back(hull[i]);
        std::set<std::array<float, 3>> corners;
        for (const std::uint8_t c : kTetraFaces[hull[i].opposite]) {
            const Vec3 p = lattice.mesh().positions[lattice.mesh().tetra[hull[i].tetra][c]];
            corners.insert({p.x, p.y, p.z});
        }
        closed.insert(corners);
    }
    ASSERT_TRUE(lattice.grow(some));
    expect_well_formed(lattice.mesh());
    expect_conforming(lattice.mesh());
    const std::set<Corners> after = tetra_set(lattice.mesh());
    EXPECT_TRUE(std::ranges::includes(after, before));
    EXPECT_LE(after.size(), before.size() + some.size());
    // Each new tetrahedron has one of the faces, and each of the faces now has two tetrahedra.
    std::map<std::set<std::array<float, 3>>, unsigned> uses;
    for (const Corners& t : after) {
        bool touches = before.contains(t);
        for (std::size_t left_out = 0; left_out < 4; ++left_out) {
            std::set<std::array<float, 3>> f(t.begin(), t.end());
            f.erase(t[left_out]);
            ++uses[f];
            touches |= closed.contains(f);
        }
        EXPECT_TRUE(touches);
    }
    for (const auto& f : closed) EXPECT_EQ(uses[f], 2u);
}

TEST(Lattice, GrowsToTheBorderOfTheOctreeAtMost) {
    Lattice lattice(std::array{Segment{{1, 2, 3}, {1, 2, 3}, 1, 1}}, {3, 0.7f, 1.3f});
    unsigned steps = 0;
    std::size_t tetra = 0;
    do {
        ASSERT_LT(tetra, lattice.mesh().tetra.size());
        tetra = lattice.mesh().tetra.size();
        ASSERT_LT(++steps, 100u);
    } while (lattice.grow(compute_hull(face_uses(lattice.mesh()))));
    EXPECT_EQ(tetra, lattice.mesh().tetra.size());
    expect_conforming(lattice.mesh());
    EXPECT_FALSE(lattice.grow({}));
    // The rest of the cube: on each square of its border a pyramid without tetrahedra.
    double volume = 0;
    for (const Tetra& t : lattice.mesh().tetra) volume += volume_six(lattice.mesh(), t) / 6;
    Box3 box;
    for (const Vec3 p : lattice.mesh().positions) box.extend(p);
    const double side = box.size().x;
    EXPECT_EQ(box.size().y, side);
    EXPECT_LT(volume, side * side * side);
    EXPECT_GT(volume, side * side * side / 2);
}

TEST(Lattice, PositionsAreExactFarFromTheOrigin) {
    const Vec3 far{1e6f, -1e6f, 1e6f};
    const Segment s{far, far + Vec3{0, 0, 16}, 4, 2};
    const Lattice lattice(std::array{s});
    expect_well_formed(lattice.mesh());
    expect_conforming(lattice.mesh());
    std::set<std::array<float, 3>> places;
    for (const Vec3 p : lattice.mesh().positions) EXPECT_TRUE(places.insert({p.x, p.y, p.z}).second);
}

TEST(Lattice, RejectsOptionsAndSegmentsOutOfRange) {
    const std::array one{kRod};
    EXPECT_THROW(Lattice(one, {0, 0.7f, 1.3f}), InvalidInput);
    EXPECT_THROW(Lattice(one, {3, 1.2f, 1.3f}), InvalidInput);
    EXPECT_THROW(Lattice(one, {3, 0.7f, 0.9f}), InvalidInput);
    EXPECT_THROW(Lattice(one, {std::numeric_limits<float>::quiet_NaN(), 0.7f, 1.3f}), InvalidInput);
    EXPECT_THROW(Lattice(std::span<const Segment>{}), InvalidInput);
    const float inf = std::numeric_limits<float>::infinity();
    for (const Segment& bad : {Segment{{0, 0, 0}, {0, inf, 1}, 1, 1}, Segment{{0, 0, 0}, {0, 0, 1}, 0, 1},
                               Segment{{0, 0, 0}, {0, 0, 1}, 1, inf}, Segment{{0, 0, 0}, {0, 0, 1}, 1, -1}}) {
        EXPECT_THROW(Lattice(std::array{kRod, bad}), InvalidInput);
    }
    try {
        const Lattice lattice(std::array{kRod, Segment{{0, 0, 0}, {0, 0, 1}, 0, 1}});
    } catch (const InvalidInput& e) {
        EXPECT_EQ(std::string(e.what()),
                  "lattice: segment 1 must have finite ends and radii above 0; repair it");
    }
}

TEST(Lattice, RejectsInputThatNeedsTooManyCells) {
    const float big = std::numeric_limits<float>::max();
    const std::vector<std::vector<Segment>> hostile{
        {{{0, 0, 0}, {0, 0, 1e7f}, 1, 1}},              // 10 million radii long
        {{{0, 0, 0}, {0.5e7f, 1e7f, 1e7f}, 1, 1}},      // and oblique
        {kRod, {{0, 0, 0}, {20, 0, 0}, 1e-9f, 1e-9f}},  // very thin
        {{{1e6f, 1e6f, 1e6f},
          {1e6f, 1e6f, 1e6f + 1},
          1e-3f,
          1e-3f}},  // thinner than the resolution of floats
        {{{-big, 0, 0}, {big, 0, 0}, 1, 1}},
        {{{0, 0, 0}, {0, 0, 1}, big, big}},
        {{{0, 0, 0}, {0, 0, 0}, 1e-42f, 1e-42f}, {{1, 0, 0}, {1, 0, 0}, 1e-42f, 1e-42f}},
    };
    for (std::size_t i = 0; i < hostile.size(); ++i) {
        SCOPED_TRACE(i);
        EXPECT_THROW(Lattice lattice(hostile[i]), InvalidInput);
    }
}

TEST(Lattice, AcceptsThousandsOfSegmentsAtOnePosition) {
    std::vector<Segment> star;
    const CounterRandom random(3, 4);
    for (std::uint64_t i = 0; i < 10000; ++i) {
        const auto draw = [&](std::uint64_t k) {
            return static_cast<float>(random.uniform(4 * i + k, -1, 1));
        };
        star.push_back({{0, 0, 0}, {draw(0), draw(1), draw(2)}, 0.5f + 0.2f * draw(3), 0.3f});
    }
    const Lattice lattice(star);
    EXPECT_GT(lattice.mesh().tetra.size(), 0u);
    EXPECT_LT(lattice.mesh().tetra.size(), 100000u);
}

TEST(Lattice, AcceptsRadiiOfVeryDifferentSize) {
    // A cone with a radius ratio of a thousand and a very thin tip: cells shrink with it.
    const Lattice lattice(std::array{Segment{{0, 0, 0}, {0, 0, 10}, 1, 1e-3f}});
    expect_conforming(lattice.mesh());
    EXPECT_LT(lattice.mesh().tetra.size(), 20000u);
    // A thin segment within a thick one only adds cells that the thick one does not contain.
    const Segment thin{{0, 0, 1}, {0, 0, 9}, 1e-9f, 1e-9f};
    EXPECT_LT(Lattice(std::array{kRod, thin}).mesh().tetra.size(), 10000u);
}

}  // namespace
}  // namespace coppice
