#include "coppice/field/contact_lists.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "coppice/field/convolution_field.h"
#include "field/crowded_stem.h"

namespace coppice {
namespace {

// Two parallel trees of one segment each: axes 0.15 apart, radius 0.1, so that they overlap.
struct TwoStems {
    Skeleton skeleton{{NodeId::none(), NodeId(0), NodeId::none(), NodeId(2)},
                      {{0, 0, 0}, {0, 0, 2}, {0.15f, 0, 0}, {0.15f, 0, 2}},
                      {0.1f, 0.1f, 0.1f, 0.1f}};
    std::vector<NodeId> tube{NodeId(0), NodeId(1), NodeId(2), NodeId(3)};
    std::vector<FieldRegion> regions;

    TwoStems() {
        for (const NodeId n : tube) {
            const float x = n.index() < 2 ? 0 : 0.15f;
            regions.push_back({capsule_box({x, 0, 0}, {x, 0, 2}, 0.1f), n});
        }
    }
    TubeTree tubes() const { return {skeleton, tube}; }
};

float value_at(const ConvolutionField& field, std::uint32_t region, Vec3 p) {
    std::array<FieldSample, 1> out;
    field.sample(region, std::array{p}, out);
    return out[0].value;
}

TEST(FindContacts, UnrelatedNeighboursAreCompetitors) {
    const TwoStems s;
    ConvolutionField field(s.skeleton, {});
    field.set_regions(s.regions, s.tubes());
    EXPECT_TRUE(std::ranges::equal(field.candidates(1), std::array{1u}));
    EXPECT_TRUE(std::ranges::equal(field.competitors(1), std::array{3u}));
    EXPECT_TRUE(std::ranges::equal(field.competitors(3), std::array{1u}));
}

TEST(FindContacts, AncestorsDescendantsAndSiblingsAreNoCompetitors) {
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(1)},
                     {{0, 0, 0}, {0, 0, 1}, {0.3f, 0, 1.5f}, {-0.3f, 0, 1.5f}}, {0.1f, 0.1f, 0.1f, 0.1f});
    const std::vector<NodeId> tube{NodeId(0), NodeId(1), NodeId(2), NodeId(3)};
    std::vector<FieldRegion> regions;
    for (const NodeId n : tube) regions.push_back({Box3{{-1, -1, -1}, {1, 1, 3}}, n});
    ConvolutionField field(s, {});
    field.set_regions(regions, {s, tube});
    for (std::uint32_t r = 1; r < 4; ++r) {
        EXPECT_EQ(field.candidates(r).size(), 3u);
        EXPECT_TRUE(field.competitors(r).empty());
    }
}

// A stem, and a branch of another tree that ends in its middle.
TEST(FindContacts, JoinedBranchesAreNoCompetitors) {
    const NodeId none;
    const Skeleton s({none, NodeId(0), NodeId(1), none, NodeId(3)},
                     {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {2, 0, 1}, {0, 0, 1}}, {0.1f, 0.1f, 0.1f, 0.1f, 0.1f});
    const std::vector<NodeId> tube{NodeId(0), NodeId(1), NodeId(2), NodeId(3), NodeId(4)};
    std::vector<FieldRegion> regions;
    for (const NodeId n : tube) regions.push_back({Box3{{-0.2f, -0.2f, 0.8f}, {0.2f, 0.2f, 1.2f}}, n});
    ConvolutionField field(s, {});
    field.set_regions(regions, {s, tube});
    EXPECT_TRUE(std::ranges::equal(field.candidates(4), std::array{4u}));
    EXPECT_EQ(field.competitors(4).size(), 2u);
    const std::vector<NodeJoin> joins{{NodeId(4), NodeId(1)}};
    field.set_regions(regions, {s, tube, joins});
    for (const std::uint32_t r : {1u, 2u, 4u}) {
        EXPECT_EQ(field.candidates(r).size(), 3u);
        EXPECT_TRUE(field.competitors(r).empty());
    }
}

TEST(FindContacts, CompetitorsDoNotReplaceRelatedSegments) {
    const Skeleton s = crowded_stem();
    std::vector<NodeId> tube;
    std::vector<FieldRegion> regions;
    for (const NodeId n : nodes(s)) {
        tube.push_back(n);
        regions.push_back({Box3{{-1, -1, -1}, {1, 1, 2}}, n});
    }
    ConvolutionField field(s, {});
    field.set_regions(regions, {s, tube});
    EXPECT_EQ(field.candidates(s.size() - 1).size(), 1u + 9u + 99u);
}

TEST(FindContacts, SelectsTheNearestOfManyCompetitors) {
    // A hundred stems along x, all of which meet the first region's box.
    constexpr std::uint32_t kStems = 100;
    std::vector<NodeId> parent, tube;
    std::vector<Vec3> position;
    std::vector<FieldRegion> regions;
    for (std::uint32_t i = 0; i < kStems; ++i) {
        const float x = 0.01f * static_cast<float>(i);
        parent.insert(parent.end(), {NodeId::none(), NodeId(2 * i)});
        position.insert(position.end(), {{x, 0, 0}, {x, 0, 1}});
    }
    for (std::uint32_t n = 0; n < 2 * kStems; ++n) {
        tube.emplace_back(n);
        regions.push_back({Box3{{-1, -1, 0}, {1, 1, 1}}, NodeId(n)});
    }
    const Skeleton s(parent, position, std::vector<float>(2 * kStems, 2.0f));
    ConvolutionField field(s, {});
    field.set_regions(regions, {s, tube});
    ASSERT_EQ(field.competitors(1).size(), 48u);
    for (const std::uint32_t competitor : field.competitors(1)) EXPECT_LT(competitor, 2 * 49u);
}

TEST(Contact, OverlappingStemsHaveAGapBetweenThem) {
    const TwoStems s;
    ConvolutionField field(s.skeleton, {});
    field.set_regions(s.regions, s.tubes());
    // Half-way both have the same value, so that each is divided by 1.6: neither surface reaches the middle.
    EXPECT_LT(value_at(field, 1, {0.075f, 0, 1}), 1);
    EXPECT_LT(value_at(field, 3, {0.075f, 0, 1}), 1);
    EXPECT_NEAR(value_at(field, 1, {0.075f, 0, 1}), 1 / 1.6f, 1e-4f);
    // There is no contact on the far side.
    EXPECT_NEAR(value_at(field, 1, {-0.1f, 0, 1}), 1, 1e-4f);
}

TEST(Contact, ZeroDisablesIt) {
    const TwoStems s;
    ConvolutionField field(s.skeleton, {.contact = 0});
    field.set_regions(s.regions, s.tubes());
    EXPECT_TRUE(field.competitors(1).empty());
    EXPECT_GT(value_at(field, 1, {0.075f, 0, 1}), 1);
}

TEST(Contact, GradientsMatchFiniteDifferences) {
    const TwoStems s;
    ConvolutionField field(s.skeleton, {});
    field.set_regions(s.regions, s.tubes());
    for (const Vec3 p : {Vec3{0.06f, 0.01f, 1}, Vec3{0.08f, -0.03f, 0.7f}, Vec3{0.02f, 0.05f, 1.3f}}) {
        std::array<FieldSample, 1> out;
        field.sample(1, std::array{p}, out);
        const float h = 1e-3f;
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 step;
            step[axis] = h;
            const float slope = (value_at(field, 1, p + step) - value_at(field, 1, p - step)) / (2 * h);
            EXPECT_NEAR(out[0].gradient[axis], slope, 0.02f * (1 + std::abs(slope)));
        }
    }
}

}  // namespace
}  // namespace coppice
