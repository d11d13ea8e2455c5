#include "coppice/growth/grow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "coppice/base/error.h"
#include "coppice/base/hash.h"
#include "coppice/base/random.h"
#include "described_options.h"
#include "errors.h"
#include "growth/fields.h"

namespace coppice {
namespace {

const std::vector<Root> kOrigin{{{0, 0, 0}, {}}};

std::vector<Vec3> ball(std::size_t count, Vec3 center, double radius, std::uint64_t seed = 1) {
    const CounterRandom random(seed, 0);
    std::vector<Vec3> points;
    for (std::uint64_t i = 0; points.size() < count; ++i) {
        const auto draw = [&](std::uint64_t k) { return random.uniform(3 * i + k, -1, 1); };
        const Vec3d p{draw(0), draw(1), draw(2)};
        if (length(p) <= 1) points.push_back(center + Vec3(p * radius));
    }
    return points;
}

GrowResult grow_at_origin(const std::vector<Vec3>& attractors, const GrowOptions& options = {}) {
    return grow({.attractors = attractors, .roots = kOrigin}, options);
}

std::uint64_t compute_hash(const GrowResult& r) {
    const Skeleton& s = r.skeleton;
    Hash hash;
    hash.add(s.parents()).add(s.positions()).add(std::span(r.unreached));
    return hash.add(r.iterations).add(r.stalls).add(r.dropped).value();
}

TEST(Grow, GrowsStraightToASingleAttractor) {
    // From a distance of 1 in steps of 1/4: spent when the third node is 1/4 away.
    const GrowResult r =
        grow_at_origin({{0, 0, 1}}, {.influence_radius = 2, .kill_radius = 0.25f, .step = 0.25f});
    ASSERT_EQ(r.skeleton.size(), 4u);
    for (std::uint32_t i = 0; i < 4; ++i) {
        EXPECT_EQ(r.skeleton.position(NodeId(i)), Vec3(0, 0, 0.25f * static_cast<float>(i)));
    }
    EXPECT_EQ(r.stop, StopReason::attractors_spent);
    EXPECT_EQ(r.iterations, 3);
    EXPECT_TRUE(r.unreached.empty());
}

TEST(Grow, FollowsTheMeanDirectionAndForks) {
    const GrowOptions options{.influence_radius = 3, .kill_radius = 0.1f, .step = 0.1f};
    const GrowResult r = grow_at_origin({{1, 0, 1}, {-1, 0, 1}}, options);
    EXPECT_EQ(r.stop, StopReason::attractors_spent);
    EXPECT_LT(distance(r.skeleton.position(NodeId(1)), Vec3(0, 0, 0.1f)), 1e-6f);
    std::uint32_t forks = 0;
    for (const NodeId n : nodes(r.skeleton)) forks += r.skeleton.children(n).size() == 2;
    EXPECT_EQ(forks, 1u);
}

TEST(Grow, OppositeAttractorsDoNotStopGrowth) {
    // The pulls cancel. Three steps of 1/4 to both sides bring a node within 1/4.
    const GrowResult r =
        grow_at_origin({{1, 0, 0}, {-1, 0, 0}}, {.influence_radius = 2, .kill_radius = 0.25f, .step = 0.25f});
    EXPECT_EQ(r.stop, StopReason::attractors_spent);
    EXPECT_EQ(r.skeleton.size(), 7u);
    EXPECT_EQ(r.stalls, 1u);
    for (const NodeId n : nodes(r.skeleton)) EXPECT_EQ(r.skeleton.position(n).z, 0);
}

TEST(Grow, DoesNotRepeatTheSameChild) {
    // The sum points straight up, where a child is nearer to neither: it would be created forever.
    const GrowResult r = grow_at_origin({{1, 0, 0.01f}, {-1, 0, 0.01f}},
                                        {.influence_radius = 2, .kill_radius = 0.25f, .step = 0.25f});
    EXPECT_EQ(r.stop, StopReason::attractors_spent);
    // 1.00005 away: after three steps slightly more than 1/4 remains, so that four are required on both
    // sides.
    EXPECT_EQ(r.skeleton.size(), 9u);
    EXPECT_GE(r.stalls, 1u);
    for (const NodeId n : nodes(r.skeleton)) EXPECT_LT(r.skeleton.position(n).z, 0.02f);
}

TEST(Grow, TerminatesOnARingOfAttractors) {
    std::vector<Vec3> ring;
    for (int i = 0; i < 100; ++i) {
        const double a = 2 * 3.14159265358979 * i / 100;
        ring.emplace_back(static_cast<float>(std::cos(a)), static_cast<float>(std::sin(a)), 0.0f);
    }
    const GrowResult r = grow_at_origin(ring, {.influence_radius = 2, .kill_radius = 0.1f, .step = 0.05f});
    EXPECT_EQ(r.stop, StopReason::attractors_spent);
    EXPECT_LT(r.skeleton.size(), 3000u);
}

TEST(Grow, RootsCompeteForAttractors) {
    std::vector<Vec3> attractors = ball(300, {2, 0, 1}, 1);
    const std::vector<Vec3> left = ball(300, {-2, 0, 1}, 1, 2);
    attractors.insert(attractors.end(), left.begin(), left.end());
    const std::vector<Root> roots{{{2, 0, 0}, {}}, {{-2, 0, 0}, {}}};
    const GrowResult r = grow({.attractors = attractors, .roots = roots},
                              {.influence_radius = 1, .kill_radius = 0.2f, .step = 0.1f});
    EXPECT_EQ(r.stop, StopReason::attractors_spent);
    EXPECT_EQ(r.skeleton.tree_count(), 2u);
    std::vector<std::uint32_t> tree(r.skeleton.size());
    std::array<std::uint32_t, 2> size{};
    for (const NodeId n : nodes(r.skeleton)) {
        const bool root = r.skeleton.is_root(n);
        tree[n.index()] = root ? n.index() : tree[r.skeleton.parent(n).index()];
        ++size[tree[n.index()]];
        EXPECT_EQ(r.skeleton.position(n).x > 0, tree[n.index()] == 0);
    }
    EXPECT_GT(size[0], 50u);
    EXPECT_GT(size[1], 50u);
}

TEST(Grow, FirstOfEqualRootsReceivesTheAttractor) {
    const std::vector<Root> roots{{{0, 0, 0}, {}}, {{0, 0, 0}, {}}};
    const std::vector<Vec3> attractors{{0, 0, 1}};
    const GrowResult r = grow({.attractors = attractors, .roots = roots});
    EXPECT_EQ(r.skeleton.tree_count(), 2u);
    EXPECT_TRUE(r.skeleton.is_tip(NodeId(1)));
    EXPECT_FALSE(r.skeleton.is_tip(NodeId(0)));
}

TEST(Grow, TropismBendsTheDirection) {
    // East with the same weight upwards: halfway between.
    const GrowResult r = grow_at_origin({{0.9f, 0, 0}}, {.step = 0.1f, .tropism_weight = 1});
    const float h = 0.1f * std::sqrt(0.5f);
    EXPECT_LT(distance(r.skeleton.position(NodeId(1)), Vec3(h, 0, h)), 1e-6f);
    EXPECT_EQ(r.stop, StopReason::attractors_spent);
}

TEST(Grow, TerminatesWithStrongOpposingTropism) {
    const GrowResult r = grow_at_origin(ball(500, {0, 0, 1}, 0.8), {.tropism_z = -1, .tropism_weight = 10});
    EXPECT_EQ(r.stop, StopReason::attractors_spent);
    EXPECT_LT(r.skeleton.size(), 5000u);
}

TEST(Grow, AttractorsAreSpentExactlyWithinTheKillRadius) {
    const std::vector<Vec3> attractors = ball(800, {0, 0, 1}, 1);
    GrowOptions options{.influence_radius = 0.5f, .kill_radius = 0.11f, .step = 0.06f};
    options.max_iterations = 12;
    const GrowResult r = grow_at_origin(attractors, options);
    EXPECT_EQ(r.stop, StopReason::iteration_limit);
    ASSERT_GT(r.unreached.size(), 10u);
    ASSERT_LT(r.unreached.size(), 790u);
    for (std::uint32_t a = 0; a < attractors.size(); ++a) {
        float nearest = 1e9f;
        for (const Vec3 p : r.skeleton.positions()) nearest = std::min(nearest, distance(p, attractors[a]));
        const bool left = std::ranges::binary_search(r.unreached, a);
        EXPECT_EQ(left, nearest > options.kill_radius) << a;
    }
}

TEST(Grow, StepsAndSpacingMatchTheOptions) {
    const GrowOptions options{
        .influence_radius = 0.5f, .kill_radius = 0.11f, .step = 0.06f, .min_spacing = 0.5f};
    const GrowResult r = grow_at_origin(ball(800, {0, 0, 1}, 1), options);
    EXPECT_EQ(r.stop, StopReason::attractors_spent);
    const Skeleton& s = r.skeleton;
    for (const NodeId n : nodes(s)) {
        if (!s.is_root(n)) {
            EXPECT_NEAR(distance(s.position(n), s.position(s.parent(n))), 0.06f, 1e-6f);
        }
        for (std::uint32_t i = 0; i < n.index(); ++i) {
            ASSERT_GE(distance(s.position(n), s.position(NodeId(i))), 0.03f * 0.9999f);
        }
    }
}

TEST(Grow, TrunkStartsInItsDirectionAndReachesTheCrown) {
    const std::vector<Vec3> attractors{{3, 0, 6}};
    const GrowOptions options{.influence_radius = 0.5f, .kill_radius = 0.2f, .step = 0.1f};
    const GrowResult free = grow_at_origin(attractors, options);
    EXPECT_EQ(free.stop, StopReason::attractors_spent);
    for (const Vec3 p : free.skeleton.positions()) EXPECT_NEAR(p.z, 2 * p.x, 1e-4f);

    const std::vector<Root> upright{{{0, 0, 0}, {0, 0, 9}}};
    const GrowResult led = grow({.attractors = attractors, .roots = upright}, options);
    EXPECT_EQ(led.stop, StopReason::attractors_spent);
    // Straight up gains at least half a step until the attractor is seen at 60 degrees: z = 6 - 3 / sqrt(3).
    for (const Vec3 p : led.skeleton.positions()) {
        if (p.z < 4.2f) {
            EXPECT_NEAR(p.x, 0, 1e-5f);
        }
        if (p.z > 4.6f) {
            EXPECT_GT(p.x, 0.1f);
        }
    }
}

TEST(Grow, WithoutATrunkFarAttractorsRemainUnreached) {
    const GrowResult r = grow_at_origin({{0, 0, 5}, {0, 0, 7}}, {.trunk = false});
    EXPECT_EQ(r.stop, StopReason::no_progress);
    EXPECT_EQ(r.skeleton.size(), 1u);
    EXPECT_EQ(r.unreached, (std::vector<std::uint32_t>{0, 1}));
    EXPECT_EQ(r.iterations, 0);
}

TEST(Grow, WithoutAttractorsReturnsTheRoots) {
    const GrowResult r = grow_at_origin({});
    EXPECT_EQ(r.stop, StopReason::attractors_spent);
    EXPECT_EQ(r.skeleton.size(), 1u);
    EXPECT_FLOAT_EQ(r.skeleton.radius(NodeId(0)), 0.01f);
}

TEST(Grow, StopsAtItsLimits) {
    const std::vector<Vec3> attractors = ball(500, {0, 0, 1}, 1);
    const GrowResult few = grow_at_origin(attractors, {.max_nodes = 40});
    EXPECT_EQ(few.stop, StopReason::node_limit);
    EXPECT_LE(few.skeleton.size(), 40u);
    EXPECT_GT(few.skeleton.size(), 20u);
    EXPECT_FALSE(few.unreached.empty());
    const GrowResult one = grow_at_origin(attractors, {.max_nodes = 1});
    EXPECT_EQ(one.stop, StopReason::node_limit);
    EXPECT_EQ(one.skeleton.size(), 1u);
    const GrowResult none = grow_at_origin(attractors, {.max_iterations = 0});
    EXPECT_EQ(none.stop, StopReason::iteration_limit);
    EXPECT_EQ(none.iterations, 0);
    const GrowResult trunk = grow_at_origin({{0, 0, 1000}}, {.max_nodes = 100});
    EXPECT_EQ(trunk.stop, StopReason::node_limit);
    EXPECT_EQ(trunk.skeleton.size(), 100u);
}

TEST(Grow, TurnsAreLimitedToTheMaximumAngle) {
    const GrowOptions options{.influence_radius = 0.6f, .kill_radius = 0.1f, .step = 0.05f, .max_turn = 0.5f};
    const GrowResult r = grow_at_origin(ball(600, {0, 0, 1}, 1), options);
    const Skeleton& s = r.skeleton;
    EXPECT_GT(s.size(), 200u);
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n) || s.is_root(s.parent(n))) continue;
        const Vec3d mid(s.position(s.parent(n)));
        const Vec3d in = mid - Vec3d(s.position(s.parent(s.parent(n))));
        const Vec3d out = Vec3d(s.position(n)) - mid;
        EXPECT_LT(std::acos(std::min(1.0, dot(normalized(in), normalized(out)))), 0.5 + 1e-4);
    }
}

