#include "coppice/cuda/device.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(Device, FindReturnsADeviceOrTheReasonWhyNot) {
    const DeviceSearch search = find_device();
    EXPECT_NE(search.device.has_value(), !search.missing.empty());
    EXPECT_TRUE(has_cuda() || !search.device);
    if (search.device) {
        EXPECT_FALSE(search.device->name.empty());
        EXPECT_GT(search.device->memory, 0u);
        EXPECT_LE(search.device->free, search.device->memory);
        EXPECT_GE(search.device->compute, 75);
    }
}

}  // namespace
}  // namespace coppice
