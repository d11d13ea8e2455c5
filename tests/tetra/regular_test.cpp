#include "coppice/tetra/polyhedron/regular_internal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "coppice/base/id.h"
#include "coppice/base/random.h"
#include "coppice/tetra/lattice/tetra_mesh.h"

namespace coppice::tetra_internal {
namespace {

constexpr std::int32_t kSide = 1 << 20;

RegularTriangulation filled(std::uint32_t count, const std::function<WeightedPlace(std::uint32_t)>& point) {
    RegularTriangulation out({-kSide, -kSide, -kSide}, {kSide, kSide, kSide});
    std::vector<WeightedPlace> points;
    for (std::uint32_t i = 0; i < count; ++i) points.push_back(point(i));
    out.insert(points, {});
    return out;
}

/// Expects that the cells fill the box, agree with their neighbours, and are not in conflict with vertices of
/// their neighbours.
void expect_sound(const RegularTriangulation& t) {
    const auto cells = t.cells();
    double volume = 0;
    for (std::uint32_t c = 0; c < cells.size(); ++c) {
        if (cells[c].is_dead()) continue;
        const auto& v = cells[c].vertex;
        const std::array<const WeightedPlace*, 4> at{&t.vertex(v[0]), &t.vertex(v[1]), &t.vertex(v[2]),
                                                     &t.vertex(v[3])};
        ASSERT_GT(orientation(at[0]->at, at[1]->at, at[2]->at, at[3]->at), 0);
        volume +=
            determinant(difference<double>(at[1]->at, at[0]->at), difference<double>(at[2]->at, at[0]->at),
                        difference<double>(at[3]->at, at[0]->at));
        for (std::size_t face = 0; face < 4; ++face) {
            if (cells[c].next[face] == kNoIndex) continue;
            const auto& other = cells[cells[c].next[face]];
            ASSERT_FALSE(other.is_dead());
            const auto back = std::ranges::find(other.next, c) - other.next.begin();
            ASSERT_LT(back, 4);
            for (const std::uint8_t k : kTetraFaces[face])
                ASSERT_NE(std::ranges::find(other.vertex, v[k]), other.vertex.end());
            const std::uint32_t beyond = other.vertex[static_cast<std::size_t>(back)];
            ASSERT_EQ(std::ranges::find(v, beyond), v.end());
            ASSERT_FALSE(conflicts(at, t.vertex(beyond)));
        }
    }
    EXPECT_NEAR(volume / (6 * 8.0 * kSide * kSide * kSide), 1, 1e-9);
}

TEST(RegularTriangulation, FillsItsBoxForAnyPoints) {
    const CounterRandom random(3, 4);
    const auto draw = [&](std::uint32_t i, std::uint32_t most) {
        return static_cast<std::int32_t>(random.bits(i) % (2 * most)) - static_cast<std::int32_t>(most);
    };
    const auto anywhere = [&](std::uint32_t i, std::uint32_t most) {
        return GridPlace{draw(3 * i, most), draw(3 * i + 1, most), draw(3 * i + 2, most)};
    };
    expect_sound(filled(0, [](std::uint32_t) { return WeightedPlace{}; }));
    expect_sound(filled(1, [](std::uint32_t) { return WeightedPlace{{5, -7, 11}}; }));
    expect_sound(filled(3000, [&](std::uint32_t i) { return WeightedPlace{anywhere(i, kSide - 1)}; }));
    // Weights that hide many of the points.
    expect_sound(filled(2000, [&](std::uint32_t i) {
        return WeightedPlace{anywhere(i, kSide / 2), std::int64_t{draw(i, 1 << 20)} * (1 << 14)};
    }));
    // Many sets of eight points on a sphere, four in a plane, three on a line, with and without weights.
    for (const std::int64_t weight : {0, 2000}) {
        expect_sound(filled(1000, [&](std::uint32_t i) {
            const auto x = static_cast<std::int32_t>(i % 10), y = static_cast<std::int32_t>(i / 10 % 10),
                       z = static_cast<std::int32_t>(i / 100);
            return WeightedPlace{{100 * x, 100 * y, 100 * z}, (x + y + z) % 2 == 0 ? weight : -weight};
        }));
    }
    expect_sound(filled(400, [&](std::uint32_t i) { return WeightedPlace{{draw(i, 1000), 0, 0}}; }));
    expect_sound(filled(400, [&](std::uint32_t i) {
        return WeightedPlace{{draw(2 * i, 50), draw(2 * i + 1, 50), 7}};
    }));
    // A thousand points at 27 positions.
    expect_sound(filled(1000, [&](std::uint32_t i) { return WeightedPlace{anywhere(i, 1)}; }));
}

TEST(RegularTriangulation, OmitsRedundantPoints) {
    const auto line = [](std::uint32_t i) {
        return WeightedPlace{{static_cast<std::int32_t>(i), 0, 0}, 0, 10};
    };
    const RegularTriangulation t = filled(1000, line);
    expect_sound(t);
    EXPECT_LE(t.vertex_count(), 8u + 100);
    EXPECT_GE(t.vertex_count(), 8u + 40);
}

TEST(RegularTriangulation, LocatesTheCellOfAPoint) {
    const CounterRandom random(8, 4);
    const auto place = [&](std::uint32_t i) {
        const auto draw = [&](std::uint32_t k) {
            return static_cast<std::int32_t>(random.bits(3 * i + k) % kSide) - kSide / 2;
        };
        return GridPlace{draw(0), draw(1), draw(2)};
    };
    const RegularTriangulation t = filled(500, [&](std::uint32_t i) { return WeightedPlace{place(i)}; });
    std::uint32_t cell = t.some_cell();
    for (std::uint32_t i = 1000; i < 2000; ++i) {
        const GridPlace p = place(i);
        cell = t.locate(p, cell);
        const auto& v = t.cells()[cell].vertex;
        for (const auto& f : kTetraFaces)
            EXPECT_LE(orientation(t.vertex(v[f[0]]).at, t.vertex(v[f[1]]).at, t.vertex(v[f[2]]).at, p), 0);
    }
}

TEST(RegularTriangulation, StopsWhenCancelled) {
    std::stop_source source;
    source.request_stop();
    RegularTriangulation t({-kSide, -kSide, -kSide}, {kSide, kSide, kSide});
    EXPECT_THROW(t.insert(std::vector<WeightedPlace>(10), {.stop = source.get_token()}), Cancelled);
}

TEST(ExactSigns, AreExactWhereDoublesRound) {
    // A plane through distant points, and points one unit off it.
    const std::int32_t far = 1 << 24;
    const GridPlace a{far, far - 1, far - 2}, b{-far, 3, far - 5}, c{7, -far, -far + 1};
    EXPECT_EQ(orientation(a, b, c, a), 0);
    EXPECT_EQ(orientation(a, b, c, b), 0);
    EXPECT_EQ(orientation(a, b, c, GridPlace{a[0] + 1, a[1], a[2]}),
              -orientation(a, b, c, GridPlace{a[0] - 1, a[1], a[2]}));
    EXPECT_NE(orientation(a, b, c, GridPlace{a[0] + 1, a[1], a[2]}), 0);
    // The corners of a cube are on one sphere.
    std::array<WeightedPlace, 8> cube;
    for (unsigned i = 0; i < 8; ++i) {
        for (unsigned k = 0; k < 3; ++k) cube[i].at[k] = (i >> k & 1) != 0 ? far : -far + 1;
    }
    const std::array<const WeightedPlace*, 4> four{&cube[0], &cube[1], &cube[2], &cube[4]};
    ASSERT_GT(orientation(cube[0].at, cube[1].at, cube[2].at, cube[4].at), 0);
    EXPECT_FALSE(conflicts(four, cube[7]));
    WeightedPlace inside = cube[7], outside = cube[7];
    --inside.at[0];
    ++outside.at[0];
    EXPECT_TRUE(conflicts(four, inside));
    EXPECT_FALSE(conflicts(four, outside));
    inside = cube[7];
    inside.weight = 1;
    EXPECT_TRUE(conflicts(four, inside));
}

}  // namespace
}  // namespace coppice::tetra_internal
