#include "coppice/field/field_options.h"

#include <gtest/gtest.h>

#include <cstddef>

namespace coppice {
namespace {

struct Checker {
    std::size_t bytes = 0;
    void operator()(const Field&, Kernel) { bytes += sizeof(Kernel); }
    template <class Number>
    void operator()(const Field& field, Number value) {
        bytes += sizeof(Number);
        EXPECT_GE(value, field.low) << field.name;
        EXPECT_LE(value, field.high) << field.name;
    }
};

TEST(FieldOptions, EveryMemberIsVisitedAndItsDefaultLiesInRange) {
    Checker checker;
    const FieldOptions options;
    visit_fields(options, checker);
    EXPECT_EQ(checker.bytes, sizeof(FieldOptions));
    EXPECT_EQ(name_of(options.kernel), "quartic");
    EXPECT_EQ(name_of(Kernel::scalis), "scalis");
}

}  // namespace
}  // namespace coppice