TEST(Grow, LimitsChildrenAndTheNodesWithBuds) {
    const std::vector<Vec3> attractors = ball(600, {0, 0, 1}, 1);
    const Skeleton two = grow_at_origin(attractors, {.max_children = 2}).skeleton;
    const Skeleton any = grow_at_origin(attractors).skeleton;
    const auto most = [](const Skeleton& s) {
        std::size_t count = 0;
        for (const NodeId n : nodes(s)) count = std::max(count, s.children(n).size());
        return count;
    };
    EXPECT_GT(most(any), 2u);
    EXPECT_EQ(most(two), 2u);

    const Skeleton third = grow_at_origin(attractors, {.bud_interval = 3}).skeleton;
    std::vector<int> rank(third.size());
    int forks = 0;
    for (const NodeId n : nodes(third)) {
        if (third.is_root(n)) continue;
        const NodeId p = third.parent(n);
        rank[n.index()] = third.children(p).front() == n ? rank[p.index()] + 1 : 1;
    }
    for (const NodeId n : nodes(third)) {
        if (third.children(n).size() < 2) continue;
        ++forks;
        EXPECT_EQ(rank[n.index()] % 3, 0);
    }
    EXPECT_GT(forks, 3);
}

TEST(Grow, JitterDependsOnTheSeed) {
    const std::vector<Vec3> attractors = ball(300, {0, 0, 1}, 1);
    const auto with = [&](float jitter, int seed) {
        return compute_hash(grow_at_origin(attractors, {.jitter = jitter, .seed = seed}));
    };
    EXPECT_EQ(with(0.3f, 1), with(0.3f, 1));
    EXPECT_NE(with(0.3f, 1), with(0.3f, 2));
    EXPECT_EQ(with(0, 1), with(0, 2));
}

