#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/pipeline/displace.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/random_tree.h"

namespace coppice {
namespace {

constexpr auto kBark = static_cast<std::uint32_t>(MaterialSlot::bark);
constexpr auto kTwig = static_cast<std::uint32_t>(MaterialSlot::twig);
constexpr auto kCut = static_cast<std::uint32_t>(MaterialSlot::cut);

MeshOptions with_slots(float twig_diameter, bool cuts = true) {
    MeshOptions options;
    options.texture = {TextureCoordinates::bark, 0.1f};
    options.slots = {
        .twigs = twig_diameter > 0, .twig_diameter = std::max(twig_diameter, 1e-6f), .cuts = cuts};
    return options;
}

// A stem that bends and tapers from a radius of 0.1 m to 0.02 m, with a bulge near its tip.
Skeleton tapered_stem() {
    std::vector<NodeId> parent{NodeId::none()};
    std::vector<Vec3> position{{0, 0, 0}};
    std::vector<float> radius{0.1f};
    for (std::uint32_t i = 1; i <= 8; ++i) {
        const auto t = static_cast<float>(i) / 8;
        parent.emplace_back(i - 1);
        position.push_back({0.5f * t * t, 0, 2 * t});
        radius.push_back(i == 7 ? 0.07f : 0.1f - 0.08f * t);
    }
    return {parent, position, radius};
}

// Returns the lengths in edges of the loops between the faces of a slot and others, ascending.
std::vector<std::size_t> find_border(const QuadMesh& mesh, std::span<const std::uint32_t> slots,
                                     std::uint32_t slot) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> sides;
    for (std::size_t f = 0; f < mesh.quads.size(); ++f) {
        for (std::size_t k = 0; k < 4 && slots[f] == slot; ++k)
            sides.emplace(mesh.quads[f][k], mesh.quads[f][(k + 1) % 4]);
    }
    std::map<std::uint32_t, std::uint32_t> next;  // along the border
    for (const auto& [a, b] : sides) {
        if (!sides.contains({b, a})) next[a] = b;
    }
    std::vector<std::size_t> out;
    while (!next.empty()) {
        std::size_t length = 0;
        for (auto it = next.begin(); it != next.end(); ++length) {
            const std::uint32_t to = it->second;
            next.erase(it);
            it = next.find(to);
        }
        out.push_back(length);
    }
    std::ranges::sort(out);
    return out;
}

// Returns the area of the faces of a slot in the texture, in unit squares.
double texture_area(const MeshResult& made, std::uint32_t slot) {
    double sum = 0;
    for (std::size_t f = 0; f < made.slots.size(); ++f) {
        if (made.slots[f] != slot) continue;
        const TexturePoint* p = &made.texture->points[4 * f];
        sum += 0.5 * double{(p[2].u - p[0].u) * (p[3].v - p[1].v) - (p[3].u - p[1].u) * (p[2].v - p[0].v)};
    }
    return sum;
}

TEST(MaterialSlots, OneRingSeparatesTheTwigOfAStem) {
    for (const TubeSides sides : {TubeSides::equal, TubeSides::by_radius}) {
        MeshOptions options = with_slots(0.12f);
        options.tube_sides = sides;
        const MeshResult made = mesh_skeleton(tapered_stem(), options);
        const QuadMesh& mesh = made.quads().mesh;
        ASSERT_EQ(made.slots.size(), mesh.quads.size());
        const std::vector<std::size_t> rim = find_border(mesh, made.slots, kCut);
        ASSERT_EQ(rim.size(), 1u);
        const std::vector<std::size_t> border = find_border(mesh, made.slots, kTwig);
        ASSERT_EQ(border.size(), 1u);  // the bulge beyond it does not separate another part
        EXPECT_TRUE(sides != TubeSides::equal || border[0] == rim[0]);
        float low = 10, high = 0;  // of the twig and of the rest
        for (std::size_t f = 0; f < mesh.quads.size(); ++f) {
            for (const std::uint32_t v : mesh.quads[f]) {
                const float z = mesh.positions[v].z;
                if (made.slots[f] == kTwig) low = std::min(low, z);
                if (made.slots[f] == kBark) high = std::max(high, z);
            }
        }
        EXPECT_NEAR(low, 1.8, 0.06);  // where the radius is 0.06 m, beyond the bulge
        EXPECT_NEAR(high, 1.8, 0.1);
    }
}

TEST(MaterialSlots, EveryTwigOfATreeIsOnePart) {
    const Skeleton tree = random_tree(200, 5, true);
    std::vector<float> radii(tree.radii().begin(), tree.radii().end());
    std::ranges::sort(radii);
    const float middle = 2 * radii[radii.size() / 2];
    const MeshResult made = mesh_skeleton(tree, with_slots(middle, false));
    const auto border = find_border(made.quads().mesh, made.slots, kTwig);
    ASSERT_FALSE(border.empty());
    EXPECT_EQ(std::ranges::count(made.slots, kCut), 0);
    // Nothing is a twig below the minimum radius, and everything above the maximum.
    EXPECT_EQ(std::ranges::count(mesh_skeleton(tree, with_slots(1e-6f, false)).slots, kTwig), 0);
    const auto all = mesh_skeleton(tree, with_slots(1e6f, false)).slots;
    EXPECT_EQ(std::ranges::count(all, kTwig), static_cast<std::ptrdiff_t>(all.size()));
}

TEST(MaterialSlots, CutsAreDiscsInTheUnitSquare) {
    MeshOptions options = with_slots(0);
    options.control.tips = TipShape::flat;
    options.texture.tile_height = 0.3f;
    options.texture.blend = true;
    const MeshResult made = mesh_skeleton(tapered_stem(), options);
    const QuadMesh& mesh = made.quads().mesh;
    EXPECT_EQ(find_border(mesh, made.slots, kCut).size(), 2u);
    EXPECT_NEAR(texture_area(made, kCut), 2 * 0.25 * 3.14159, 0.1);
    float low = 1, high = 0;
    for (std::size_t i = 0; i < made.texture->points.size(); ++i) {
        if (made.slots[i / 4] != kCut) continue;
        const auto [u, v] = made.texture->points[i];
        low = std::min({low, u, v});
        high = std::max({high, u, v});
        EXPECT_LE(std::hypot(u - 0.5f, v - 0.5f), 0.5f + 1e-4f);
        EXPECT_EQ(made.texture->blends[i], (TextureBlend{{u, v}, 0}));
    }
    EXPECT_NEAR(low, 0, 0.03);
    EXPECT_NEAR(high, 1, 0.03);
}

TEST(MaterialSlots, TrianglesAndCylindersHaveThem) {
    MeshOptions options = with_slots(0.12f);
    options.method = MeshMethod::tetrahedra;
    options.tetra.edge = 0.2f;  // larger triangles cut the rims of ends
    const MeshResult triangles = mesh_skeleton(tapered_stem(), options);
    EXPECT_EQ(triangles.slots.size(), triangles.tetrahedra().mesh.triangles.size());
    EXPECT_GT(std::ranges::count(triangles.slots, kTwig), 100);
    EXPECT_GT(std::ranges::count(triangles.slots, kCut), 10);
    options.method = MeshMethod::cylinders;
    EXPECT_THROW(mesh_skeleton(tapered_stem(), options), InvalidInput);
    options.slots.twigs = false;
    const MeshResult tubes = mesh_skeleton(tapered_stem(), options);
    EXPECT_EQ(tubes.slots.size(), tubes.cylinders().mesh.face_count());
    EXPECT_GT(std::ranges::count(tubes.slots, kCut), 4);
    options.texture.coordinates = TextureCoordinates::none;
    EXPECT_THROW(mesh_skeleton(tapered_stem(), options), InvalidInput);
}

TEST(MaterialSlots, DoNotChangeOtherCoordinatesOrDisplacement) {
    MeshOptions options = with_slots(0.12f);
    MeshResult made = mesh_skeleton(tapered_stem(), options);
    options.slots = {};
    MeshResult plain = mesh_skeleton(tapered_stem(), options);
    EXPECT_TRUE(plain.slots.empty());
    EXPECT_EQ(made.quads().mesh.positions, plain.quads().mesh.positions);
    for (std::size_t i = 0; i < made.texture->points.size(); ++i) {
        if (made.slots[i / 4] == kCut) continue;
        ASSERT_EQ(made.texture->points[i], plain.texture->points[i]);
    }
    HeightTexture heights{64, 64, 0.01f, {}};
    for (int i = 0; i < 64 * 64; ++i)
        heights.heights.push_back(static_cast<std::uint16_t>(i % 64 < 32 ? 0 : 65535));
    displace_surface(made, tapered_stem(), heights, {});
    const Vec3 axis = normalized(tapered_stem().position(NodeId(1)));
    EXPECT_NE(made.quads().mesh.positions, plain.quads().mesh.positions);
    for (std::size_t f = 0; f < made.slots.size(); ++f) {
        if (made.slots[f] != kCut) continue;
        for (const std::uint32_t v : made.quads().mesh.quads[f])
            EXPECT_NEAR(dot(made.quads().mesh.positions[v], axis), 0, 1e-5);
    }
}

TEST(MaterialSlots, DoNotDependOnTheNumberOfThreads) {
    const Skeleton tree = random_tree(100, 3, true);
    const auto slots = [&](unsigned threads) {
        return mesh_skeleton(tree, with_slots(0.1f), {.threads = threads}).slots;
    };
    EXPECT_EQ(slots(1), slots(3));
}

TEST(MaterialSlots, TwigsHaveTilesOfTheirOwn) {
    // A fifth of the area is a branch with a girth of 3 cm.
    const Skeleton tree({NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(3), NodeId(4)},
                        {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {3, 0, 2}, {6, 0, 3}, {10, 0, 4}},
                        {0.1f, 0.1f, 0.1f, 0.005f, 0.005f, 0.005f});
    MeshOptions options = with_slots(0.02f);
    options.texture.tile = 0.3f;
    const TextureReport plain = mesh_skeleton(tree, options).texture->report;
    EXPECT_GT(plain.density_p95, 8);  // 0.3 / 0.03 without tiles of twigs
    options.slots.twig_tile = 0.03f;
    for (const MeshMethod method : {MeshMethod::quads, MeshMethod::tetrahedra}) {
        options.method = method;
        const TextureReport report = mesh_skeleton(tree, options).texture->report;
        EXPECT_LT(report.density_p95, 2.0) << name_of(method);
        EXPECT_GT(report.density_p5, 0.4) << name_of(method);  // quads: 0.49 around the fork
        EXPECT_EQ(report.flipped, 0u);
    }
}

}  // namespace
}  // namespace coppice
