#include "coppice/growth/tidy.h"

#include <gtest/gtest.h>

#include <limits>

#include "coppice/base/error.h"
#include "coppice/base/hash.h"
#include "coppice/base/random.h"
#include "coppice/growth/grow.h"
#include "coppice/growth/radii.h"
#include "described_options.h"
#include "growth/fields.h"

namespace coppice {
namespace {

constexpr TidyOptions kNothing{.relax_passes = 0, .smooth_passes = 0, .shortest = 0, .within = 0};

Skeleton chain(const std::vector<Vec3>& positions) {
    std::vector<NodeId> parents;
    for (std::uint32_t i = 0; i < positions.size(); ++i) parents.push_back(i == 0 ? NodeId() : NodeId(i - 1));
    return Skeleton(parents, positions, std::vector<float>(positions.size(), 0.1f));
}

Skeleton grown_around(const SphereField& solid, const Guard* guard) {
    const CounterRandom random(5, 0);
    std::vector<Vec3> attractors;
    for (std::uint64_t i = 0; attractors.size() < 1500; ++i) {
        const auto draw = [&](std::uint64_t k) {
            return static_cast<float>(random.uniform(3 * i + k, -1.2, 1.2));
        };
        const Vec3 p{draw(0), draw(1), draw(2)};
        const float d = distance(p, solid.center) - solid.radius;
        if (d > 0 && d < 0.1f) attractors.push_back(p);
    }
    const std::vector<Root> roots{{{0, 0, -1.05f}, {}}};
    return with_pipe_radii(grow({.attractors = attractors, .roots = roots, .guard = guard},
                                {.influence_radius = 0.5f, .kill_radius = 0.1f, .step = 0.08f})
                               .skeleton,
                           {.tip_radius = 0.002f});
}

TEST(Tidy, ChangesNothingIfAllStepsAreDisabled) {
    const Skeleton s = chain({{0, 0, 0}, {0, 0, 1}, {0, 1, 1}});
    const TidyResult r = tidy(s, kNothing);
    EXPECT_TRUE(std::ranges::equal(r.skeleton.positions(), s.positions()));
    EXPECT_EQ(r.contracted, 0u);
    EXPECT_EQ(r.held, 0u);
}

TEST(Tidy, RelaxationMovesNodesHalfwayToTheirParents) {
    TidyOptions options = kNothing;
    options.relax_passes = 1;
    const TidyResult r = tidy(chain({{0, 0, 0}, {0, 0, 2}, {2, 0, 2}}), options);
    EXPECT_EQ(r.skeleton.position(NodeId(0)), Vec3(0, 0, 0));
    EXPECT_EQ(r.skeleton.position(NodeId(1)), Vec3(0, 0, 1));
    EXPECT_EQ(r.skeleton.position(NodeId(2)), Vec3(1, 0, 2));
}

TEST(Tidy, SmoothingStraightensAxesAndPreservesTheirEnds) {
    TidyOptions options = kNothing;
    options.smooth_passes = 1;
    const TidyResult r = tidy(chain({{0, 0, 0}, {1, 0, 1}, {0, 0, 2}}), options);
    EXPECT_EQ(r.skeleton.position(NodeId(1)), Vec3(0.5f, 0, 1));
    EXPECT_EQ(r.skeleton.position(NodeId(2)), Vec3(0, 0, 2));
}

TEST(Tidy, ContractsShortSegments) {
    TidyOptions options = kNothing;
    options.shortest = 0.5f;
    // Lengths 1, 0.1, 1.9: the mean is 1.
    const TidyResult r = tidy(chain({{0, 0, 0}, {0, 0, 1}, {0, 0, 1.1f}, {0, 0, 3}}), options);
    EXPECT_EQ(r.contracted, 1u);
    ASSERT_EQ(r.skeleton.size(), 3u);
    EXPECT_EQ(r.skeleton.position(NodeId(2)), Vec3(0, 0, 3));
    EXPECT_EQ(r.skeleton.parent(NodeId(2)), NodeId(1));
    EXPECT_EQ(r.new_of_old[2], NodeId(1));
    EXPECT_EQ(r.new_of_old[3], NodeId(2));
}

TEST(Tidy, ContractsEverySegmentBelowTheMinimumLength) {
    const SphereField solid{{0, 0, 0}, 1};
    const Skeleton s = grown_around(solid, nullptr);
    const TidyResult r = tidy(s);
    double sum = 0, least = 1e9;
    for (const NodeId n : nodes(r.skeleton)) {
        if (r.skeleton.is_root(n)) continue;
        const double l = distance(r.skeleton.position(n), r.skeleton.position(r.skeleton.parent(n)));
        sum += l;
        least = std::min(least, l);
    }
    EXPECT_GT(least, 0.4 * sum / (r.skeleton.size() - 1));
    for (const NodeId n : r.new_of_old) EXPECT_LT(n.index(), r.skeleton.size());
}

/// A trunk of radius 1 along z: nodes 0, 1 and 2 at 0, 1.2 and 2. At node 1 start a lateral along x, nodes 3,
/// 4 and 5, and a stub that ends inside the trunk, node 6.
Skeleton trunk_with_lateral() {
    const std::vector<NodeId> parents{NodeId(),  NodeId(0), NodeId(1), NodeId(1),
                                      NodeId(3), NodeId(4), NodeId(1)};
    const std::vector<Vec3> positions{{0, 0, 0},       {0, 0, 1.2f},    {0, 0, 2},      {0.4f, 0, 1.2f},
                                      {0.8f, 0, 1.2f}, {1.3f, 0, 1.2f}, {0, 0.5f, 1.2f}};
    return Skeleton(parents, positions, {1, 1, 1, 0.1f, 0.1f, 0.1f, 0.1f});
}

TEST(Tidy, ContractsNodesInsideTheRadiusOfTheirParent) {
    TidyOptions options = kNothing;
    options.within = 1;
    const TidyResult r = tidy(trunk_with_lateral(), options);
    // Node 2 is 0.8 from node 1, nodes 3, 4 and 6 at most as much; node 5 is 1.3 from it.
    EXPECT_EQ(r.contracted, 4u);
    ASSERT_EQ(r.skeleton.size(), 3u);
    EXPECT_EQ(r.skeleton.position(NodeId(2)), Vec3(1.3f, 0, 1.2f));
    EXPECT_EQ(r.skeleton.parent(NodeId(2)), NodeId(1));
    EXPECT_EQ(r.new_of_old[4], NodeId(1));
    EXPECT_EQ(r.new_of_old[6], NodeId(1));
}

TEST(Tidy, PreservesNodesFarFromTheirParent) {
    TidyOptions options = kNothing;
    EXPECT_EQ(tidy(trunk_with_lateral(), options).contracted, 0u);
    options.within = 0.45f;  // within 0.45 of the radius 1 there is only node 3, at 0.4
    EXPECT_EQ(tidy(trunk_with_lateral(), options).contracted, 1u);
}

TEST(Tidy, SinglePointIsUnchanged) {
    const TidyResult r = tidy(chain({{1, 2, 3}}));
    EXPECT_EQ(r.skeleton.size(), 1u);
    EXPECT_EQ(r.skeleton.position(NodeId(0)), Vec3(1, 2, 3));
}

TEST(Tidy, MergesCoincidentNodes) {
    TidyOptions options = kNothing;
    options.shortest = 0.5f;
    const TidyResult r = tidy(chain({{0, 0, 0}, {0, 0, 0}, {0, 0, 1}, {0, 0, 1}}), options);
    EXPECT_EQ(r.skeleton.size(), 2u);
}

TEST(Tidy, GuardPreventsSegmentsInsideTheSolid) {
    const SphereField solid{{0, 0, 0}, 1};
    const Guard guard{FieldRef(solid)};
    const Skeleton s = grown_around(solid, &guard);
    ASSERT_LT(range_along(s, solid).high, 0);
    const TidyOptions hard{.relax_passes = 3, .smooth_passes = 10, .shortest = 1.5f};
    EXPECT_GT(range_along(tidy(s, hard).skeleton, solid).high, 0);  // chords intersect the sphere
    std::uint64_t first = 0;
    for (const unsigned threads : {1u, 2u, 7u}) {
        const TidyResult r = tidy(s, hard, &guard, {.threads = threads});
        EXPECT_LT(range_along(r.skeleton, solid).high, 0);
        EXPECT_GT(r.held, 0u);
        EXPECT_GT(r.contracted, 0u);
        const std::uint64_t hash = Hash().add(r.skeleton.positions()).add(r.skeleton.parents()).value();
        if (first == 0) first = hash;
        EXPECT_EQ(hash, first);
    }
}

TEST(Tidy, RejectsOptionsOutOfRange) {
    const float kNan = std::numeric_limits<float>::quiet_NaN();
    const Skeleton s = chain({{0, 0, 0}, {0, 0, 1}});
    EXPECT_THROW(tidy(s, {.relax_passes = -1}), InvalidInput);
    EXPECT_THROW(tidy(s, {.relax = kNan}), InvalidInput);
    EXPECT_THROW(tidy(s, {.smooth_passes = 100000}), InvalidInput);
    EXPECT_THROW(tidy(s, {.smooth = 2}), InvalidInput);
    EXPECT_THROW(tidy(s, {.shortest = -1}), InvalidInput);
}

TEST(Tidy, CanBeCancelled) {
    std::stop_source source;
    source.request_stop();
    EXPECT_THROW(tidy(chain({{0, 0, 0}, {0, 0, 1}}), {}, nullptr, {.stop = source.get_token()}), Cancelled);
}

TEST(Tidy, DescribesEveryOption) { test::expect_described<TidyOptions>(); }

}  // namespace
}  // namespace coppice
