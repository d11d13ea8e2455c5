#include "coppice/system/process.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <vector>

namespace coppice {
namespace {

TEST(Process, MemoryGrowsWithTouchedPages) {
    const ProcessMemory before = measure_memory();
    EXPECT_GT(before.resident, 0u);
    EXPECT_GE(before.peak, before.resident);
    constexpr std::size_t kBytes = std::size_t{64} << 20;
    const std::vector<char> touched(kBytes, 'x');
    const ProcessMemory after = measure_memory();
    // Half of it, because other memory may have been released.
    EXPECT_GT(after.resident, before.resident + kBytes / 2);
    EXPECT_GT(after.peak, before.resident + kBytes / 2);
    EXPECT_GT(after.data, before.data + kBytes / 2);
    EXPECT_EQ(touched.back(), 'x');
}

TEST(Process, ReturnsItsNumber) { EXPECT_EQ(get_process_id(), ::getpid()); }

TEST(Process, FindsSharedLibraries) {
    EXPECT_TRUE(has_shared_library("libc.so.6"));
    EXPECT_FALSE(has_shared_library("libcoppice-missing.so.1"));
}

}  // namespace
}  // namespace coppice
