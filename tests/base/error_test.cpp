#include "coppice/base/error.h"

#include <gtest/gtest.h>

#include <string>
#include <type_traits>

#include "errors.h"

namespace coppice {
namespace {

TEST(Error, EveryKindIsAnErrorWithItsMessage) {
    EXPECT_EQ(test::error_of<Error>([] { throw InvalidInput("radius: is 0"); }), "radius: is 0");
    EXPECT_EQ(test::error_of<Error>([] { throw IoError("tree.swc: is a folder"); }), "tree.swc: is a folder");
    EXPECT_EQ(test::error_of<Error>([] { throw Unsupported("LAS 2.0"); }), "LAS 2.0");
    EXPECT_EQ(test::error_of<Error>([] { throw Cancelled(); }), "interrupted");
    EXPECT_EQ(test::error_of<std::exception>([] { throw InvalidInput("radius: is 0"); }), "radius: is 0");
}

TEST(Error, KindsAreDistinct) {
    // Each has its own exit code, so that none is mistaken for another.
    EXPECT_THROW(test::error_of<IoError>([] { throw InvalidInput("x"); }), InvalidInput);
    EXPECT_THROW(test::error_of<InvalidInput>([] { throw Unsupported("x"); }), Unsupported);
    EXPECT_THROW(test::error_of<InvalidInput>([] { throw Cancelled(); }), Cancelled);
}

TEST(Precondition, EvaluatesASatisfiedConditionOnce) {
    int looked = 0;
    COPPICE_ASSERT(++looked == 1);
    EXPECT_EQ(looked, 1);
}

TEST(Precondition, ThrowsWithFileAndConditionAndPrintsNothing) {
    testing::internal::CaptureStderr();
    const std::string text = test::error_of<PreconditionBroken>([] { COPPICE_ASSERT(2 < 1); });
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_NE(text.find("error_test.cpp:"), std::string::npos) << text;
    EXPECT_TRUE(text.ends_with("precondition broken: 2 < 1")) << text;
}

// A user cannot fix it, so it must not be reported like an error of the user.
TEST(Precondition, PreconditionBrokenIsNotDerivedFromError) {
    EXPECT_FALSE((std::is_base_of_v<Error, PreconditionBroken>));
}

}  // namespace
}  // namespace coppice
