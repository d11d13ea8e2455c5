#include "coppice/base/column.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <new>
#include <string>
#include <type_traits>

#include "coppice/base/id.h"

namespace coppice {
namespace {

constexpr std::size_t kLarge = UninitializedAllocator<int>::kLarge;

TEST(Column, IsAnArrayIndexedByIds) {
    Column<NodeId, int> column{4, 5, 6};
    EXPECT_EQ(column.size(), 3u);
    EXPECT_EQ(column[NodeId(0)], 4);
    EXPECT_EQ(column[NodeId(2)], 6);
    column[NodeId(1)] = 7;
    const auto& same = column;
    EXPECT_EQ(same[NodeId(1)], 7);
    EXPECT_EQ(same.span()[1], 7);
    column.span()[0] = 9;
    EXPECT_EQ(column, (Column<NodeId, int>{9, 7, 6}));
    EXPECT_FALSE(column == (Column<NodeId, int>{9, 7, 5}));
}

TEST(Column, AcceptsOneTypeOfIdOnly) {
    static_assert(std::is_invocable_v<decltype([](auto& c, auto i) -> decltype(c[i]) { return c[i]; }),
                                      Column<NodeId, int>&, NodeId>);
    static_assert(!std::is_invocable_v<decltype([](auto& c, auto i) -> decltype(c[i]) { return c[i]; }),
                                       Column<NodeId, int>&, StableId>);
    static_assert(!std::is_invocable_v<decltype([](auto& c, auto i) -> decltype(c[i]) { return c[i]; }),
                                       Column<NodeId, int>&, int>);
}

TEST(Column, ResizesWithDefaultOrGivenValues) {
    Column<NodeId, float> column(2, 1.5f);
    column.push_back(2.5f);
    column.resize(5);
    EXPECT_EQ(column, (Column<NodeId, float>{1.5f, 1.5f, 2.5f, 0, 0}));
    EXPECT_EQ((Column<NodeId, int>(3)), (Column<NodeId, int>{0, 0, 0}));
    EXPECT_EQ((Column<NodeId, int>()).size(), 0u);
    EXPECT_EQ((Column<NodeId, int>(std::vector<int>{1, 2})), (Column<NodeId, int>{1, 2}));
}

TEST(Buffer, PreservesValuesOfSmallAndLargeBuffers) {
    // Counts just below, equal to and above the size from which pages are allocated by the system.
    for (const std::size_t count : {kLarge / sizeof(std::uint32_t) - 1, kLarge / sizeof(std::uint32_t),
                                    kLarge / sizeof(std::uint32_t) + 1}) {
        Buffer<std::uint32_t> buffer(count);
        for (std::size_t i = 0; i < count; ++i) buffer[i] = static_cast<std::uint32_t>(i);
        buffer.push_back(7);  // moves to a larger block
        const Buffer<std::uint32_t> copy = buffer;
        ASSERT_EQ(copy.size(), count + 1);
        std::uint64_t sum = 0;
        for (const std::uint32_t v : copy) sum += v;
        EXPECT_EQ(sum, std::uint64_t{count} * (count - 1) / 2 + 7);  // 0 + 1 + ... + (count - 1), and the 7
    }
}

TEST(Buffer, FillsWithTheGivenValue) {
    const Buffer<int> sevens(100, 7);
    EXPECT_EQ(std::count(sevens.begin(), sevens.end(), 7), 100);
}

TEST(Buffer, ConstructsNonTrivialValues) {
    Buffer<std::string> words(3);
    words[1] = "a word that is too long for the internal buffer of a string";
    words.resize(40);
    EXPECT_EQ(words[0], "");
    EXPECT_EQ(words[1].size(), 59u);
    EXPECT_EQ(words[39], "");
}

TEST(Buffer, LargeBlocksAreAlignedToPages) {
    Buffer<char> buffer(kLarge);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(buffer.data()) % 4096, 0u);
}

TEST(Buffer, RejectsSizesBeyondTheAddressSpace) {
    constexpr std::size_t kMax = std::numeric_limits<std::size_t>::max();
    EXPECT_THROW(UninitializedAllocator<double>().allocate(kMax / 4), std::bad_array_new_length);
    EXPECT_THROW(allocate_large(kMax), std::bad_alloc);  // rounding up to pages must not overflow to 0
}

}  // namespace
}  // namespace coppice
