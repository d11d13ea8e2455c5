#include "coppice/base/number_set.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(NumberSet, CountsAndRanksItsMembersInOrder) {
    NumberSet set(200);
    for (const std::uint32_t i : {130u, 0u, 63u, 64u, 199u, 64u}) set.add(i);
    EXPECT_EQ(set.ascending(), (std::vector<std::uint32_t>{0, 63, 64, 130, 199}));
    set.count();
    EXPECT_EQ(set.rank(0), 0u);
    EXPECT_EQ(set.rank(64), 2u);
    EXPECT_EQ(set.rank(65), 3u);
    EXPECT_EQ(set.rank(199), 4u);
}

TEST(NumberSet, AddReportsNewMembers) {
    NumberSet set(70);
    EXPECT_TRUE(set.add(65));
    EXPECT_FALSE(set.add(65));
    EXPECT_TRUE(set.add(64));
    set.remove(65);
    EXPECT_TRUE(set.add(65));
}

TEST(NumberSet, AcceptsEmptySets) {
    EXPECT_TRUE(NumberSet(0).ascending().empty());
    EXPECT_TRUE(NumberSet(65).ascending().empty());
}

TEST(ChosenNumbers, HavePlacesInAscendingOrder) {
    NumberSet set(200);
    for (const std::uint32_t i : {130u, 7u, 64u}) set.add(i);
    const ChosenNumbers chosen(set);
    EXPECT_EQ(chosen.size(), 3u);
    EXPECT_EQ(std::vector<std::uint32_t>(chosen.begin(), chosen.end()),
              (std::vector<std::uint32_t>{7, 64, 130}));
    EXPECT_TRUE(chosen.has(64));
    EXPECT_FALSE(chosen.has(65));
    for (std::size_t place = 0; place < chosen.size(); ++place) EXPECT_EQ(chosen.place(chosen[place]), place);
}

}  // namespace
}  // namespace coppice