TEST(Grow, IsBitIdenticalForAnyNumberOfThreads) {
    const std::vector<Vec3> attractors = ball(5000, {0, 0, 1.2f}, 1);
    const SphereField solid{{0.2f, 0, 1.3f}, 0.3f};
    const Guard guard{FieldRef(solid)};
    const std::vector<Root> roots{{{0, 0, 0}, {}}, {{0.4f, 0.1f, 0}, {0, 0, 1}}};
    const GrowOptions options{.influence_radius = 0.3f,
                              .kill_radius = 0.05f,
                              .step = 0.025f,
                              .tropism_weight = 0.2f,
                              .jitter = 0.1f,
                              .max_turn = 1.2f,
                              .max_children = 3};
    std::uint64_t first = 0;
    for (const unsigned threads : {1u, 2u, 7u}) {
        for (int repeat = 0; repeat < 2; ++repeat) {
            const GrowResult r = grow({.attractors = attractors, .roots = roots, .guard = &guard}, options,
                                      {.threads = threads});
            EXPECT_GT(r.skeleton.size(), 3000u);
            if (first == 0) first = compute_hash(r);
            EXPECT_EQ(compute_hash(r), first) << threads;
        }
    }
}

TEST(Grow, MillionCoincidentAttractorsActAsOne) {
    const std::vector<Vec3> attractors(1'000'000, Vec3{0, 0, 0.5f});
    const GrowResult r = grow_at_origin(attractors, {.kill_radius = 0.1f, .step = 0.1f});
    EXPECT_EQ(r.stop, StopReason::attractors_spent);
    EXPECT_LE(r.skeleton.size(), 6u);
}

