#pragma once

#include <cstdint>

#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Returns a synthetic tree of exactly `segments` >= 1 segments for tests and benchmarks: one trunk along +Z
/// from the origin with recursive laterals. Tips have a radius of 0.01 m; a pipe model with r^2.2
/// [Shinozaki1964] determines the other radii, so that the trunk of 30,000 segments is about 75 times as
/// thick. Segments are about 3.2 radii long, and the first one of a lateral ends outside its parent. A
/// direction that comes near a branch elsewhere is drawn again, up to 20 times, so that few branches
/// intersect that are not adjacent.
///
/// `hard` generates difficult input for meshing: half of the laterals branch off at 12 to 25 degrees, whorls
/// of up to seven laterals, segments shorter than their radius, and branches that intersect.
///
/// The tree depends on the arguments only. O(n log n): 300,000 segments need a few seconds.
/// Throws InvalidInput if `segments` is 0 or above 100 million.
Skeleton random_tree(std::uint32_t segments, std::uint64_t seed, bool hard = false);

}  // namespace coppice
