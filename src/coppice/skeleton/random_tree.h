#pragma once

#include <cstdint>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// A made-up tree of exactly `segments` >= 1 segments, for tests and benches: one trunk along +Z from the
/// origin with laterals of laterals. Tips have a radius of 0.01 m; from there rootward a pipe model sums
/// r^2.2 [Shinozaki1964], so that the trunk of 30,000 segments is about 75 times as thick. Segments are
/// about 3.2 radii long, and the first one of a lateral leaves the surface of its parent. A direction that
/// comes near a branch elsewhere is drawn anew, up to 20 times: few branches meet that are not neighbours.
///
/// `hard` gives what meshers stumble over: every second lateral leaves at 12 to 25 degrees, whorls of up to
/// seven laterals, segments shorter than their radius, and nothing keeps branches apart.
///
/// The same arguments give the same tree. O(n log n): 300,000 segments take a few seconds.
/// Throws InvalidInput when `segments` is 0 or above 100 million.
Skeleton random_tree(std::uint32_t segments, std::uint64_t seed, bool hard = false);

}  // namespace coppice
