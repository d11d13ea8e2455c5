#include "coppice/render/contact_sheet.h"

#include <gtest/gtest.h>

#include "coppice/base/error.h"

namespace coppice {
namespace {

Image plain(int width, int height, std::uint8_t grey) {
    Image out(width, height);
    out.pixels.assign(out.pixels.size(), {grey, grey, grey, 255});
    return out;
}

TEST(ContactSheet, ArrangesImagesInRows) {
    const std::vector<Image> pictures{plain(3, 2, 10), plain(3, 2, 20), plain(3, 2, 30)};
    const Image sheet = contact_sheet(pictures);
    EXPECT_EQ(sheet.width, 6);
    EXPECT_EQ(sheet.height, 4);
    EXPECT_EQ(sheet.at(0, 0)[0], 10);
    EXPECT_EQ(sheet.at(5, 1)[0], 20);
    EXPECT_EQ(sheet.at(2, 3)[0], 30);
    EXPECT_EQ(sheet.at(3, 3)[0], 255);
    EXPECT_EQ(contact_sheet(pictures, 1).height, 6);
    EXPECT_EQ(contact_sheet(pictures, 100).width, 9);
}

TEST(ContactSheet, RejectsEmptyMixedAndOversizedInput) {
    EXPECT_THROW(contact_sheet({}), InvalidInput);
    const std::vector<Image> mixed{plain(3, 2, 0), plain(2, 2, 0)};
    EXPECT_THROW(contact_sheet(mixed), InvalidInput);
    const std::vector<Image> many(3, Image(10'000, 5'000));
    EXPECT_THROW(contact_sheet(many), InvalidInput);
}

}  // namespace
}  // namespace coppice
