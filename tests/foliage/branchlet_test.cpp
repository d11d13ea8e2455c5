#include "coppice/foliage/branchlet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>

#include "coppice/base/error.h"
#include "described_options.h"
#include "foliage/mesh_volume.h"

namespace coppice {
namespace {

std::vector<Branchlet> make(const BranchletOptions& options, const LeafRules& rules = {}, int count = 3) {
    const std::vector<LeafModel> models = make_leaves({}, 2);
    return make_branchlets(options, models, rules, count);
}

/// Returns whether every edge belongs to two triangles, in opposite directions.
bool is_closed(const TriMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    }
    return std::ranges::all_of(edges, [&](const auto& edge) {
        const auto back = edges.find({edge.first.second, edge.first.first});
        return edge.second == 1 && back != edges.end() && back->second == 1;
    });
}

TEST(Branchlet, twigs_are_closed_and_turned_outwards) {
    for (const Branchlet& b : make({.length = 0.5f, .laterals = 7})) {
        EXPECT_TRUE(is_closed(b.twig.prototype.mesh));
        EXPECT_GT(compute_volume(b.twig.prototype.mesh), 0);
        EXPECT_EQ(b.twig.prototype.texture.size(), 3 * b.twig.prototype.mesh.triangles.size());
    }
}

TEST(Branchlet, extends_along_y_by_its_length) {
    for (const Branchlet& b : make({.length = 0.5f, .laterals = 0, .sag = 0})) {
        float end = 0;
        for (const Vec3 p : b.twig.prototype.mesh.positions) end = std::max(end, p.y);
        // The axis turns sideways by at most 0.3 rad, at its tip.
        EXPECT_LE(end, 0.5f + 1e-5f);
        EXPECT_GE(end, 0.5f * 0.95f);
    }
}

TEST(Branchlet, leaves_have_the_area_of_their_blades) {
    const double leaf = make_leaves({}, 1).front().area;
    LeafRules rules{.internode = 0.02f, .size_spread = 0, .base_size = 1};
    const Branchlet b = make({.length = 0.4f, .laterals = 0}, rules, 1).front();
    // A leaf at the tip and at every 2 cm of 40 cm.
    EXPECT_NEAR(static_cast<double>(b.upper_sides.size()), 21, 1);
    EXPECT_NEAR(b.twig.area, leaf * static_cast<double>(b.upper_sides.size()), 0.02 * b.twig.area);
    EXPECT_EQ(b.leaves.texture.size(), 3 * b.leaves.mesh.triangles.size());
}

TEST(Branchlet, laterals_of_two_ranked_leaves_are_level) {
    const LeafRules rules{.arrangement = LeafArrangement::two_ranked};
    const auto height = [&](float flatness) {
        const Branchlet b =
            make({.length = 0.5f, .laterals = 8, .flatness = flatness, .sag = 0}, rules, 1).front();
        float high = 0;
        for (const Vec3 p : b.twig.prototype.mesh.positions) high = std::max(high, std::abs(p.z));
        return high;
    };
    EXPECT_LT(height(1), 0.005f);
    EXPECT_GT(height(0), height(1));
}

TEST(Branchlet, is_bare_in_winter) {
    const Branchlet b = make({.length = 0.3f}, {.season = Season::winter}, 1).front();
    EXPECT_TRUE(b.upper_sides.empty());
    EXPECT_TRUE(b.leaves.mesh.triangles.empty());
    EXPECT_FALSE(b.twig.prototype.mesh.triangles.empty());
}

TEST(Branchlet, refuses_options_out_of_range) {
    EXPECT_THROW(make({.length = 0}), InvalidInput);
    EXPECT_THROW(make({.length = 1, .radius = 0}), InvalidInput);
    EXPECT_THROW(make({.length = 1, .laterals = -1}), InvalidInput);
}

TEST(Branchlet, describes_every_option) { test::expect_described<BranchletOptions>(); }

}  // namespace
}  // namespace coppice
