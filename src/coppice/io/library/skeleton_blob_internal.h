#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice::io_internal {

/// A skeleton as little-endian numbers of 32 bits: how many nodes, then parents (2^32 - 1 of a root),
/// positions and radii, column by column. The origin is left out. The same skeleton makes the same bytes.
std::vector<std::byte> encode_blob(const Skeleton& skeleton);

/// The other way around; none where the bytes are not such.
std::optional<Skeleton> decode_blob(std::span<const std::byte> bytes);

}  // namespace coppice::io_internal
