#include "coppice/mesh/texture_table.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

// Two quads around a tube with the vertices 0 to 3: u is 0, 0.5 and, at the seam through 0 and 3, 1.
const std::vector<std::uint32_t> kCorners{0, 1, 2, 3, 1, 0, 3, 2};
const std::vector<TexturePoint> kTexture{{0, 0},    {0.5f, 0}, {0.5f, 1}, {0, 1},
                                         {0.5f, 0}, {1, 0},    {1, 1},    {0.5f, 1}};

TEST(TextureTable, ListsVerticesAtSeamsOncePerPlace) {
    const TextureTable table = make_texture_table(kCorners, {kTexture, {}}, 4);
    EXPECT_EQ(table.vertex, (std::vector<std::uint32_t>{0, 1, 2, 3, 0, 3}));
    EXPECT_EQ(table.of_corner, (std::vector<std::uint32_t>{0, 1, 2, 3, 1, 4, 5, 2}));
    ASSERT_EQ(table.places.size(), table.vertex.size());
    for (std::size_t i = 0; i < kCorners.size(); ++i) {
        EXPECT_EQ(table.places[table.of_corner[i]], kTexture[i]);
        EXPECT_EQ(table.vertex[table.of_corner[i]], kCorners[i]);
    }
}

TEST(TextureTable, DividesTheValuesOfVertices) {
    const TextureTable table = make_texture_table(kCorners, {kTexture, {}}, 4);
    const std::vector<float> values{5, 6, 7, 8};
    EXPECT_EQ(divide_at_seams(std::span<const float>(values), table), (std::vector<float>{5, 6, 7, 8, 5, 8}));
}

TEST(TextureTable, IsEmptyWithoutCoordinates) {
    EXPECT_TRUE(make_texture_table(kCorners, {}, 4).of_corner.empty());
}

}  // namespace
}  // namespace coppice
