#include "coppice/growth/sprout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/growth/shade_grid_internal.h"
#include "described_options.h"
#include "errors.h"
#include "growth/fields.h"

namespace coppice {
namespace {

using test::error_of;

constexpr double kDegree = std::numbers::pi / 180;

SproutResult grown(const SproutOptions& options, std::vector<Root> roots = {Root{}},
                   const Context& ctx = {}) {
    return sprout({.roots = roots}, options, ctx);
}

/// Trees in the open: without shade, random numbers and bending.
SproutOptions plain() {
    return {.seasons = 8,
            .branching_spread = 0,
            .stem_tropism = 0,
            .branch_tropism = 0,
            .light_turn = 0,
            .wobble = 0,
            .shade = 0};
}

Vec3d direction(const Skeleton& s, NodeId n) {
    return normalized(Vec3d(s.position(n)) - Vec3d(s.position(s.parent(n))));
}

/// Returns the first segments of laterals: those shorter than their parent segments. Requires internode_decay
/// < 1 and straight shoots.
std::vector<NodeId> laterals(const Skeleton& s) {
    std::vector<NodeId> out;
    const auto length = [&](NodeId n) { return distance(s.position(n), s.position(s.parent(n))); };
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n) || s.is_root(s.parent(n))) continue;
        if (length(n) < 0.99f * length(s.parent(n))) out.push_back(n);
    }
    return out;
}

double compute_angle(const Skeleton& s, NodeId n) {
    return std::acos(std::clamp(dot(direction(s, n), direction(s, s.parent(n))), -1.0, 1.0));
}

TEST(Sprout, DescribesEveryOption) {
    test::expect_described<SproutOptions>(3);  // bytes of padding after the bool
}

TEST(Sprout, LateralsHaveTheBranchingAngle) {
    for (const double degrees : {25.0, 60.0, 90.0}) {
        SproutOptions o = plain();
        o.branching_angle = static_cast<float>(degrees * kDegree);
        const Skeleton exact = grown(o).skeleton;
        const std::vector<NodeId> all = laterals(exact);
        ASSERT_GT(all.size(), 50u);
        for (const NodeId n : all) EXPECT_NEAR(compute_angle(exact, n), degrees * kDegree, 1e-3);
    }
    SproutOptions o = plain();
    o.seasons = 10;
    o.branching_spread = static_cast<float>(8 * kDegree);
    o.branching_angle = static_cast<float>(50 * kDegree);
    const Skeleton s = grown(o).skeleton;
    double sum = 0, squares = 0, count = 0;
    for (const NodeId n : laterals(s)) {
        const double a = compute_angle(s, n) / kDegree;
        sum += a;
        squares += a * a;
        ++count;
    }
    ASSERT_GT(count, 300);
    const double mean = sum / count, deviation = std::sqrt(squares / count - mean * mean);
    // Standard errors: 8 / sqrt(300) = 0.46 of the mean, 0.33 of the deviation; tolerance of four.
    EXPECT_NEAR(mean, 50, 1.9);
    EXPECT_NEAR(deviation, 8, 1.4);
}

TEST(Sprout, LateralsFollowThePhyllotaxisAngle) {
    SproutOptions o = plain();
    o.apical_dominance = 0;
    o.shed_light = 0;
    o.phyllotaxis = static_cast<float>(100 * kDegree);
    const Skeleton s = grown(o).skeleton;
    std::vector<double> azimuth;
    for (const NodeId n : laterals(s)) {
        const NodeId p = s.parent(n);
        const Vec3 on = s.position(p);
        if (std::hypot(on.x, on.y) > 1e-4f) continue;  // not on the stem
        const Vec3d d = direction(s, n);
        azimuth.push_back(std::atan2(d.y, d.x) - 100 * kDegree * std::round(double{on.z} / 0.12));
    }
    ASSERT_GT(azimuth.size(), 5u);
    for (const double a : azimuth) EXPECT_NEAR(std::remainder(a - azimuth[0], 2 * std::numbers::pi), 0, 1e-2);
}

TEST(Sprout, WhorlsHaveTheGivenNumberOfBuds) {
    SproutOptions o = plain();
    o.seasons = 4;
    o.buds = 3;
    o.whorls = true;
    o.apical_dominance = 0;
    o.vigour = 12;
    const Skeleton s = grown(o).skeleton;
    for (const NodeId n : nodes(s)) {
        const std::size_t count = s.children(n).size();
        EXPECT_TRUE(count <= 2 || count == 4) << count;  // a whorl of three, and the axis continues
    }
    EXPECT_GT(laterals(s).size(), 6u);
}

/// Returns the height of the stem, which is straight here, relative to the height of the tree.
double stem_share(const Skeleton& s) {
    double stem = 0;
    for (const NodeId n : nodes(s)) {
        if (std::hypot(s.position(n).x, s.position(n).y) < 1e-3f)
            stem = std::max(stem, double{s.position(n).z});
    }
    return stem / double{s.bounds().high.z};
}