TEST(Grow, AttractorsAtTheRootsAreSpentAtOnce) {
    const GrowResult r = grow_at_origin({{0, 0, 0}, {0, 0, 0}, {0, 0, 0.1f}});
    EXPECT_EQ(r.stop, StopReason::attractors_spent);
    EXPECT_EQ(r.skeleton.size(), 1u);
}

TEST(Grow, PreservesTheOrigin) {
    const GrowResult r = grow({.roots = kOrigin, .origin = {5e6, 4e5, 100}});
    EXPECT_EQ(r.skeleton.origin(), Vec3d(5e6, 4e5, 100));
}

TEST(Grow, CanBeCancelled) {
    std::stop_source source;
    source.request_stop();
    const std::vector<Vec3> attractors = ball(100, {0, 0, 1}, 1);
    EXPECT_THROW(grow({.attractors = attractors, .roots = kOrigin}, {}, {.stop = source.get_token()}),
                 Cancelled);
}

TEST(Grow, ReportsIncreasingProgress) {
    const std::vector<Vec3> attractors = ball(300, {0, 0, 1}, 1);
    float last = 0;
    int calls = 0;
    Context ctx;
    ctx.progress = [&](float f) {
        EXPECT_GE(f, last);
        EXPECT_LE(f, 1);
        last = f;
        ++calls;
    };
    grow({.attractors = attractors, .roots = kOrigin}, {}, ctx);
    EXPECT_GT(calls, 3);
    EXPECT_EQ(last, 1);
}

