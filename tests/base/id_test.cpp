#include "coppice/base/id.h"

#include <gtest/gtest.h>

#include <limits>
#include <type_traits>

namespace coppice {
namespace {

TEST(Id, DefaultIsNone) {
    EXPECT_FALSE(NodeId());
    EXPECT_FALSE(NodeId::none());
    EXPECT_EQ(NodeId(), NodeId::none());
}

TEST(Id, IndexZeroIsNotNone) {
    EXPECT_TRUE(NodeId(0));
    EXPECT_EQ(NodeId(0).index(), 0u);
    EXPECT_EQ(NodeId(41).index(), 41u);
    EXPECT_NE(NodeId(0), NodeId::none());
}

TEST(Id, OrdersByIndexWithNoneLast) {
    EXPECT_LT(NodeId(1), NodeId(2));
    EXPECT_LT(NodeId(std::numeric_limits<std::uint32_t>::max() - 1), NodeId::none());
}

TEST(Id, TypesOfIdsAndNumbersDoNotConvert) {
    static_assert(!std::is_constructible_v<NodeId, StableId>);
    static_assert(!std::is_convertible_v<std::uint32_t, NodeId>);
    static_assert(!std::is_convertible_v<NodeId, std::uint32_t>);
    static_assert(!std::is_convertible_v<NodeId, bool>);
    static_assert(sizeof(NodeId) == 4);
    constexpr NodeId kSecond(1);
    static_assert(kSecond && kSecond.index() == 1);
}

}  // namespace
}  // namespace coppice
