#include "coppice/foliage/leaf_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "coppice/base/error.h"
#include "coppice/foliage/leaf_species.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;

std::uint8_t find_alpha(const LeafImage& image, float u, float v) {
    const int x = std::clamp(static_cast<int>(u * static_cast<float>(image.width)), 0, image.width - 1);
    const int y =
        std::clamp(static_cast<int>((1 - v) * static_cast<float>(image.height)), 0, image.height - 1);
    return image.alpha[static_cast<std::size_t>(y * image.width + x)];
}

/// The elliptic outline covers 0.719 of its rectangle.
TEST(LeafImage, covers_the_share_of_the_outline) {
    const LeafImage image = make_leaf_image({.petiole_length = 0}, 160);
    EXPECT_EQ(image.height, 160);
    EXPECT_EQ(image.width, 80);
    const double covered = std::accumulate(image.alpha.begin(), image.alpha.end(), 0.0) / 255;
    EXPECT_NEAR(covered / static_cast<double>(image.size()), 0.719, 0.015);
}

TEST(LeafImage, fits_the_meshes_of_all_species) {
    for (const LeafSpecies& species : leaf_species()) {
        if (species.shape.parts == LeafParts::needles) continue;
        const LeafImage image = make_leaf_image(species.shape, 200);
        const std::vector<TexturePoint> texture = make_leaf(species.shape).prototype.texture;
        int inside = 0;
        for (std::size_t i = 0; i < texture.size(); i += 3) {
            const float u = (texture[i].u + texture[i + 1].u + texture[i + 2].u) / 3;
            const float v = (texture[i].v + texture[i + 1].v + texture[i + 2].v) / 3;
            inside += find_alpha(image, u, v) > 100 ? 1 : 0;
        }
        // Leaflets of pinnate leaves are few pixels wide.
        const double share = species.shape.parts == LeafParts::pinnate ? 0.8 : 0.9;
        EXPECT_GT(inside, static_cast<int>(share * static_cast<double>(texture.size()) / 3)) << species.name;
    }
}

TEST(LeafImage, midrib_is_lighter_than_the_blade) {
    const LeafImage image = make_leaf_image({.petiole_length = 0}, 200, {0.3, 0.4, 0.2});
    const auto at = [&](int x, int y) { return image.color[static_cast<std::size_t>(y * image.width + x)]; };
    EXPECT_GT(at(50, 120)[0], at(40, 120)[0] + 20);
    // Outside of the leaf is the colour of the blade, so that scaled images have no dark border.
    EXPECT_EQ(at(0, 0), (LeafImage::Texel{77, 102, 51}));
    EXPECT_EQ(find_alpha(image, 0.01f, 0.99f), 0);
}

TEST(LeafImageThreads, same_bits_for_any_number_of_threads) {
    const LeafShape shape = find_leaf_species("oak")->shape;
    const LeafImage one = make_leaf_image(shape, 120, {0.3, 0.4, 0.2}, {.threads = 1});
    const LeafImage three = make_leaf_image(shape, 120, {0.3, 0.4, 0.2}, {.threads = 3});
    EXPECT_EQ(one.color, three.color);
    EXPECT_EQ(one.alpha, three.alpha);
}

TEST(LeafImage, refuses_sizes_and_colours_out_of_range) {
    EXPECT_EQ(error_of([] { make_leaf_image({}, 4); }),
              "leaf: the size of the image must be between 8 and 4096, but is 4");
    EXPECT_EQ(error_of([] {
                  make_leaf_image({}, 64, {0, 2, 0});
              }),
              "leaf: the colour must have three values from 0 to 1, but has 2");
}

}  // namespace
}  // namespace coppice