TEST(Grow, WatchReportsTheGrowthAndDoesNotAffectIt) {
    const std::vector<Vec3> attractors = ball(500, {0, 0, 3}, 2);
    const GrowOptions options{.influence_radius = 1, .kill_radius = 0.3f, .step = 0.1f};
    std::vector<int> rounds;
    std::optional<Skeleton> middle;
    const GrowthWatch watch = [&](const GrowthSoFar& so_far) {
        rounds.push_back(so_far.rounds);
        EXPECT_EQ(so_far.limit, "max_iterations");
        if (so_far.rounds == 20) middle = so_far.skeleton();
    };
    const GrowResult watched = grow({.attractors = attractors, .roots = kOrigin, .watch = watch}, options);
    EXPECT_EQ(compute_hash(watched), compute_hash(grow_at_origin(attractors, options)));
    ASSERT_EQ(rounds.size(), static_cast<std::size_t>(watched.iterations));
    for (std::size_t i = 0; i < rounds.size(); ++i) EXPECT_EQ(rounds[i], static_cast<int>(i) + 1);
    // The option that it names ends growth with the same tree.
    GrowOptions shorter = options;
    shorter.max_iterations = 20;
    const GrowResult stopped = grow_at_origin(attractors, shorter);
    ASSERT_TRUE(middle);
    EXPECT_EQ(Hash().add(middle->positions()).add(middle->parents()).value(),
              Hash().add(stopped.skeleton.positions()).add(stopped.skeleton.parents()).value());
    EXPECT_LT(stopped.skeleton.size(), watched.skeleton.size());
}

TEST(Grow, RejectsOptionsOutOfRangeByName) {
    const float kNan = std::numeric_limits<float>::quiet_NaN(),
                kHuge = std::numeric_limits<float>::infinity();
    GrowOptions probe;
    std::vector<std::string> names;
    for (const OptionField& member : option_fields(probe)) names.emplace_back(member.field.name);
    for (const std::string& name : names) {
        for (int which = 0; which < 4; ++which) {
            GrowOptions options;
            bool skip = false;
            for (const auto& [f, ref] : option_fields(options)) {
                if (f.name != name) continue;
                if (auto* const* real = std::get_if<float*>(&ref)) {
                    const float bad[]{kNan, kHuge, -kHuge, static_cast<float>(f.low) - 1};
                    **real = bad[which];
                } else if (auto* const* whole = std::get_if<int*>(&ref)) {
                    // The maximum seed is the maximum integer.
                    skip = f.high >= 2147483647 && which == 0;
                    **whole = which == 0 ? std::numeric_limits<int>::max() : -which;
                } else {
                    skip = true;
                }
            }
            if (skip) continue;
            const std::string error = test::error_of([&] { grow_at_origin({{0, 0, 1}}, options); });
            EXPECT_NE(error.find(name), std::string::npos) << name << " " << which << ": " << error;
        }
    }
}