TEST(Sprout, ApicalControlDeterminesTheShareOfTheStem) {
    SproutOptions o = plain();
    o.shade = 0.03f;
    o.seasons = 12;
    o.apical_control = 0.6f;
    const Skeleton excurrent = grown(o).skeleton;
    o.apical_control = 0.42f;
    const Skeleton decurrent = grown(o).skeleton;
    EXPECT_GT(stem_share(excurrent), 0.99);
    EXPECT_LT(stem_share(decurrent), 0.8);
    EXPECT_GT(excurrent.bounds().high.z, 1.3f * decurrent.bounds().high.z);
}

TEST(Sprout, BudsNearGrowingTipsRemainDormant) {
    SproutOptions o = plain();
    o.apical_dominance = 5;
    const Skeleton s = grown(o).skeleton;
    // No tip of an axis has one of its laterals within four nodes: it would have sprouted beyond five, and
    // the axis has grown since.
    for (const NodeId n : laterals(s)) {
        NodeId on = s.parent(n);
        int beyond = 0;
        while (!s.is_tip(on)) {
            NodeId next;
            for (const NodeId c : s.children(on)) {
                if (dot(direction(s, c), direction(s, on)) > 0.99) next = c;
            }
            if (!next) break;
            on = next;
            ++beyond;
        }
        EXPECT_GE(beyond, 5);
    }
}

TEST(Sprout, AdjacentTreesLeanAwayFromEachOther) {
    SproutOptions o;
    o.seasons = 14;
    const auto lean = [](const Skeleton& s, NodeId root) {
        double sum = 0, count = 0;
        std::vector<char> is_in(s.size(), 0);
        for (const NodeId n : nodes(s)) {
            is_in[n.index()] = static_cast<char>(s.is_root(n) ? n == root : is_in[s.parent(n).index()] != 0);
            if (is_in[n.index()] == 0 || !s.is_tip(n)) continue;
            sum += double{s.position(n).x - s.position(root).x};
            ++count;
        }
        return sum / count;
    };
    double alone = 0, left = 0, right = 0;
    for (int seed = 0; seed < 5; ++seed) {
        o.seed = seed;
        alone += lean(grown(o).skeleton, NodeId(0)) / 5;
        const Skeleton pair = grown(o, {{{0, 0, 0}, {}}, {{1.2f, 0, 0}, {}}}).skeleton;
        ASSERT_EQ(pair.tree_count(), 2u);
        left += lean(pair, NodeId(0)) / 5;
        right += lean(pair, NodeId(1)) / 5;
    }
    EXPECT_LT(std::abs(alone), 0.15);
    EXPECT_LT(left, -0.25);
    EXPECT_GT(right, 0.25);
}

/// Returns the shade at the tips of a tree, by a grid of the same settings: the mean over the darkest tenth.
double darkest_tenth(const Skeleton& s, const SproutOptions& o) {
    ShadeGrid grid({2 * o.internode, o.shade, o.shade_falloff, o.shade_depth});
    for (const NodeId n : nodes(s)) grid.add(s.position(n));
    std::vector<double> shade;
    for (const NodeId n : nodes(s)) {
        if (s.is_tip(n)) shade.push_back(grid.shade(s.position(n)));
    }
    std::ranges::sort(shade, std::greater<>());
    const std::size_t tenth = std::max<std::size_t>(shade.size() / 10, 1);
    double sum = 0;
    for (std::size_t i = 0; i < tenth; ++i) sum += shade[i];
    return sum / static_cast<double>(tenth);
}

TEST(Sprout, ShedsShadedBranches) {
    SproutOptions o;
    o.seasons = 14;
    o.shed_light = 0.5f;
    const SproutResult strict = grown(o);
    o.shed_light = 0.02f;
    const SproutResult lax = grown(o);
    EXPECT_GT(strict.shed, 0u);
    EXPECT_LT(darkest_tenth(strict.skeleton, o), darkest_tenth(lax.skeleton, o));
    // In the open there is no shade.
    o.shade = 0;
    o.seasons = 8;
    o.leaf_seasons = 1000;
    EXPECT_EQ(grown(o).shed, 0u);
}

TEST(Sprout, ShadeReducesGrowth) {
    SproutOptions o;
    o.seasons = 12;
    std::uint32_t last = 0xffffffffu;
    for (const float shade : {0.0f, 0.03f, 0.1f}) {
        o.shade = shade;
        const std::uint32_t size = grown(o).skeleton.size();
        EXPECT_LT(size, last);
        last = size;
    }
}

TEST(Sprout, TropismsBendStemsAndBranches) {
    SproutOptions o = plain();
    o.stem_tropism = 0.5f;
    const auto leaning = grown(o, {{{0, 0, 0}, {1, 0, 0.2f}}});
    const Skeleton& s = leaning.skeleton;
    NodeId top(0);
    while (!s.is_tip(top)) top = s.children(top)[0];
    EXPECT_GT(direction(s, top).z, 0.95);
    o.branch_tropism = -0.3f;
    o.seasons = 10;
    const Skeleton hanging = grown(o).skeleton;
    int down = 0, tips = 0;
    for (const NodeId n : nodes(hanging)) {
        if (!hanging.is_tip(n) || std::hypot(hanging.position(n).x, hanging.position(n).y) < 0.3f) continue;
        ++tips;
        down += direction(hanging, n).z < 0;
    }
    ASSERT_GT(tips, 20);
    EXPECT_GT(down, 0.6 * tips);
}

