#include "coppice/field/field_options.h"

#include <gtest/gtest.h>

#include <cstddef>

#include "described_options.h"

namespace coppice {
namespace {

TEST(FieldOptions, EveryMemberIsDescribedWithADefaultInRange) {
    test::expect_described<FieldOptions>();
    EXPECT_EQ(name_of(FieldOptions{}.kernel), "quartic");
    EXPECT_EQ(name_of(Kernel::scalis), "scalis");
    EXPECT_EQ(name_of(Kernel::balls), "balls");
    EXPECT_EQ(name_of(FieldOptions{}.weights), "local");
    EXPECT_EQ(name_of(Weights::global), "global");
}

}  // namespace
}  // namespace coppice
