#include "coppice/foliage/leaf_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/foliage/leaf_species.h"
#include "described_options.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;

LeafShape make_flat(LeafShape shape) {
    shape.fold = shape.cup = shape.curl = shape.arch = shape.wave = shape.blade_angle = 0;
    return shape;
}

LeafShape make_bare(LeafShape shape) {
    shape.petiole_length = 0;
    return shape;
}

Vec3 compute_normal(const TriMesh& mesh, const Triangle& t) {
    const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    return 0.5f * cross(b - a, c - a);
}

double compute_surface(const TriMesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) sum += length(Vec3d(compute_normal(mesh, t)));
    return sum;
}

TEST(LeafShape, describes_all_members) { test::expect_described<LeafShape>(); }

/// The area of the outline t^a (1 - t)^b per length and width: B(a + 1, b + 1) over its maximum.
TEST(LeafShape, area_is_that_of_the_formula) {
    const std::vector<std::pair<LeafOutline, std::pair<double, double>>> outlines{
        {LeafOutline::elliptic, {0.75, 0.75}},
        {LeafOutline::ovate, {0.7, 1.1}},
        {LeafOutline::obovate, {1.2, 0.6}},
        {LeafOutline::lanceolate, {0.8, 1.2}},
        {LeafOutline::triangular, {0.3, 1.25}}};
    for (const auto& [outline, exponents] : outlines) {
        const auto [a, b] = exponents;
        const double widest = a / (a + b);
        const double maximum = std::pow(widest, a) * std::pow(1 - widest, b);
        const double ratio = std::tgamma(a + 1) * std::tgamma(b + 1) / std::tgamma(a + b + 2) / maximum;
        const LeafShape shape = make_bare({.outline = outline, .length = 0.1f, .width = 0.03f, .rows = 20});
        const LeafModel leaf = make_leaf(shape);
        EXPECT_NEAR(leaf.area / (0.1 * 0.03 * ratio), 1, 0.03) << name_of(outline);
        // Fold, cup and curl keep the area of the surface.
        EXPECT_NEAR(compute_surface(leaf.prototype.mesh) / leaf.area, 1, 0.01) << name_of(outline);
    }
}

TEST(LeafShape, given_exponents_replace_those_of_the_outline) {
    const LeafShape ovate = make_bare({.outline = LeafOutline::ovate});
    LeafShape given = ovate;
    given.outline = LeafOutline::linear;
    given.base_exponent = 0.7f;
    given.tip_exponent = 1.1f;
    EXPECT_DOUBLE_EQ(make_leaf(ovate).area, make_leaf(given).area);
}

TEST(LeafShape, faces_of_flat_leaves_face_up_and_are_not_degenerate) {
    for (const LeafSpecies& species : leaf_species()) {
        if (species.shape.parts == LeafParts::needles) continue;
        LeafShape shape = make_flat(make_bare(species.shape));
        if (shape.parts == LeafParts::pinnate)
            shape.leaflets = 1;  // without the stalk, which has a lower side
        const TriMesh mesh = make_leaf(shape).prototype.mesh;
        const double mean = compute_surface(mesh) / static_cast<double>(mesh.triangles.size());
        for (const Triangle& t : mesh.triangles)
            EXPECT_GT(double{compute_normal(mesh, t).z}, 1e-5 * mean) << species.name;
    }
}

TEST(LeafShape, faces_of_all_outlines_and_margins_face_up) {
    for (std::size_t outline = 0; outline < EnumNames<LeafOutline>::names.size(); ++outline) {
        for (std::size_t margin = 0; margin < EnumNames<LeafMargin>::names.size(); ++margin) {
            for (const int rows : {2, 7, 60}) {
                LeafShape shape = make_flat(make_bare({}));
                shape.outline = static_cast<LeafOutline>(outline);
                shape.margin = static_cast<LeafMargin>(margin);
                shape.rows = rows;
                shape.columns = 3;
                const TriMesh mesh = make_leaf(shape).prototype.mesh;
                EXPECT_TRUE(std::ranges::all_of(
                    mesh.triangles, [&](const Triangle& t) { return compute_normal(mesh, t).z > 0; }))
                    << name_of(shape.outline) << ' ' << name_of(shape.margin) << ' ' << rows;
            }
        }
    }
}

