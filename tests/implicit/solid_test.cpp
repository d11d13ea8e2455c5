#include "coppice/implicit/solid/solid.h"

#include <gtest/gtest.h>

#include <limits>

#include "coppice/base/check_fields.h"
#include "coppice/implicit/solid/solid_field.h"
#include "implicit/trees.h"

namespace coppice {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

void expect_box(const Box3& box, Vec3 low, Vec3 high, float tolerance = 1e-4f) {
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(box.low[axis], low[axis], tolerance) << axis;
        EXPECT_NEAR(box.high[axis], high[axis], tolerance) << axis;
    }
}

TEST(Solid, BoxesOfPrimitivesAreTight) {
    const PrimitiveOptions o{.radius = 1, .influence = 2};
    expect_box(sphere({1, 2, 3}, o).surface_bounds(), {0, 1, 2}, {2, 3, 4});
    expect_box(sphere({1, 2, 3}, o).bounds(), {-1, 0, 1}, {3, 4, 5});
    expect_box(line({0, 0, 0}, {0, 0, 5}, o).surface_bounds(), {-1, -1, -1}, {1, 1, 6});
    expect_box(circle({}, {0, 0, 1}, 3, o).surface_bounds(), {-4, -4, -1}, {4, 4, 1});
    // A disc of radius sqrt 2 perpendicular to (1, 1, 0) extends to 1 along x and y.
    expect_box(disc({}, {1, 1, 0}, std::sqrt(2.0f), o).surface_bounds(), {-2, -2, -1 - std::sqrt(2.0f)},
               {2, 2, 1 + std::sqrt(2.0f)});
    expect_box(box({{0, 0, 0}, {1, 2, 3}}, o).surface_bounds(), {-1, -1, -1}, {2, 3, 4});
    expect_box(cylinder({0, 0, 0}, {4, 0, 0}, 2, o).surface_bounds(), {-1, -3, -3}, {5, 3, 3});
    expect_box(cone({0, 0, 0}, {0, 0, 4}, 2, 0, o).surface_bounds(), {-3, -3, -1}, {3, 3, 5});
    // An ellipsoid, rotated by 90 degrees.
    const Solid ellipsoid =
        rotated(scaled(sphere({}, o), {3, 1, 1}), {0, 0, 1}, std::numbers::pi_v<float> / 2);
    expect_box(ellipsoid.surface_bounds(), {-1, -3, -1}, {1, 3, 1});
}

TEST(Solid, BoxesOfWarpsAreTight) {
    const PrimitiveOptions o{.radius = 0.1f, .influence = 0.2f};
    // A rod along z of length pi, bent into a half circle of radius 1 towards x.
    const Solid rod = line({0, 0, 0}, {0, 0, std::numbers::pi_v<float>}, o);
    const Solid arc =
        bent(rod, {0, 0, 0}, {0, 0, std::numbers::pi_v<float>}, {1, 0, 0}, std::numbers::pi_v<float>);
    expect_box(arc.surface_bounds(), {-0.1f, -0.1f, -0.1f}, {2.1f, 0.1f, 1.1f});
    // Twice as wide from z = 1 on.
    const Solid cup = tapered(cylinder({0, 0, 0}, {0, 0, 2}, 1, o), {0, 0, 0}, {0, 0, 1}, 2);
    expect_box(cup.surface_bounds(), {-2.2f, -2.2f, -0.1f}, {2.2f, 2.2f, 2.1f});
}

