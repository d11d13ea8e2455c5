#include "coppice/implicit/polygonize/cached_field.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "coppice/base/check_fields.h"
#include "implicit/trees.h"

namespace coppice {
namespace {

std::vector<FieldSample> samples(FieldRef field, std::span<const Vec3> points) {
    std::vector<FieldSample> out(points.size());
    field.sample(0, points, out);
    return out;
}

/// Returns the maximum error where the field is in the band; checks the side of the band elsewhere.
float max_error(const SolidField& field, const CachedField& cached, float band, Box3 box) {
    const auto points = random_points_in(box.inflated(0.2f * box.diagonal()), 20000);
    const auto exact = samples(FieldRef(field), points), got = samples(FieldRef(cached), points);
    float error = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const float off = exact[i].value - field.level();
        if (std::abs(off) <= band) {
            error = std::max(error, std::abs(exact[i].value - got[i].value));
        } else if (std::abs(off) > band + 0.05f) {
            EXPECT_EQ(got[i].value > field.level(), off > 0);
        }
    }
    return error;
}

TEST(CachedField, ErrorOfAPrimitiveIsWithinItsBound) {
    const PrimitiveOptions o{.radius = 0.5f, .influence = 1.1f};
    const double factor = wyvill(0, o);
    for (const float cell : {0.2f, 0.1f, 0.05f}) {
        const SolidField field(sphere({0.3f, 0.2f, 0.1f}, o));
        const CachedField cached(field, {.cell = cell, .band = 0.3f});
        const double stated = 2.25 * factor * cell * cell / (1.1 * 1.1);
        const float error = max_error(field, cached, 0.3f, field.bounds());
        EXPECT_LE(error, stated);
        EXPECT_GT(error, 0.02 * stated);
        EXPECT_LE(cached.error(), stated);
        EXPECT_LE(error, 3 * cached.error());
    }
}

TEST(CachedField, ErrorOfTreesWithEdgesIsWithinItsBound) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        SCOPED_TRACE(seed);
        TreeMaker maker(400 + seed);
        const Twin twin = maker.tree(3);
        const SolidField field(twin.solid);
        if (field.surface_bounds().empty()) continue;
        const CachedField cached(field);
        // The maximum slope of the primitives of these trees is 3.4 / 0.6 per m, with six of them at one
        // place.
        const double stated = 0.87 * cached.cell() * 6 * 6;
        EXPECT_LE(max_error(field, cached, 0.1f, field.surface_bounds()), stated);
        EXPECT_LT(cached.error(), stated);
    }
}

TEST(CachedField, GradientsMatchTheInterpolation) {
    const SolidField field(blend(std::array{sphere({}), sphere({1, 0, 0})}));
    const CachedField cached(field, {.band = 0.2f});
    const auto points = random_points_in(field.surface_bounds(), 4000);
    const auto got = samples(FieldRef(cached), points), exact = samples(FieldRef(field), points);
    int checked = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (std::abs(exact[i].value - 0.5f) > 0.1f) continue;
        ++checked;
        EXPECT_LT(length(got[i].gradient - exact[i].gradient), 0.1f);
        const float h = 0.01f * cached.cell();
        std::array<Vec3, 2> both{points[i] - Vec3{h, 0, 0}, points[i] + Vec3{h, 0, 0}};
        std::array<float, 2> v;
        cached.values(both, v);
        EXPECT_NEAR((v[1] - v[0]) / (2 * h), got[i].gradient.x, 0.05);
    }
    EXPECT_GT(checked, 200);
}

TEST(CachedField, ContainsThinParts) {
    // A wire a tenth of a cell thick.
    const SolidField field(unite(std::array{sphere({}), line({0, 0, 0}, {5, 5, 5}, {.radius = 0.005f})}));
    const CachedField cached(field, {.cell = 0.05f});
    for (int i = 0; i <= 100; ++i) {
        const Vec3 p = Vec3{5, 5, 5} * (0.01f * static_cast<float>(i));
        if (length(p) < 1.2f) continue;
        const bool near = std::any_of(cached.blocks().begin(), cached.blocks().end(),
                                      [&](const Box3& b) { return b.overlaps(capsule_box(p, p, 0)); });
        EXPECT_TRUE(near) << i;
    }
}

