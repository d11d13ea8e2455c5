#pragma once

#include <span>
#include <string>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/io/skeleton/node_attribute.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// The writers that fill a file of their own; see write_skeleton(). `unit` is what they state; attributes
/// have a value for every node.

std::string encode_mtg(const Skeleton& skeleton, std::string_view unit,
                       std::span<const NodeAttribute> attributes, const Context& ctx);
std::string encode_rsml(const Skeleton& skeleton, std::string_view unit,
                        std::span<const NodeAttribute> attributes, const Context& ctx);

/// Name of the quantity by which formats that hold nodes in an order of their own keep that of the ids: see
/// put_in_written_order().
inline constexpr std::string_view kNodeNumber = "node";

/// How MTG files begin that Coppice wrote: the unit of their lengths follows.
inline constexpr std::string_view kMtgMark = "# MTG written by Coppice";

}  // namespace coppice
