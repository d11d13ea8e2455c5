#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "coppice/io_skeleton/parsers_internal.h"

namespace coppice {

/// Expects the two cylinders that the tables and models of all kinds in these tests contain.
inline void expect_two_cylinders(const RawCylinders& read) {
    const std::vector<RawCylinder>& c = read.cylinders;
    ASSERT_EQ(c.size(), 2u);
    EXPECT_EQ(c[0].parent, -1);
    EXPECT_EQ(c[0].start, Vec3d(1, 2, 3));
    EXPECT_EQ(c[0].end, Vec3d(1, 2, 5));
    EXPECT_EQ(c[0].radius, 0.5);
    EXPECT_EQ(c[1].parent, c[0].id);
    EXPECT_EQ(c[1].start, Vec3d(1, 2, 5));
    EXPECT_EQ(c[1].end, Vec3d(2, 2, 5));
    EXPECT_EQ(c[1].radius, 0.25);
}

}  // namespace coppice