TEST(LeafShape, neighbours_have_the_same_orientation) {
    for (const LeafSpecies& species : leaf_species()) {
        const TriMesh mesh = make_leaf(species.shape).prototype.mesh;
        std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
        for (const Triangle& t : mesh.triangles) {
            for (std::size_t k = 0; k < 3; ++k)
                EXPECT_TRUE(edges.emplace(t[k], t[(k + 1) % 3]).second) << species.name;
        }
    }
}

/// A prism of a needle has its faces outside: the volume below them is positive.
TEST(LeafShape, faces_of_needles_face_outwards) {
    const TriMesh mesh = make_leaf(make_bare({.parts = LeafParts::needles, .leaflets = 1})).prototype.mesh;
    double volume = 0;
    for (const Triangle& t : mesh.triangles)
        volume += dot(Vec3d(mesh.positions[t[0]]), Vec3d(compute_normal(mesh, t))) / 3;
    EXPECT_GT(volume, 0);
}

TEST(LeafShape, texture_is_the_flat_leaf) {
    for (const LeafSpecies& species : leaf_species()) {
        const Prototype leaf = make_leaf(species.shape).prototype;
        ASSERT_EQ(leaf.texture.size(), 3 * leaf.mesh.triangles.size());
        for (const TexturePoint p : leaf.texture) {
            EXPECT_TRUE(p.u >= 0 && p.u <= 1 && p.v >= 0 && p.v <= 1) << species.name;
        }
    }
    const Prototype flat = make_leaf(make_flat({})).prototype;
    for (std::size_t i = 0; i < flat.texture.size(); ++i) {
        const Vec3 p = flat.mesh.positions[flat.mesh.triangles[i / 3][i % 3]];
        EXPECT_NEAR(flat.texture[i].u, p.x / 0.04f + 0.5f, 0.01);
        EXPECT_NEAR(flat.texture[i].v, p.y / 0.095f, 0.01);
    }
}

TEST(LeafShape, begins_at_the_origin_and_extends_along_y) {
    for (const LeafSpecies& species : leaf_species()) {
        const TriMesh mesh = make_leaf(species.shape).prototype.mesh;
        float nearest = 1, farthest = 0;
        for (const Vec3 p : mesh.positions) {
            nearest = std::min(nearest, length(p));
            farthest = std::max(farthest, p.y);
        }
        EXPECT_LT(nearest, species.shape.petiole_width) << species.name;
        EXPECT_GT(farthest, 0.6f * species.shape.length) << species.name;
    }
}

TEST(LeafShape, arch_bends_a_pinnate_leaf_as_a_whole_and_keeps_its_area) {
    LeafShape shape = make_flat({.parts = LeafParts::pinnate, .leaflets = 21, .leaflet_taper = 0.5f});
    shape.curl = 0;
    const LeafModel flat = make_leaf(shape);
    shape.arch = 1;
    const LeafModel arched = make_leaf(shape);
    const auto by_y = [](Vec3 a, Vec3 b) { return a.y < b.y; };
    const double length = double{std::ranges::max_element(flat.prototype.mesh.positions, by_y)->y};
    // The end of an arc of 1 rad is 1 - cos(1) lengths below its beginning.
    const auto by_z = [](Vec3 a, Vec3 b) { return a.z < b.z; };
    EXPECT_NEAR(std::ranges::min_element(arched.prototype.mesh.positions, by_z)->z,
                -length * (1 - std::cos(1.0)), 0.01 * length);
    EXPECT_DOUBLE_EQ(arched.area, flat.area);
}

TEST(LeafShape, curl_bends_the_tip_down_and_fold_raises_the_margins) {
    LeafShape shape = make_flat(make_bare({}));
    shape.curl = 1;
    const TriMesh curled = make_leaf(shape).prototype.mesh;
    const auto by_y = [](Vec3 a, Vec3 b) { return a.y < b.y; };
    // The tip of an arc of length l and angle 1: l (1 - cos 1) below its beginning.
    EXPECT_NEAR(std::ranges::max_element(curled.positions, by_y)->z, -0.08 * (1 - std::cos(1.0)), 1e-4);
    shape.curl = 0;
    shape.fold = 0.5f;
    const TriMesh folded = make_leaf(shape).prototype.mesh;
    for (const Vec3 p : folded.positions) EXPECT_NEAR(p.z, std::abs(p.x) * std::tan(0.5), 1e-6);
}

