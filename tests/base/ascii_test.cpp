#include "coppice/base/ascii.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(Ascii, ToLowerChangesAsciiLettersOnly) {
    EXPECT_EQ(to_lower(std::string_view("Qu_ERCUS-9 \xC3\x84z")), "qu_ercus-9 \xC3\x84z");
    EXPECT_EQ(to_lower(std::string_view()), "");
}

TEST(Ascii, NeighboursOfLettersAndDigitsAreNeither) {
    for (const char c : {'@', '[', '`', '{', '/', ':', '_', '\xC4', '\0'}) {
        EXPECT_FALSE(is_letter(c) || is_digit(c)) << int{c};
        EXPECT_EQ(to_lower(c), c);
    }
    for (const char c : {'a', 'z', 'A', 'Z'}) EXPECT_TRUE(is_letter(c) && !is_digit(c));
    for (const char c : {'0', '9'}) EXPECT_TRUE(is_digit(c) && !is_letter(c));
}

}  // namespace
}  // namespace coppice