TEST(Grow, RejectsInconsistentInput) {
    const auto error = [](const std::vector<Vec3>& a, const std::vector<Root>& roots,
                          const GrowOptions& o = {}) {
        return test::error_of([&] { grow({.attractors = a, .roots = roots}, o); });
    };
    const float kNan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(error({}, kOrigin, {.kill_radius = 0.05f}).find("kill_radius"), std::string::npos);
    EXPECT_NE(error({}, kOrigin, {.influence_radius = 0.15f}).find("influence_radius"), std::string::npos);
    EXPECT_NE(error({}, kOrigin, {.tropism_z = 0, .tropism_weight = 1}).find("tropism"), std::string::npos);
    EXPECT_NE(error({{0, 0, 1}}, {}).find("root"), std::string::npos);
    EXPECT_NE(error({{0, 0, 1}, {0, kNan, 1}}, kOrigin).find("attractor 1"), std::string::npos);
    EXPECT_NE(error({}, {{{0, 0, kNan}, {}}}).find("root 0"), std::string::npos);
    EXPECT_NE(error({}, {{{0, 0, 0}, {kNan, 0, 0}}}).find("direction"), std::string::npos);
    EXPECT_NE(error({{1e9f, 0, 0}}, kOrigin).find("attractor 0"), std::string::npos);
    EXPECT_NE(error({{3e38f, 0, 0}}, kOrigin).find("attractor 0"), std::string::npos);
}

TEST(Grow, DescribesEveryOptionOnceWithItsDefaultInRange) {
    test::expect_described<GrowOptions>(3);  // bytes of padding after the bool
}

/// A stem of five nodes with a twig at the third, with its own radii and ids.
Skeleton young_tree(Vec3d origin = {}) {
    const auto id = [](std::uint32_t i) { return NodeId(i); };
    return Skeleton({NodeId::none(), id(0), id(1), id(2), id(3), id(2)},
                    {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {0, 0, 4}, {1, 0, 2.5f}},
                    {0.5f, 0.4f, 0.3f, 0.2f, 0.1f, 0.05f}, origin,
                    {StableId(3), StableId(1), StableId(4), StableId(10), StableId(5), StableId(9)});
}

const GrowOptions kOfYoungTree{.influence_radius = 2, .kill_radius = 0.3f, .step = 0.2f};

TEST(GrowFromTree, PreservesOldNodesAndAttachesNewOnes) {
    const Skeleton tree = young_tree({100, 0, 0});
    const auto points = ball(300, {0, 0, 5}, 1.5);
    const GrowResult r = grow({.attractors = points, .roots = {}, .tree = &tree}, kOfYoungTree);
    const Skeleton& s = r.skeleton;
    ASSERT_GT(s.size(), 100u);
    EXPECT_EQ(r.stop, StopReason::attractors_spent);
    EXPECT_EQ(s.tree_count(), 1u);
    EXPECT_EQ(s.origin(), Vec3d(100, 0, 0));
    for (const NodeId n : nodes(tree)) {
        EXPECT_EQ(s.parent(n), tree.parent(n));
        EXPECT_EQ(s.position(n), tree.position(n));
        EXPECT_EQ(s.radius(n), tree.radius(n));
        EXPECT_EQ(s.stable_id(n), tree.stable_id(n));
    }
    EXPECT_EQ(s.stable_id(NodeId(6)), StableId(11));
    for (std::uint32_t i = tree.size(); i < s.size(); ++i) {
        ASSERT_FALSE(s.is_root(NodeId(i)));
        const Vec3 from = s.position(s.parent(NodeId(i)));
        EXPECT_NEAR(distance(s.position(NodeId(i)), from), 0.2f, 1e-4f);
        EXPECT_FLOAT_EQ(s.radius(NodeId(i)), 0.02f);
    }
}

TEST(GrowFromTree, FarTreeGrowsATrunkFromItsNearestNode) {
    const Skeleton tree = young_tree();
    const std::vector<Vec3> points{{4, 0, 2.5f}};
    const GrowResult r = grow({.attractors = points, .roots = {}, .tree = &tree}, kOfYoungTree);
    EXPECT_EQ(r.stop, StopReason::attractors_spent);
    EXPECT_EQ(r.skeleton.parent(NodeId(6)), NodeId(5));
    const GrowResult none = grow({.attractors = points, .roots = {}, .tree = &tree},
                                 {.influence_radius = 2, .kill_radius = 0.3f, .step = 0.2f, .trunk = false});
    EXPECT_EQ(none.skeleton.size(), tree.size());
    EXPECT_EQ(none.stop, StopReason::no_progress);
}