TEST(CachedField, CellsBetweenContainAllSuchValues) {
    const SolidField field(blend(std::array{sphere({}), sphere({1, 0, 0})}));
    const CachedField cached(field);
    const auto cells = cached.cells_between(0.42f, 0.45f);
    EXPECT_LT(cells.size(), 512 * cached.blocks().size() / 4);
    const auto points = random_points_in(field.surface_bounds(), 20000);
    std::vector<float> values(points.size());
    cached.values(points, values);
    int found = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (values[i] < 0.421f || values[i] > 0.449f) continue;
        ++found;
        EXPECT_TRUE(std::any_of(cells.begin(), cells.end(), [&](Vec3 low) {
            const Vec3 d = points[i] - low;
            return std::min({d.x, d.y, d.z}) > -1e-5f && std::max({d.x, d.y, d.z}) < cached.cell() + 1e-5f;
        }));
    }
    EXPECT_GT(found, 20);
    EXPECT_TRUE(cached.cells_between(5, 6).empty());
}

TEST(CachedField, AcceptsAnyField) {
    const SolidField field(circle({}, {0, 0, 1}, 1, {.radius = 0.4f}));
    const CachedField plain(FieldRef(field), field.bounds(), {.cell = 0.05f}), known(field, {.cell = 0.05f});
    EXPECT_LT(max_error(field, plain, 0.1f, field.bounds()), 0.05f);
    EXPECT_LE(plain.blocks().size(), known.blocks().size());
    EXPECT_EQ(plain.level(), 0.5f);
}

TEST(CachedField, IsBitIdenticalForAnyNumberOfThreads) {
    TreeMaker maker(77);
    const SolidField field(maker.tree(4).solid);
    const auto points = random_points_in(field.surface_bounds(), 5000);
    const auto one = samples(FieldRef(CachedField(field, {}, {.threads = 1})), points);
    for (const unsigned threads : {2u, 7u}) {
        const auto more = samples(FieldRef(CachedField(field, {}, {.threads = threads})), points);
        EXPECT_EQ(std::memcmp(one.data(), more.data(), one.size() * sizeof(FieldSample)), 0);
    }
}

TEST(CachedField, RejectsInvalidCellsAndBoxes) {
    const SolidField field(sphere({}));
    EXPECT_NO_THROW(check_fields(CacheOptions{}, "cache"));
    EXPECT_THROW(CachedField(field, {.cell = 1e-6f}), InvalidInput);
    EXPECT_THROW(CachedField(field, {.cell = -1}), InvalidInput);
    EXPECT_THROW(CachedField(field, {.cell = std::numeric_limits<float>::quiet_NaN()}), InvalidInput);
    EXPECT_THROW(CachedField(field, {.band = 0}), InvalidInput);
    EXPECT_THROW(CachedField(FieldRef(field), {{-Box3::kInfinity, 0, 0}, {1, 1, 1}}), InvalidInput);
    // The minimum cell that the message names is accepted.
    EXPECT_NO_THROW(CachedField(field, {.cell = 1}));
}

TEST(CachedField, IsZeroOutsideAndForEmptySolids) {
    const SolidField nothing(intersect(std::array{sphere({0, 0, 0}), sphere({100, 0, 0})}));
    const CachedField cached(nothing);
    EXPECT_TRUE(cached.blocks().empty());
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<Vec3> points{{0, 0, 0}, {nan, 0, 0}, {1e30f, 0, 0}};
    for (const FieldSample& s : samples(FieldRef(cached), points)) EXPECT_EQ(s.value, 0);
    for (const FieldSample& s : samples(FieldRef(CachedField(SolidField(sphere({5, 5, 5})))), points)) {
        EXPECT_EQ(s.value, 0);
    }
}

}  // namespace
}  // namespace coppice
