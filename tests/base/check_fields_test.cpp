#include "coppice/base/check_fields.h"

#include "coppice/base/option_fields.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <string>

#include "errors.h"

namespace coppice {
namespace {

enum class Wood { oak, pear };

struct ChiselOptions {
    float width = 1;
    Wood handle = Wood::oak;
};

void list_fields(ChiselOptions& options, FieldList& list) {
    list.add(Field{"width", "how wide", Unit::metre, 0, 2}, options.width);
    list.add(Field{"handle", "Material of the carving."}, options.handle);
}

}  // namespace

template <>
struct EnumNames<Wood> {
    static constexpr std::array<std::string_view, 2> names{"oak", "pear"};
};

namespace {

struct CarveOptions {
    int count = 3;
    float depth = 0.7f;
    float lean = 0;
    bool polish = false;
    ChiselOptions chisel;
};

void list_fields(CarveOptions& options, FieldList& list) {
    list.add(Field{"count", "how many notches", Unit::none, 1, 8}, options.count);
    list.add(Field{"depth", "how deep", Unit::metre, 0.5, 0.7}, options.depth);
    list.add(Field{"lean", "how far to lean; any number"}, options.lean);
    list.add(Field{"polish", "whether to polish"}, options.polish);
    list.add(Field{"chisel", "Tool of the carving."}, options.chisel);
}

std::string complaint(const CarveOptions& options) {
    return test::error_of([&] { check_fields(options, "carve"); });
}

TEST(CheckFields, AcceptsValuesInRange) {
    EXPECT_EQ(complaint({}), "no error");
    EXPECT_EQ(complaint({.count = 1, .depth = 0.5f, .polish = true}), "no error");
    EXPECT_EQ(complaint({.count = 8}), "no error");
}

TEST(CheckFields, AcceptsABoundThatFloatCannotRepresent) {
    // 0.7 is 0.699999988 as a float: the default is at the bound, and not below it.
    EXPECT_EQ(complaint({.depth = 0.7f}), "no error");
    EXPECT_NE(complaint({.depth = std::nextafter(0.7f, 1.0f)}), "no error");
}

TEST(CheckFields, ReportsSourceFieldRangeAndValue) {
    EXPECT_EQ(complaint({.count = 0}), "carve: count must be between 1 and 8, but is 0");
    EXPECT_EQ(complaint({.count = 9}), "carve: count must be between 1 and 8, but is 9");
    EXPECT_EQ(complaint({.depth = 0.25f}), "carve: depth must be between 0.5 and 0.7, but is 0.25");
}

TEST(CheckFields, ChecksNestedStructsAndEnums) {
    EXPECT_EQ(complaint({.chisel = {.width = 3}}), "carve: chisel.width must be between 0 and 2, but is 3");
    EXPECT_EQ(complaint({.chisel = {.handle = static_cast<Wood>(2)}}),
              "carve: chisel.handle must be one of oak, pear");
    EXPECT_EQ(complaint({.chisel = {.width = 2, .handle = Wood::pear}}), "no error");
}

TEST(CheckFields, ReportsTheFirstInvalidField) {
    EXPECT_EQ(complaint({.count = -1, .depth = -1}).find("carve: count"), 0u);
}

TEST(CheckFields, RejectsNonFiniteNumbers) {
    EXPECT_EQ(complaint({.depth = std::numeric_limits<float>::quiet_NaN()}),
              "carve: depth must be between 0.5 and 0.7, but is nan");
    EXPECT_EQ(complaint({.depth = std::numeric_limits<float>::infinity()}),
              "carve: depth must be between 0.5 and 0.7, but is inf");
}

TEST(CheckFields, AcceptsAnyValueWithoutARange) { EXPECT_EQ(complaint({.lean = -1e30f}), "no error"); }

}  // namespace
}  // namespace coppice
