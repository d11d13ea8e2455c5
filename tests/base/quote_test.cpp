#include "coppice/base/quote.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(Quote, PreservesShortText) {
    EXPECT_EQ(quote(""), "''");
    EXPECT_EQ(quote("stem"), "'stem'");
    EXPECT_EQ(quote(std::string(80, 'a')), "'" + std::string(80, 'a') + "'");
}

TEST(Quote, TruncatesLongText) {
    EXPECT_EQ(quote(std::string(3000, 'a')), "'" + std::string(80, 'a') + "...'");
    EXPECT_EQ(shortened("abcdef", 4), "abcd...");
}

// "\u00e4" has two bytes; the second one would be the fourth byte of the text.
TEST(Quote, TruncatesBetweenCharacters) {
    EXPECT_EQ(shortened("ab\u00e4cdef", 3), "ab...");
    EXPECT_EQ(shortened("ab\u00e4cdef", 4), "ab\u00e4...");
    EXPECT_EQ(shortened(std::string(9, '\x80'), 4), "...");
}

}  // namespace
}  // namespace coppice
