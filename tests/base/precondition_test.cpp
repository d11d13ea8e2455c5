#include "coppice/base/error.h"

#include <gtest/gtest.h>

#include <string>
#include <type_traits>

namespace coppice {
namespace {

TEST(Precondition, ABrokenPreconditionIsThrownWithItsPlaceAndNotPrinted) {
    testing::internal::CaptureStderr();
    std::string text;
    try {
        COPPICE_ASSERT(2 < 1);
    } catch (const PreconditionBroken& error) {
        text = error.what();
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_NE(text.find("precondition_test.cpp:"), std::string::npos) << text;
    EXPECT_TRUE(text.ends_with("precondition broken: 2 < 1")) << text;
}

TEST(Precondition, APreconditionThatHoldsDoesNothing) { EXPECT_NO_THROW(COPPICE_ASSERT(1 < 2)); }

// No user can mend it, so it must not be told like the user's mistakes.
TEST(Precondition, ABrokenPreconditionIsNoErrorOfTheUser) {
    EXPECT_FALSE((std::is_base_of_v<Error, PreconditionBroken>));
}

}  // namespace
}  // namespace coppice
