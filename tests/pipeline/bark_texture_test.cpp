#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/random_tree.h"
#include "zoo.h"

namespace coppice {
namespace {

MeshOptions with_bark(float tile) {
    MeshOptions options;
    options.texture = {TextureCoordinates::bark, tile};
    return options;
}

MeshOptions with_blends(float tile) {
    MeshOptions options = with_bark(tile);
    options.texture.blend = true;
    return options;
}

// A vertical stem of equal segments.
Skeleton stem(float radius, float length, std::uint32_t segments = 4) {
    std::vector<NodeId> parent{NodeId::none()};
    std::vector<Vec3> position{{0, 0, 0}};
    for (std::uint32_t i = 1; i <= segments; ++i) {
        parent.emplace_back(i - 1);
        position.push_back({0, 0, length * static_cast<float>(i) / static_cast<float>(segments)});
    }
    return {parent, position, std::vector<float>(segments + 1, radius)};
}

// A stem with a thinner branch at half its length.
Skeleton stem_with_branch() {
    return {{NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(3)},
            {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0.8f, 0, 1.6f}, {1.6f, 0, 2.2f}},
            {0.1f, 0.1f, 0.09f, 0.04f, 0.04f}};
}

// Edges of a textured surface of quads.
struct Edges {
    int continuous = 0;  // the same coordinates on both sides
    int seams = 0;       // u differs by a whole number
    int breaks = 0;      // others
    int steps = 0;       // of these, the edges at which v differs
};

Edges count_edges(const QuadMesh& mesh, const Texture& texture) {
    using Side = std::array<TexturePoint, 2>;
    std::map<std::pair<std::uint32_t, std::uint32_t>, Side> first;
    Edges out;
    for (std::size_t f = 0; f < mesh.quads.size(); ++f) {
        for (std::size_t k = 0; k < 4; ++k) {
            const std::uint32_t a = mesh.quads[f][k], b = mesh.quads[f][(k + 1) % 4];
            Side side{texture.points[4 * f + k], texture.points[4 * f + (k + 1) % 4]};
            if (a > b) std::swap(side[0], side[1]);
            const auto [found, is_first] = first.try_emplace(std::minmax(a, b), side);
            if (is_first) continue;
            const float du = side[0].u - found->second[0].u, other = side[1].u - found->second[1].u;
            const float dv =
                std::max(std::abs(side[0].v - found->second[0].v), std::abs(side[1].v - found->second[1].v));
            const bool is_whole = std::abs(du - std::round(du)) < 1e-3f && std::abs(du - other) < 1e-3f;
            if (dv > 1e-3f || !is_whole) {
                ++out.breaks;
                out.steps += dv > 1e-3f ? 1 : 0;
            } else {
                ++(std::abs(du) < 0.5f ? out.continuous : out.seams);
            }
        }
    }
    return out;
}

TEST(BarkTexture, WrapsAStemAWholeNumberOfTimesWithoutDistortion) {
    const float radius = 0.25f, length = 4, tile = 0.4f;  // circumference 1.571: 3.93 tiles
    const MeshResult made = mesh_skeleton(stem(radius, length), with_bark(tile));
    const QuadMesh& mesh = made.quads().mesh;
    const Texture& texture = *made.texture;
    ASSERT_EQ(texture.points.size(), 4 * mesh.quads.size());
    EXPECT_EQ(texture.report.axes, 1u);
    EXPECT_EQ(texture.report.flipped, 0u);
    EXPECT_EQ(texture.report.projected, 0u);
    float max_u = 0, low = 1e9f, high = -1e9f;
    for (std::size_t f = 0; f < mesh.quads.size(); ++f) {
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3 p = mesh.positions[mesh.quads[f][k]];
            if (p.z < 0.1f || p.z > length - radius) continue;  // ends
            const TexturePoint t = texture.points[4 * f + k];
            max_u = std::max(max_u, t.u);
            low = std::min(low, t.v - 4 * p.z / (2 * std::numbers::pi_v<float> * radius));
            high = std::max(high, t.v - 4 * p.z / (2 * std::numbers::pi_v<float> * radius));
        }
    }
    EXPECT_FLOAT_EQ(max_u, 4);    // 3.93, rounded
    EXPECT_LT(high - low, 0.3f);  // v has the scale of u; the length is 10.2 tiles
    // 3.93 tiles of the given width around the stem have become 4.
    EXPECT_NEAR(texture.report.density_p50, 4 / 3.93, 0.03);
}

TEST(BarkTexture, HasOneSeamAlongAStemAndBreaksAtItsEnds) {
    for (const int levels : {0, 1, 2, 3}) {
        MeshOptions options = with_bark(0.4f);
        options.levels = levels;
        const MeshResult made = mesh_skeleton(stem(0.2f, 3), options);
        const int n = 1 << levels;
        const QuadMesh& mesh = made.quads().mesh;
        const Edges edges = count_edges(mesh, *made.texture);
        // The caps have one quad of the cage at the tip and five at the base; rows have 4 n quads.
        const int sides = static_cast<int>(mesh.quads.size()) - 6 * n * n;
        EXPECT_EQ(edges.seams, sides / (4 * n)) << levels;
        EXPECT_EQ(edges.breaks, 2 * 4 * n) << levels;  // the rims of both caps
    }
}

