#include "coppice/implicit/shape/skin.h"

#include "implicit/shape_support.h"

namespace coppice {
namespace {

constexpr SkinBlend kBlends[] = {SkinBlend::linear, SkinBlend::quadratic, SkinBlend::cubic,
                                 SkinBlend::smooth};

const std::vector<Vec2d> kSquare{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

Curve upright(float height) { return Curve(std::vector<Vec3>{{0, 0, 0}, {0, 0, height}}); }
Curve bent() { return Curve(std::vector<Vec3>{{0, 0, 0}, {1, 0, 4}, {5, 2, 7}, {9, 2, 6}}); }

Profile circle(double radius, Vec2d center = {}) { return Profile(circle_contour(center, radius, 512)); }

Profile star() {
    std::vector<Vec2d> corners;
    for (int i = 0; i < 10; ++i) {
        const double a = std::numbers::pi * i / 5, r = i % 2 ? 0.4 : 1.2;
        corners.push_back({r * std::cos(a), r * std::sin(a)});
    }
    return Profile(corners);
}

/// Four legs at one place, each a separate section, and a top at the other.
Skin table(SkinBlend blend) {
    std::vector<SkinSection> sections;
    for (const double x : {-2.0, 2.0})
        for (const double y : {-1.0, 1.0}) sections.push_back({0, circle(0.3, {x, y})});
    sections.push_back({1, Profile(std::vector<Vec2d>{{-3, -2}, {3, -2}, {3, 2}, {-3, 2}})});
    return Skin(upright(3), std::move(sections), {.blend = blend});
}

TEST(Skin, BlendsRadiiOfCircles) {
    // Distances to concentric circles are blended like their radii: 1 and 3, at a quarter of the path.
    const std::vector<SkinSection> sections{{0, circle(1)}, {1, circle(3)}};
    const auto radius = [&](SkinBlend blend) {
        return 4 - at(Skin(upright(8), sections, {.blend = blend}), {4, 0, 2}).value;
    };
    EXPECT_NEAR(radius(SkinBlend::linear), 1.5, 1e-3);
    EXPECT_NEAR(radius(SkinBlend::quadratic), 1 + 2 * 0.125, 1e-3);                 // 2 u^2
    EXPECT_NEAR(radius(SkinBlend::cubic), 1 + 2 * (0.75 * 0.75 * 0.75 / 6), 1e-3);  // (3 u)^3 / 6
    EXPECT_NEAR(radius(SkinBlend::smooth), 1.5, 1e-3);  // tangents of two sections are their chord
}

TEST(Skin, SmoothBlendHasContinuousTangentsAtSections) {
    // Radii 1, 2, 1, 2 at thirds: tangents vanish at both inner sections. Halfway u = 1/2: 1.5; at u = 1/4 of
    // the middle interval the Hermite weight is 0.15625.
    const Skin wave(upright(3),
                    {{0, circle(1)}, {1.0f / 3, circle(2)}, {2.0f / 3, circle(1)}, {1, circle(2)}},
                    {.blend = SkinBlend::smooth});
    EXPECT_NEAR(3 - at(wave, {3, 0, 1.5f}).value, 1.5, 1e-3);
    EXPECT_NEAR(3 - at(wave, {3, 0, 1.25f}).value, 2 - 0.15625, 1e-3);
    EXPECT_NEAR(at(wave, {3, 0, 1}).gradient.z, 0, 1e-3);
    EXPECT_NEAR(at(wave, {3, 0, 2}).gradient.z, 0, 1e-3);
}

TEST(Skin, PassesThroughEachSection) {
    const Curve path = bent();
    const std::vector<SkinSection> sections{
        {0, Profile(kSquare)}, {0.3f, circle(0.6, {0.2, 0.1})}, {0.55f, star()}, {1, circle(0.5)}};
    for (const SkinBlend blend : kBlends) {
        const Skin skin(path, sections, {.blend = blend});
        EXPECT_EQ(skin.station_count(), 4u);
        for (const SkinSection& s : sections) {
            const CurveFrame f = path.frame(path.at_fraction(s.fraction));
            const auto corners = s.profile.contours()[0];
            for (std::size_t i = 0; i < corners.size(); i += 1 + corners.size() / 40) {
                const Vec2d q = (corners[i] + corners[(i + 1) % corners.size()]) * 0.5;
                const Vec3d p = f.position + f.normal * q.x + f.binormal * q.y;
                EXPECT_NEAR(at(skin, Vec3(p)).value, 0, 2e-5) << static_cast<int>(blend) << ' ' << s.fraction;
            }
        }
    }
}

TEST(Skin, TableHasFourLegs) {
    for (const SkinBlend blend : kBlends) {
        const Skin t = table(blend);
        EXPECT_EQ(t.station_count(), 2u);
        for (const float x : {-2.0f, 2.0f})
            for (const float y : {-1.0f, 1.0f}) {
                EXPECT_LT(at(t, {x, y, 0.01f}).value, 0);
                EXPECT_GT(at(t, {x, y, -0.01f}).value, 0);
            }
        EXPECT_GT(at(t, {0, 0, 0.01f}).value, 0);
        EXPECT_GT(at(t, {0, 0, 0.3f}).value, 0);
        EXPECT_LT(at(t, {0, 0, 2.99f}).value, 0);
        EXPECT_LT(at(t, {2.9f, 1.9f, 2.99f}).value, 0);
        EXPECT_FLOAT_EQ(at(t, {2.3f, 1, 0}).value, 0);
    }
    // One section of four contours makes the same table.
    std::vector<std::vector<Vec2d>> legs;
    for (const double x : {-2.0, 2.0})
        for (const double y : {-1.0, 1.0}) legs.push_back(circle_contour({x, y}, 0.3, 512));
    const Skin same(upright(3), {{0, Profile(legs)},
                                 {1, Profile(std::vector<Vec2d>{{-3, -2}, {3, -2}, {3, 2}, {-3, 2}})}});
    const Skin linear = table(SkinBlend::linear);
    for (const Vec3 p : points_in(same.bounds(), 300, 0.2f))
        EXPECT_NEAR(at(same, p).value, at(linear, p).value, 1e-6);
}

TEST(Skin, OneSectionIsASweep) {
    const Skin skin(upright(4), {{0.5f, Profile(kSquare)}});
    EXPECT_FLOAT_EQ(at(skin, {3, 0, 1}).value, 2);
    EXPECT_FLOAT_EQ(at(skin, {3, 4, -6}).value, 7);
    EXPECT_FLOAT_EQ(at(skin, {0, 0, 3.75f}).value, -0.25f);
}

TEST(Skin, ExtendsTheFirstAndTheLastSection) {
    const Skin skin(upright(4), {{0.25f, circle(1)}, {0.75f, circle(2)}});
    EXPECT_NEAR(at(skin, {4, 0, 0.5f}).value, 3, 1e-4);
    EXPECT_NEAR(at(skin, {4, 0, 2}).value, 2.5, 1e-4);
    EXPECT_NEAR(at(skin, {4, 0, 3.5f}).value, 2, 1e-4);
}

TEST(Skin, ClosedPathIsInterpolatedAcrossItsStart) {
    std::vector<Vec3> ring;
    for (int i = 0; i < 64; ++i) {
        const float a = std::numbers::pi_v<float> * static_cast<float>(i) / 32;
        ring.push_back({5 * std::cos(a), 5 * std::sin(a), 0});
    }
    // Radius 1 at an eighth and 2 at five eighths of the ring: at the start, a quarter of the way back, it
    // is 1.25.
    for (const SkinBlend blend : kBlends) {
        const Skin skin(Curve(ring, {.closed = true}), {{0.125f, circle(1)}, {0.625f, circle(2)}},
                        {.blend = blend});
        const float before = at(skin, {5, -0.002f, 2.5f}).value, after = at(skin, {5, 0.002f, 2.5f}).value;
        EXPECT_NEAR(before, after, 1e-2);
        if (blend == SkinBlend::linear) {
            EXPECT_NEAR(after, 1.25, 1e-2);
        }
        EXPECT_NEAR(at(skin, {-5 * std::sqrt(0.5f), -5 * std::sqrt(0.5f), 2.5f}).value, 0.5, 1e-2);
    }
    // A section at the end of a closed path is equivalent to one at its start.
    const Skin same(Curve(ring, {.closed = true}), {{0, circle(1)}, {1, circle(1)}});
    EXPECT_EQ(same.station_count(), 1u);
}

TEST(Skin, GradientsMatchFiniteDifferences) {
    for (const SkinBlend blend : kBlends) {
        const Skin skin(
            bent(),
            {{0, Profile(kSquare)}, {0.4f, circle(0.6, {0.2, 0.1})}, {0.7f, star()}, {1, circle(0.5)}},
            {.blend = blend, .roll = 0.4f, .twist = 1.5f});
        EXPECT_LT(share_of_wrong_gradients(skin, points_in(bent().bounds(), 1000, 0.05f), 5e-4f, 0.03f),
                  0.05);
        expect_bounds_hold_the_inside(skin);
        expect_survives_strange_points(skin);
        expect_batch_does_not_matter(skin);
    }
}

TEST(Skin, AcceptsManySections) {
    std::vector<SkinSection> sections;
    for (int i = 0; i <= 1000; ++i)
        sections.push_back(
            {static_cast<float>(i) / 1000, Profile(circle_contour({}, 1 + 0.5 * std::sin(0.05 * i), 16))});
    const Skin skin(upright(10), sections, {.blend = SkinBlend::smooth});
    EXPECT_EQ(skin.station_count(), 1001u);
    EXPECT_NEAR(at(skin, {1 + 0.5f * std::sin(25.0f), 0, 5}).value, 0, 1e-4);
}

TEST(Skin, RejectsInvalidSections) {
    EXPECT_NE(error_of([] { Skin(upright(1), {}); }).find("1 to 10000 sections"), std::string::npos);
    EXPECT_NE(error_of([] { Skin(upright(1), {{kNan, circle(1)}}); }).find("section 1"), std::string::npos);
    EXPECT_NE(error_of([] {
                  Skin(upright(1), {{0, circle(1)}, {1.5f, circle(1)}});
              }).find("section 2"),
              std::string::npos);
    EXPECT_NE(error_of([] {
                  Skin(upright(1), {{0, Profile(kSquare, CurveKind::polyline, false)}});
              }).find("open"),
              std::string::npos);
    EXPECT_NE(error_of([] {
                  Skin(upright(1), {{0, circle(1)}}, {.twist = kInfinite});
              }).find("twist"),
              std::string::npos);
}

}  // namespace
}  // namespace coppice
