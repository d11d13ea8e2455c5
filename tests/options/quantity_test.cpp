#include "coppice/options/quantity.h"

#include <gtest/gtest.h>

#include <numbers>

namespace coppice {
namespace {

TEST(Quantity, OnlyAnglesChangeTheirUnit) {
    EXPECT_DOUBLE_EQ(in_library_unit(Unit::radian, 90), std::numbers::pi / 2);
    EXPECT_DOUBLE_EQ(in_typed_unit(Unit::radian, std::numbers::pi / 2), 90);
    for (const Unit unit : {Unit::none, Unit::metre, Unit::radius, Unit::second}) {
        EXPECT_EQ(in_library_unit(unit, 90), 90);
        EXPECT_EQ(in_typed_unit(unit, 90), 90);
    }
}

TEST(Quantity, TextsOmitMissingUnitsAndRanges) {
    EXPECT_EQ(quantity_text("number", Unit::metre, 0, 2.5), "number of metres from 0 to 2.5");
    EXPECT_EQ(quantity_text("whole number", Unit::none, -3, 7), "whole number from -3 to 7");
    EXPECT_EQ(quantity_text("whole number", Unit::none, 0, 2147483647), "whole number from 0 to 2147483647");
    EXPECT_EQ(quantity_text("whole number", Unit::none, 1, 1e8), "whole number from 1 to 1e+08");
    EXPECT_EQ(quantity_text("number", Unit::second, 0, 0), "number of seconds");
    EXPECT_EQ(quantity_text("number", Unit::none, 0, 0), "number");
}

// 1.5708 radians are 90.0002 degrees: a bound that was rounded up.
TEST(Quantity, BoundsOfAnglesAreRoundedToDegrees) {
    EXPECT_EQ(range_text(Unit::radian, 0, 1.5708), "0 to 90");
    EXPECT_EQ(range_text(Unit::radius, 0, 1.5708), "0 to 1.5708");
    EXPECT_EQ(number_text(Unit::metre, 1234567), "1.23457e+06");
}

TEST(Quantity, LongNumbersHaveSeparators) {
    EXPECT_EQ(grouped(0), "0");
    EXPECT_EQ(grouped(999), "999");
    EXPECT_EQ(grouped(1000), "1,000");
    EXPECT_EQ(grouped(12345678), "12,345,678");
}

TEST(Quantity, ParseFiniteRequiresTheWholeWord) {
    EXPECT_EQ(parse_finite("-0.25"), -0.25);
    EXPECT_EQ(parse_finite("+1e3"), 1000);
    for (const char* word : {"", "+", "1m", " 1", "1 ", "nan", "inf", "-inf", "1e999", "0x10", "1,5"})
        EXPECT_FALSE(parse_finite(word)) << word;
}

}  // namespace
}  // namespace coppice