TEST(BarkTexture, BreaksAtAForkOnlyAroundTheLateral) {
    MeshOptions options = with_bark(0.1f);
    options.fit = Fit::surface;
    const MeshResult made = mesh_skeleton(stem_with_branch(), options);
    ASSERT_EQ(made.quads().repair.pairs_before, 0u);
    const Edges edges = count_edges(made.quads().mesh, *made.texture);
    EXPECT_EQ(made.texture->report.axes, 2u);
    EXPECT_EQ(made.texture->report.transferred, 0u);
    EXPECT_EQ(made.texture->report.flipped, 0u);
    EXPECT_EQ(edges.breaks, 4 * 4 * 4);  // three caps, and the rim of the lateral, of 4 x 4 edges each
}

TEST(BarkTexture, IsContinuousOppositeLateralsOfOneSide) {
    // The rings below and above the laterals have a side in common, opposite them.
    const Skeleton tree({NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(1)},
                        {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0.8f, 0, 1.9f}, {0.8f, 0.3f, 1.2f}},
                        {0.1f, 0.1f, 0.09f, 0.06f, 0.05f});
    MeshOptions options = with_bark(0.2f);
    options.levels = 1;
    const MeshResult made = mesh_skeleton(tree, options);
    const Edges edges = count_edges(made.quads().mesh, *made.texture);
    EXPECT_EQ(made.texture->report.transferred, 0u);
    EXPECT_EQ(made.texture->report.flipped, 0u);
    EXPECT_EQ(edges.steps, 4 * 8 + 8);  // four caps, and the common rim of both laterals
}

TEST(BarkTexture, TurnsNoFaceOverOnAnySkeleton) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        for (const MeshMethod method :
             {MeshMethod::quads, MeshMethod::tetrahedra, MeshMethod::ramifications}) {
            MeshOptions options = with_bark(0.3f);
            options.method = method;
            const MeshResult made = mesh_skeleton(skeleton, options);
            const std::size_t corners = method == MeshMethod::tetrahedra
                                            ? 3 * made.tetrahedra().mesh.triangles.size()
                                            : 4 * made.quads().mesh.quads.size();
            EXPECT_EQ(made.texture->points.size(), corners) << name;
            EXPECT_EQ(made.texture->report.flipped, 0u) << name << ' ' << name_of(method);
            for (const TexturePoint& p : made.texture->points)
                ASSERT_TRUE(std::isfinite(p.u) && std::isfinite(p.v));
        }
    }
}

TEST(BarkTexture, IsKeptWithFewerQuadsAroundThinBranches) {
    MeshOptions options = with_bark(0.2f);
    options.tube_sides = TubeSides::by_radius;
    const Skeleton tree = random_tree(300, 7);
    const MeshResult coarse = mesh_skeleton(tree, options);
    EXPECT_EQ(coarse.texture->points.size(), 4 * coarse.quads().mesh.quads.size());
    EXPECT_EQ(coarse.texture->report.flipped, 0u);
    options.tube_sides = TubeSides::equal;
    const MeshResult fine = mesh_skeleton(tree, options);
    EXPECT_NEAR(coarse.texture->report.density_p50, fine.texture->report.density_p50,
                0.2 * fine.texture->report.density_p50);
}

TEST(BarkTexture, IsTheSameForAnyNumberOfThreads) {
    const Skeleton tree = random_tree(400, 3);
    const Texture one = *mesh_skeleton(tree, with_blends(0.2f), {.threads = 1}).texture;
    const Texture three = *mesh_skeleton(tree, with_blends(0.2f), {.threads = 3}).texture;
    EXPECT_TRUE(std::ranges::equal(one.points, three.points));
    EXPECT_TRUE(std::ranges::equal(one.blends, three.blends));
}