TEST(Sprout, RemainsInsideItsGuard) {
    const SphereField ball{{0, 0, 2}, 1};
    const Guard within(FieldRef(ball), {.side = GuardSide::inside});
    SproutOptions o;
    o.seasons = 16;
    const std::vector<Root> roots{{{0, 0, 1.1f}, {}}};
    const SproutResult r = sprout({.roots = roots, .guard = &within}, o);
    EXPECT_GT(r.skeleton.size(), 50u);
    for (const Vec3 p : r.skeleton.positions()) EXPECT_LT(distance(p, Vec3{0, 0, 2}), 1.0f);
    const std::vector<Root> outside{{{0, 0, 0.5f}, {}}};
    EXPECT_NE(error_of([&] { sprout({.roots = outside, .guard = &within}, o); }).find("guard excludes"),
              std::string::npos);
}

TEST(Sprout, StopsAtItsLimitsAndWhenCancelled) {
    SproutOptions o;
    o.max_nodes = 200;
    const SproutResult full = grown(o);
    EXPECT_TRUE(full.full);
    EXPECT_LE(full.skeleton.size(), 200u);
    o.seasons = 0;
    EXPECT_EQ(grown(o).skeleton.size(), 1u);
    std::stop_source source;
    source.request_stop();
    Context stopped;
    stopped.stop = source.get_token();
    EXPECT_THROW(grown({}, {Root{}}, stopped), Cancelled);
    const std::vector<Root> roots{Root{}};
    EXPECT_NE(error_of([&] { sprout({.roots = roots, .max_bytes = 10'000}, {}); }).find("memory"),
              std::string::npos);
    EXPECT_NE(error_of([&] { sprout({}, {}); }).find("no root"), std::string::npos);
    EXPECT_NE(error_of([&] { grown({.buds = 17}); }).find("buds"), std::string::npos);
    EXPECT_NE(error_of([&] { grown({.tropism_z = 0}); }).find("tropism"), std::string::npos);
}

TEST(Sprout, IsBitIdenticalForAnyNumberOfThreadsAndDependsOnTheSeed) {
    SproutOptions o;
    o.seasons = 12;
    const Skeleton one = grown(o, {Root{}}, {.threads = 1}).skeleton;
    const Skeleton many = grown(o, {Root{}}, {.threads = 7}).skeleton;
    ASSERT_EQ(one.size(), many.size());
    EXPECT_TRUE(std::ranges::equal(one.positions(), many.positions()));
    o.seed = 1;
    EXPECT_FALSE(std::ranges::equal(one.positions(), grown(o).skeleton.positions()));
}

TEST(ShadeGrid, RemoveRevertsAdd) {
    ShadeGrid grid({0.5f, 0.3f, 0.7f, 4});
    grid.add({0.1f, 0.1f, 10});
    EXPECT_NEAR(grid.shade({0.1f, 0.1f, 10}), 0.3, 1e-4);
    EXPECT_NEAR(grid.shade({0.6f, -0.4f, 9.6f}), 0.21, 1e-4);  // one layer below, a cell to the side
    EXPECT_EQ(grid.shade({1.1f, 0.1f, 9.6f}), 0);              // two cells to the side
    EXPECT_EQ(grid.shade({0.1f, 0.1f, 10.6f}), 0);             // above
    EXPECT_GT(grid.brighter({0.6f, 0.1f, 9.6f}).x, 0);
    EXPECT_EQ(grid.brighter({0.1f, 0.1f, 9.6f}), (Vec3d{0, 0, -1}));  // brightest directly above it and below
    grid.add({-3, 2, 9});
    grid.remove({0.1f, 0.1f, 10});
    grid.remove({-3, 2, 9});
    for (float z = 7; z < 11; z += 0.25f) EXPECT_EQ(grid.shade({0.1f, 0.1f, z}), 0);
}

TEST(Sprout, WatchReportsTheGrowthAndDoesNotAffectIt) {
    const std::vector<Root> roots{Root{}};
    const SproutOptions options{.seasons = 6};
    std::vector<std::uint32_t> nodes;
    const GrowthWatch watch = [&](const GrowthSoFar& so_far) {
        EXPECT_EQ(so_far.limit, "seasons");
        EXPECT_EQ(so_far.rounds, static_cast<int>(nodes.size()) + 1);
        nodes.push_back(so_far.skeleton().size());
        EXPECT_EQ(nodes.back(), so_far.nodes);
    };
    const SproutResult watched = sprout({.roots = roots, .watch = watch}, options);
    const SproutResult plainly = grown(options);
    EXPECT_TRUE(std::ranges::equal(watched.skeleton.positions(), plainly.skeleton.positions()));
    ASSERT_EQ(nodes.size(), 6u);
    EXPECT_GT(nodes.back(), nodes.front());
}

}  // namespace
}  // namespace coppice