TEST(LeafShape, leaves_have_their_number_of_leaflets_and_needles) {
    const LeafShape simple = make_bare({});
    const std::size_t blade = make_leaf(simple).prototype.mesh.triangles.size();
    LeafShape palmate = simple;
    palmate.parts = LeafParts::palmate;
    palmate.leaflets = 7;
    EXPECT_EQ(make_leaf(palmate).prototype.mesh.triangles.size(), 7 * blade);
    LeafShape pinnate = palmate;
    pinnate.parts = LeafParts::pinnate;
    EXPECT_EQ(make_leaf(pinnate).prototype.mesh.triangles.size(), 7 * blade + 12);  // a stalk of two rows
    LeafShape one = simple;
    one.parts = LeafParts::needles;
    one.leaflets = 1;
    LeafShape five = one;
    five.leaflets = 5;
    EXPECT_NEAR(make_leaf(five).area / make_leaf(one).area, 5, 1e-4);
}

TEST(LeafShape, lobes_remove_area_and_keep_the_tip) {
    const LeafShape whole = make_bare({.outline = LeafOutline::obovate, .rows = 80});
    LeafShape lobed = whole;
    lobed.lobes = LeafLobes::pinnate;
    EXPECT_LT(make_leaf(lobed).area, 0.85 * make_leaf(whole).area);
    EXPECT_GT(make_leaf(lobed).area, 0.6 * make_leaf(whole).area);
    LeafShape palmate = make_flat(whole);
    palmate.lobes = LeafLobes::palmate;
    palmate.lobe_count = 5;
    float width = 0, tip = 0;
    for (const Vec3 p : make_leaf(palmate).prototype.mesh.positions) {
        width = std::max(width, 2 * p.x);
        tip = std::max(tip, p.y);
    }
    EXPECT_NEAR(width, palmate.width, 1e-5);
    EXPECT_NEAR(tip, palmate.length, 1e-5);
}

TEST(LeafShape, teeth_need_two_rows_each) {
    LeafShape shape =
        make_bare({.margin = LeafMargin::serrate, .teeth = 10, .tooth_depth = 0.05f, .rows = 19});
    LeafShape entire = shape;
    entire.margin = LeafMargin::entire;
    EXPECT_DOUBLE_EQ(make_leaf(shape).area, make_leaf(entire).area);
    shape.rows = entire.rows = 20;
    const auto corners = make_leaf(shape).prototype.mesh.positions;
    EXPECT_GT(corners.size(), make_leaf(entire).prototype.mesh.positions.size());
    EXPECT_NEAR(make_leaf(shape).area / make_leaf(entire).area, 1, 0.06);  // the mean height of teeth is 0
}

TEST(LeafShape, variants_differ_and_the_first_one_is_the_shape) {
    const std::vector<LeafModel> leaves = make_leaves({}, 3);
    ASSERT_EQ(leaves.size(), 3u);
    EXPECT_TRUE(
        std::ranges::equal(leaves[0].prototype.mesh.positions, make_leaf({}).prototype.mesh.positions));
    EXPECT_FALSE(std::ranges::equal(leaves[0].prototype.mesh.positions, leaves[1].prototype.mesh.positions));
    EXPECT_FALSE(std::ranges::equal(leaves[1].prototype.mesh.positions, leaves[2].prototype.mesh.positions));
    EXPECT_EQ(leaves[2].prototype.name, "leaf_elliptic_3");
}

TEST(LeafShape, card_bounds_the_flat_leaf) {
    const LeafModel card = make_leaf_card({});
    EXPECT_EQ(card.prototype.mesh.triangles.size(), 2u);
    EXPECT_DOUBLE_EQ(card.area > 0 ? card.area / make_leaf({}).area : 0, 1);
    EXPECT_NEAR(compute_surface(card.prototype.mesh), 0.04 * 0.095, 2e-5);
    EXPECT_EQ(card.prototype.texture.front(), (TexturePoint{0, 0}));
}

TEST(LeafShape, refuses_numbers_out_of_range) {
    EXPECT_EQ(error_of([] { make_leaf({.length = 0}); }),
              "leaf: length must be between 0.001 and 10, but is 0");
    EXPECT_EQ(error_of([] { make_leaves({}, 0); }),
              "leaf: the number of models must be between 1 and 1000, but is 0");
    EXPECT_NE(error_of([] { make_leaf_card({.rows = 1}); }), "no error");
}

}  // namespace
}  // namespace coppice
