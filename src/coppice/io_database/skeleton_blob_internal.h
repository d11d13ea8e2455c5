#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "coppice/skeleton/skeleton.h"

namespace coppice::io_internal {

/// Encodes a skeleton as little-endian 32-bit numbers: the number of nodes, then the columns of parents (2^32
/// - 1 for a root), positions and radii. The origin is omitted. Equal skeletons have equal encodings.
std::vector<std::byte> encode_blob(const Skeleton& skeleton);

/// Decodes a skeleton; returns nullopt if the bytes are invalid.
std::optional<Skeleton> decode_blob(std::span<const std::byte> bytes);

}  // namespace coppice::io_internal
