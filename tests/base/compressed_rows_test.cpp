#include "coppice/base/compressed_rows.h"

#include <gtest/gtest.h>

#include <vector>

#include "coppice/base/id.h"

namespace coppice {
namespace {

std::vector<std::uint32_t> row(const CompressedRows<std::uint32_t>& rows, std::size_t i) {
    return {rows[i].begin(), rows[i].end()};
}

TEST(CompressedRows, GroupsByKeyInOrder) {
    const std::vector<std::uint32_t> keys{2, 0, kNoIndex, 2, 3, 0};
    const auto rows = group_by(keys, 5);
    ASSERT_EQ(rows.size(), 5u);
    EXPECT_EQ(row(rows, 0), (std::vector<std::uint32_t>{1, 5}));
    EXPECT_TRUE(rows[1].empty());
    EXPECT_EQ(row(rows, 2), (std::vector<std::uint32_t>{0, 3}));
    EXPECT_EQ(row(rows, 3), (std::vector<std::uint32_t>{4}));
    EXPECT_TRUE(rows[4].empty());
    EXPECT_EQ(rows.items.size(), 5u);  // item 2 is in no row
}

TEST(CompressedRows, AcceptsItemsOfAnyType) {
    struct Item {
        char letter;
        int number;
    };
    auto rows = compress_rows<Item>(2, [](const auto& put) {
        put(1, Item{'a', 1});
        put(0, Item{'b', 2});
        put(1, Item{'c', 3});
    });
    EXPECT_EQ(rows[0][0].letter, 'b');
    EXPECT_EQ(rows[1][0].letter, 'a');
    EXPECT_EQ(rows[1][1].number, 3);
    rows[1][1].number = 4;
    EXPECT_EQ(rows.items[2].number, 4);
}

TEST(CompressedRows, AcceptsEmptyInput) {
    EXPECT_EQ(CompressedRows<int>().size(), 0u);
    EXPECT_EQ(group_by({}, 0).size(), 0u);
    EXPECT_EQ(group_by({}, 3).size(), 3u);
}

}  // namespace
}  // namespace coppice
