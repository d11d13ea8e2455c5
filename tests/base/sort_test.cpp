#include "coppice/base/sort.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "coppice/base/random.h"

namespace coppice {
namespace {

struct Item {
    std::uint64_t key;
    std::uint32_t number;
    friend bool operator==(const Item&, const Item&) = default;
};

Buffer<Item> items(std::size_t n, std::uint64_t keys) {
    Buffer<Item> out(n);
    const CounterRandom random(1, 2);
    for (std::uint32_t i = 0; i < n; ++i) out[i] = {random.bits(i) % keys, i};
    return out;
}

TEST(SortUnique, SortsAndRemovesDuplicates) {
    std::vector<int> numbers{3, 1, 3, 2, 1, 3};
    sort_unique(numbers);
    EXPECT_EQ(numbers, (std::vector{1, 2, 3}));
    std::vector<int> none;
    sort_unique(none);
    EXPECT_TRUE(none.empty());
}

TEST(RadixSort, SortsStablyForAnyNumberOfThreads) {
    for (const std::uint64_t keys : {1ull, 7ull, 2048ull, 1ull << 40}) {
        Buffer<Item> expected = items(200'000, keys);
        std::stable_sort(expected.begin(), expected.end(),
                         [](const Item& a, const Item& b) { return a.key < b.key; });
        for (const unsigned threads : {1u, 2u, 7u}) {
            Buffer<Item> sorted = items(200'000, keys);
            radix_sort({.threads = threads}, sorted, std::bit_width(keys),
                       [](const Item& i) { return i.key; });
            EXPECT_EQ(sorted, expected) << keys << " keys, " << threads << " threads";
        }
    }
}

TEST(RadixSort, SortsByTheGivenBitsOnly) {
    Buffer<Item> few{{0x1800, 0}, {0x1001, 1}, {0x0000, 2}};
    radix_sort({}, few, 11, [](const Item& i) { return i.key; });
    EXPECT_EQ(few[0].number, 0u);
    EXPECT_EQ(few[1].number, 2u);
    EXPECT_EQ(few[2].number, 1u);
}

TEST(RadixSort, AcceptsEmptyInput) {
    Buffer<Item> none;
    radix_sort({}, none, 64, [](const Item& i) { return i.key; });
    EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace coppice