TEST(Solid, BoundsContainTheSupportAndTheSurface) {
    std::vector<Twin> twins = primitive_twins(FieldLaw::soft);
    for (std::uint64_t seed = 0; seed < 80; ++seed)
        twins.push_back(TreeMaker(300 + seed).tree(static_cast<int>(seed % 5)));
    for (std::size_t i = 0; i < twins.size(); ++i) {
        SCOPED_TRACE(i);
        const Twin& twin = twins[i];
        const Box3 support = twin.solid.bounds(), surface = twin.solid.surface_bounds();
        Box3 drawn = support;
        if (drawn.empty()) drawn = {{-3, -3, -3}, {3, 3, 3}};
        for (const Vec3 p : random_points_in(drawn.inflated(0.3f * drawn.diagonal()), 3000)) {
            const double v = twin.field(Vec3d(p));
            const Box3 point = capsule_box(p, p, 0);
            ASSERT_TRUE(v <= 1e-9 || point.overlaps(support)) << p.x << " " << p.y << " " << p.z;
            ASSERT_TRUE(v < 0.5 || point.overlaps(surface)) << p.x << " " << p.y << " " << p.z;
        }
    }
}

TEST(Solid, BoundsOfManyBlendedPartsContainTheirSum) {
    // A hundred spheres at one place: the sum is 0.5 where one alone is 0.005.
    const std::vector<Solid> many(100, sphere({}));
    const Solid all = blend(many);
    const double r = std::sqrt(1 - std::cbrt(0.005)) / std::sqrt(1 - std::cbrt(0.5));
    const auto f = static_cast<float>(r);
    expect_box(all.surface_bounds(), {-f, -f, -f}, {f, f, f}, 1e-3f);
}

TEST(Solid, HasKindPartsAndDepth) {
    const Solid s = unite(std::array{sphere({}), translated(line({0, 0, 0}, {1, 0, 0}), {0, 0, 1})});
    EXPECT_EQ(s.kind(), "union");
    ASSERT_EQ(s.parts().size(), 2u);
    EXPECT_EQ(s.parts()[1].kind(), "transform");
    EXPECT_EQ(s.part_count(), 4u);
    EXPECT_EQ(s.depth(), 3u);
    // Consecutive maps are composed.
    EXPECT_EQ(translated(translated(sphere({}), {1, 0, 0}), {1, 0, 0}).depth(), 2u);
    EXPECT_EQ(blend(std::array{sphere({})}).kind(), "sphere");
    EXPECT_EQ(bent(s, {0, 0, -5}, {0, 0, 20}, {1, 0, 0}, 0.5f).kind(), "bend");
}

TEST(Solid, OptionsHaveDefaultsInRange) { EXPECT_NO_THROW(check_fields(PrimitiveOptions{}, "primitive")); }