TEST(GrowFromTree, AcceptsAdditionalRoots) {
    const Skeleton tree = young_tree();
    const std::vector<Root> roots{{{10, 0, 0}, {0, 0, 1}}};
    std::vector<Vec3> points = ball(100, {0, 0, 5}, 1);
    for (const Vec3 p : ball(100, {10, 0, 5}, 1)) points.push_back(p);
    const Skeleton s = grow({.attractors = points, .roots = roots, .tree = &tree}, kOfYoungTree).skeleton;
    EXPECT_EQ(s.tree_count(), 2u);
    EXPECT_TRUE(s.is_root(NodeId(6)));
    EXPECT_GT(s.position(s.children(NodeId(6)).front()).z, 0.199f);  // straight on, as specified
}

TEST(GrowFromTree, SecondStageReachesFartherAttractors) {
    const std::vector<Vec3> low = ball(200, {0, 0, 2}, 1), high = ball(200, {0, 0, 6}, 1);
    const Skeleton first = grow({.attractors = low, .roots = kOrigin}, kOfYoungTree).skeleton;
    const GrowResult second = grow({.attractors = high, .roots = {}, .tree = &first}, kOfYoungTree);
    EXPECT_EQ(second.stop, StopReason::attractors_spent);
    EXPECT_GT(second.skeleton.size(), first.size() + 80);
    EXPECT_EQ(second.skeleton.tree_count(), 1u);
}

TEST(GrowFromTree, BudsAreCountedAlongTheExistingAxis) {
    // Laterals start only at every second node: 1 and 3 of the stem have no bud, although the twig at 2 was
    // added later.
    const Skeleton tree = young_tree();
    const std::vector<Vec3> points{{0.9f, 0, 1}, {0.9f, 0, 3.1f}, {-0.9f, 0, 2}};
    const GrowOptions options{.influence_radius = 1, .kill_radius = 0.2f, .step = 0.2f, .bud_interval = 2};
    const Skeleton s = grow({.attractors = points, .roots = {}, .tree = &tree}, options).skeleton;
    EXPECT_EQ(s.children(NodeId(1)).size(), 1u);
    EXPECT_EQ(s.children(NodeId(3)).size(), 1u);
    EXPECT_EQ(s.children(NodeId(2)).size(), 3u);
}

TEST(GrowFromTree, DenseTreeIsNotSlow) {
    // All nodes in one cell of the grid that keeps nodes apart.
    std::vector<NodeId> parents{NodeId::none()};
    std::vector<Vec3> positions{{0, 0, 0}};
    for (std::uint32_t i = 1; i < 50'000; ++i) {
        parents.emplace_back(i - 1);
        positions.emplace_back(0.001f * static_cast<float>(i % 7), 0, 2e-6f * static_cast<float>(i));
    }
    const Skeleton tree(parents, positions, std::vector<float>(positions.size(), 0.01f));
    const auto points = ball(3000, {0, 0, 20}, 15);
    const GrowOptions options{.influence_radius = 30, .kill_radius = 2, .step = 1, .max_iterations = 200};
    const GrowResult r = grow({.attractors = points, .roots = {}, .tree = &tree}, options);
    EXPECT_GT(r.skeleton.size(), tree.size() + 200);
}

TEST(GrowFromTree, RejectsInvalidInput) {
    const Skeleton tree = young_tree();
    const std::vector<Vec3> points{{0, 0, 5}};
    EXPECT_EQ(
        test::error_of([&] { grow({.attractors = points, .roots = {}, .tree = &tree}, {.max_nodes = 5}); }),
        "grow: the existing tree has 6 nodes, but max_nodes is 5");
    const Skeleton far = Skeleton({NodeId::none()}, {{1e9f, 0, 0}}, {1});
    EXPECT_NE(test::error_of([&] { grow({.attractors = points, .roots = {}, .tree = &far}); }), "no error");
    EXPECT_NE(test::error_of([&] { grow({.attractors = points, .roots = {}}); }), "no error");
    const GrowResult full = grow({.attractors = points, .roots = {}, .tree = &tree}, {.max_nodes = 6});
    EXPECT_EQ(full.stop, StopReason::node_limit);
    EXPECT_EQ(full.skeleton.size(), 6u);
}

}  // namespace
}  // namespace coppice