TEST(BarkTexture, TheSecondSetContinuesTheStemIntoALateral) {
    MeshOptions options = with_blends(0.1f);
    options.fit = Fit::surface;
    const MeshResult made = mesh_skeleton(stem_with_branch(), options);
    const QuadMesh& mesh = made.quads().mesh;
    const Texture& texture = *made.texture;
    ASSERT_EQ(texture.blends.size(), texture.points.size());
    int at_rim = 0, partial = 0;
    for (std::size_t c = 0; c < texture.blends.size(); ++c) {
        const TextureBlend& own = texture.blends[c];
        if (own.weight == 0) continue;
        partial += own.weight < 1 ? 1 : 0;
        const Vec3 p = mesh.positions[mesh.quads[c / 4][c % 4]];
        EXPECT_LT(distance(p, Vec3{0, 0, 1}), 0.35f);  // two radii of 0.04 beyond the rim of a collar
        if (own.weight < 1) continue;
        ++at_rim;
        bool is_continued = false;
        for (std::size_t other = 0; other < texture.points.size(); ++other) {
            if (mesh.quads[other / 4][other % 4] != mesh.quads[c / 4][c % 4]) continue;
            if (texture.blends[other].weight > 0) continue;
            const float du = texture.points[other].u - own.second.u;
            is_continued |= std::abs(du - std::round(du)) < 1e-3f &&
                            std::abs(texture.points[other].v - own.second.v) < 1e-3f;
        }
        EXPECT_TRUE(is_continued) << c;
    }
    EXPECT_EQ(at_rim, 2 * 4 * 4);   // both ends of the edges of the rim
    EXPECT_GE(partial, 4 * 4 * 4);  // a row of quads
    for (std::size_t f = 0; f < mesh.quads.size(); ++f) {
        if (texture.blends[4 * f].weight == 0) continue;
        const auto at = [&](std::size_t k) { return texture.blends[4 * f + k].second; };
        const TexturePoint a = at(0), b = at(1), c = at(2), d = at(3);
        EXPECT_GT((c.u - a.u) * (d.v - b.v) - (d.u - b.u) * (c.v - a.v), 0);  // not turned over
    }
}

TEST(BarkTexture, TheSecondSetContinuesTheNumberOfWraps) {
    const Skeleton tapered({NodeId::none(), NodeId(0), NodeId(1), NodeId(2), NodeId(3)},
                           {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {0, 0, 4}},
                           {0.3f, 0.3f, 0.1f, 0.1f, 0.1f});
    const MeshResult made = mesh_skeleton(tapered, with_blends(0.2f));
    const QuadMesh& mesh = made.quads().mesh;
    const Texture& texture = *made.texture;
    std::map<std::uint32_t, std::pair<bool, bool>>
        rings;  // vertices with weight 1: whether they are continued
    for (std::size_t c = 0; c < texture.blends.size(); ++c) {
        if (texture.blends[c].weight < 1) continue;
        auto& [is_ring, is_continued] = rings[mesh.quads[c / 4][c % 4]];
        is_ring = true;
        for (std::size_t other = 0; other < texture.points.size(); ++other) {
            if (mesh.quads[other / 4][other % 4] != mesh.quads[c / 4][c % 4]) continue;
            if (texture.blends[other].weight == 1) continue;
            const float du = texture.points[other].u - texture.blends[c].second.u;
            is_continued |= std::abs(du - std::round(du)) < 1e-3f &&
                            std::abs(texture.points[other].v - texture.blends[c].second.v) < 1e-3f;
        }
    }
    ASSERT_GT(rings.size(), 0u);
    EXPECT_EQ(rings.size() % 16, 0u);  // whole rings of 16 vertices
    for (const auto& [vertex, ring] : rings) EXPECT_TRUE(ring.second) << vertex;
}

TEST(BarkTexture, TheSecondSetLeavesTheFirstUnchanged) {
    const Skeleton tree = random_tree(300, 7);
    for (const TubeSides sides : {TubeSides::equal, TubeSides::by_radius}) {
        MeshOptions options = with_bark(0.2f);
        options.tube_sides = sides;
        const Texture plain = *mesh_skeleton(tree, options).texture;
        options.texture.blend = true;
        const Texture blended = *mesh_skeleton(tree, options).texture;
        EXPECT_TRUE(plain.blends.empty());
        EXPECT_TRUE(std::ranges::equal(plain.points, blended.points));
        ASSERT_EQ(blended.blends.size(), blended.points.size());
        EXPECT_TRUE(std::ranges::any_of(blended.blends, [](const auto& b) { return b.weight > 0; }));
        options.texture.tile_height = 0.1f;  // half as high
        const Texture low = *mesh_skeleton(tree, options).texture;
        for (std::size_t c = 0; c < low.blends.size(); ++c)
            ASSERT_EQ(low.blends[c].second.v, 2 * blended.blends[c].second.v);
    }
}

TEST(BarkTexture, TheSecondSetIsFiniteOnAnySkeleton) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        for (const MeshMethod method :
             {MeshMethod::quads, MeshMethod::tetrahedra, MeshMethod::ramifications, MeshMethod::cylinders}) {
            MeshOptions options = with_blends(0.3f);
            options.method = method;
            const Texture texture = *mesh_skeleton(skeleton, options).texture;
            EXPECT_EQ(texture.blends.size(), method == MeshMethod::cylinders ? 0 : texture.points.size())
                << name;
            for (const TextureBlend& b : texture.blends) {
                ASSERT_TRUE(std::isfinite(b.second.u) && std::isfinite(b.second.v));
                ASSERT_TRUE(b.weight >= 0 && b.weight <= 1);
            }
        }
    }
}

}  // namespace
}  // namespace coppice
