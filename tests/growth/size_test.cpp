#include "coppice/growth/size.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coppice/base/error.h"
#include "coppice/growth/radii.h"
#include "described_options.h"

namespace coppice {
namespace {

/// A stem of 10 m with a node every metre and a lateral at 5 m, in radii by the pipe model.
Skeleton make_tree() {
    std::vector<NodeId> parents{NodeId()};
    std::vector<Vec3> positions{{1, 2, 3}};
    for (std::uint32_t i = 1; i <= 10; ++i) {
        parents.emplace_back(i - 1);
        positions.push_back({1, 2, 3 + static_cast<float>(i)});
    }
    parents.emplace_back(5);
    positions.push_back({4, 2, 9});
    std::vector<float> radii(parents.size(), 1);
    return with_pipe_radii(Skeleton(std::move(parents), std::move(positions), std::move(radii)));
}

TEST(Size, reaches_height_and_diameter) {
    const Skeleton tree = with_size(make_tree(), {.height = 20, .dbh = 0.4f, .tip_radius = 0.005f});
    const TreeSize size = measure_size(tree);
    EXPECT_NEAR(size.height, 20, 1e-4);
    EXPECT_NEAR(size.dbh, 0.4, 1e-5);
    EXPECT_NEAR(size.width, 3, 1e-4);  // 6 m in x, 0 in y
    EXPECT_NEAR(std::ranges::min(tree.radii()), 0.005f, 1e-7);
    EXPECT_EQ(tree.position(NodeId(0)), (Vec3{1, 2, 3}));
}

TEST(Size, keeps_the_diameter_with_taper_and_flare) {
    const SizeOptions options{.height = 10, .dbh = 0.3f, .taper = 0.5f, .flare = 0.4f, .flare_height = 0.5f};
    const Skeleton tree = with_size(make_tree(), options);
    // The diameter is interpolated between nodes at 1 and 2 m.
    EXPECT_NEAR(measure_size(tree).dbh, 0.3, 0.01);
    const Skeleton plain = with_size(make_tree(), {.height = 10, .dbh = 0.3f});
    // At the ground: 1.5 / (1 + 0.5 * 0.87) for the taper, 1.4 / (1 + 0.4 exp(-2.6)) for the flare.
    EXPECT_NEAR(tree.radius(NodeId(0)) / plain.radius(NodeId(0)), 1.5 / 1.435 * 1.4 / 1.0297, 0.02);
}

TEST(Size, low_trees_are_measured_at_a_quarter_of_their_height) {
    const Skeleton tree = with_size(make_tree(), {.height = 2, .dbh = 0.1f});
    EXPECT_NEAR(measure_size(tree).dbh, 0.1, 1e-4);
}

TEST(Size, scales_radii_without_a_diameter) {
    const Skeleton tree = with_size(make_tree(), {.height = 5});
    EXPECT_FLOAT_EQ(tree.radius(NodeId(0)), 0.5f * make_tree().radius(NodeId(0)));
}

TEST(Size, refuses_trees_and_diameters_that_do_not_fit) {
    const Skeleton level({NodeId(), NodeId(0)}, {{0, 0, 0}, {1, 0, 0}}, {1, 1});
    EXPECT_THROW(with_size(level), InvalidInput);
    EXPECT_THROW(with_size(make_tree(), {.height = 10, .dbh = 0.005f}), InvalidInput);
    EXPECT_THROW(with_size(make_tree(), {.height = 0}), InvalidInput);
    EXPECT_EQ(measure_size(Skeleton()).height, 0);
}

TEST(Size, DescribeEveryOption) { test::expect_described<SizeOptions>(); }

}  // namespace
}  // namespace coppice
