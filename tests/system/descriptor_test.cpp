#include "coppice/system/descriptor.h"

#include <fcntl.h>
#include <gtest/gtest.h>

#include <cerrno>

namespace coppice {
namespace {

int open_null() { return ::open("/dev/null", O_RDONLY | O_CLOEXEC); }

bool is_open(int number) { return ::fcntl(number, F_GETFD) >= 0; }

TEST(Descriptor, ClosesItsFileOnce) {
    const int number = open_null();
    {
        const Descriptor file(number);
        EXPECT_TRUE(file);
        EXPECT_TRUE(is_open(number));
    }
    EXPECT_FALSE(is_open(number));
    EXPECT_FALSE(Descriptor());
}

TEST(Descriptor, MovingTransfersTheFileAndClosesTheFormerOne) {
    const int first = open_null(), second = open_null();
    Descriptor a(first), b(second);
    a = std::move(b);
    EXPECT_FALSE(is_open(first));
    EXPECT_EQ(a.get(), second);
    Descriptor c(std::move(a));
    EXPECT_EQ(c.get(), second);
    EXPECT_TRUE(is_open(second));
    Descriptor released(c.release());
    EXPECT_FALSE(c);
    EXPECT_EQ(released.get(), second);
}

TEST(Descriptor, ClosingKeepsTheError) {
    Descriptor file(open_null());
    errno = ENOENT;
    file.close();
    EXPECT_EQ(errno, ENOENT);
    EXPECT_FALSE(file);
}

}  // namespace
}  // namespace coppice