TEST(Solid, RejectsInvalidNumbers) {
    const Solid s = sphere({});
    const std::vector<Solid> none;
    for (const float bad : {kNan, kInf, -kInf, -1.0f, 1e30f}) {
        SCOPED_TRACE(bad);
        EXPECT_THROW(sphere({}, {.radius = bad}), InvalidInput);
        EXPECT_THROW(sphere({}, {.influence = bad}), InvalidInput);
        EXPECT_THROW(circle({}, {0, 0, 1}, bad), InvalidInput);
        EXPECT_THROW(disc({}, {0, 0, 1}, bad), InvalidInput);
        EXPECT_THROW(cylinder({}, {0, 0, 1}, bad), InvalidInput);
        EXPECT_THROW(cone({}, {0, 0, 1}, bad, 1), InvalidInput);
        EXPECT_THROW(cone({}, {0, 0, 1}, 1, bad), InvalidInput);
        EXPECT_THROW(ricci_blend(std::array{s, s}, bad), InvalidInput);
        EXPECT_THROW(tapered(s, {}, {0, 0, 1}, bad), InvalidInput);
        EXPECT_THROW(bent(s, {0, 0, -10}, {0, 0, 30}, {1, 0, 0}, bad), InvalidInput);
        if (bad == -1.0f) continue;
        const Vec3 p{0, bad, 0};
        EXPECT_THROW(sphere(p), InvalidInput);
        EXPECT_THROW(line({}, p), InvalidInput);
        EXPECT_THROW(box({{-1, -1, -1}, {1, bad, 1}}), InvalidInput);
        EXPECT_THROW(polyline(std::array{Vec3{}, p}), InvalidInput);
        EXPECT_THROW(polygon(std::array{Vec3{}, Vec3{1, 0, 0}, p}), InvalidInput);
        EXPECT_THROW(translated(s, p), InvalidInput);
        EXPECT_THROW(scaled(s, {1, bad, 1}), InvalidInput);
        EXPECT_THROW(rotated(s, {0, 0, 1}, bad), InvalidInput);
        EXPECT_THROW(rotated(s, p, 1), InvalidInput);
        EXPECT_THROW(twisted(s, {}, {0, 0, 1}, bad), InvalidInput);
        EXPECT_THROW(twisted(s, p, {0, 0, 1}, 1), InvalidInput);
        EXPECT_THROW(circle(p, {0, 0, 1}, 1), InvalidInput);
        EXPECT_THROW(transformed(s, Affine::scaling({1, double(bad), 1})), InvalidInput);
    }
    EXPECT_THROW(sphere({}, {.radius = 0}), InvalidInput);
    EXPECT_THROW(sphere({}, {.radius = 1, .influence = 1}), InvalidInput);
    EXPECT_THROW(sphere({}, {.radius = 1, .influence = 30}), InvalidInput);
    EXPECT_THROW(line({1, 1, 1}, {1, 1, 1}), InvalidInput);
    EXPECT_THROW(circle({}, {0, 0, 0}, 1), InvalidInput);
    EXPECT_THROW(cone({}, {0, 0, 1}, 0, 0), InvalidInput);
    EXPECT_THROW(box({}), InvalidInput);
    EXPECT_THROW(box({{0, 0, 0}, {1, 0, 1}}), InvalidInput);
    EXPECT_THROW(polyline(std::array{Vec3{1, 0, 0}, Vec3{1, 0, 0}}), InvalidInput);
    EXPECT_THROW(polyline(std::vector<Vec3>(100001)), InvalidInput);
    EXPECT_THROW(polygon(std::array{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{2, 0, 0}}), InvalidInput);
    EXPECT_THROW(polygon(std::array{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 1}}),
                 InvalidInput);
    EXPECT_THROW(scaled(s, {1, 0, 1}), InvalidInput);
    EXPECT_THROW(transformed(s, Affine::scaling({1, 1e-10, 1})), InvalidInput);
    EXPECT_THROW(unite(none), InvalidInput);
    EXPECT_THROW(subtract(s, none), InvalidInput);
    EXPECT_THROW(tapered(s, {}, {}, 2), InvalidInput);
    EXPECT_THROW(bent(s, {0, 0, 0}, {0, 0, 1}, {0, 0, 2}, 1), InvalidInput);
    // The field extends 2.2 m to the side, the bend's radius is 1.
    EXPECT_THROW(bent(s, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 1), InvalidInput);
}

TEST(Solid, LimitsPartsDepthAndExtent) {
    Solid s = sphere({});
    int doublings = 0;
    EXPECT_THROW(
        {
            for (; doublings < 60; ++doublings) s = blend(std::array{s, s});
        },
        InvalidInput);
    EXPECT_EQ(doublings, 18);  // 2^20 - 1 parts are too many
    Solid deep = sphere({});
    int levels = 0;
    EXPECT_THROW(
        {
            for (; levels < 1000; ++levels) deep = unite(std::array{deep, sphere({})});
        },
        InvalidInput);
    EXPECT_EQ(levels, 255);
    Solid big = sphere({});
    EXPECT_THROW(
        {
            for (int i = 0; i < 20; ++i) big = scaled(big, {1e3f, 1e3f, 1e3f});
        },
        InvalidInput);
    // The maximum nesting depth can be evaluated.
    const SolidField field(deep);
    const Vec3 p{1, 0, 0};
    float v;
    field.values(std::span(&p, 1), std::span(&v, 1));
    EXPECT_NEAR(v, 0.5f, 1e-5f);
}

}  // namespace
}  // namespace coppice
