#include "coppice/render/silhouette.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "errors.h"

namespace coppice {
namespace {

/// A square of 4 x 4 pixels in 10 x 10, on a background with a noise of a few levels.
Image square(Image::Pixel inside, Image::Pixel outside) {
    Image image(10, 10);
    for (int y = 0; y < 10; ++y) {
        for (int x = 0; x < 10; ++x) {
            const bool in = x >= 3 && x < 7 && y >= 3 && y < 7;
            image.at(x, y) = in ? inside : outside;
            if (!in && outside[3] == 255)
                image.at(x, y)[1] = static_cast<std::uint8_t>(outside[1] + (3 * x + y) % 4);
        }
    }
    return image;
}

void expect_square(const Mask& mask) {
    EXPECT_EQ(std::ranges::count(mask.inside, 1), 16);
    EXPECT_TRUE(mask.at(3, 3) && mask.at(6, 6));
}

TEST(SilhouetteOf, FollowsAlpha) {
    expect_square(compute_silhouette(square({90, 90, 90, 200}, {90, 90, 90, 40})));
}

TEST(SilhouetteOf, FollowsTheDifferenceFromTheBorder) {
    expect_square(compute_silhouette(square({80, 60, 40, 255}, {150, 200, 240, 255})));
    expect_square(compute_silhouette(square({255, 255, 255, 255}, {0, 0, 0, 255})));
}

TEST(SilhouetteOf, RejectsAnImageWithoutPixels) {
    EXPECT_EQ(test::error_of([] { compute_silhouette(Image()); }),
              "an image without pixels has no silhouette");
}

}  // namespace
}  // namespace coppice
