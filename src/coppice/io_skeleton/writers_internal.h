#pragma once

#include <span>
#include <string>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/io_skeleton/node_attribute.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Writers of formats in separate files; see write_skeleton(). `unit` is the stated unit; attributes have a
/// value for every node.

std::string encode_mtg(const Skeleton& skeleton, std::string_view unit,
                       std::span<const NodeAttribute> attributes, const Context& ctx);
std::string encode_rsml(const Skeleton& skeleton, std::string_view unit,
                        std::span<const NodeAttribute> attributes, const Context& ctx);

/// Name of the quantity with the node ids in formats that reorder the nodes: see put_in_written_order().
inline constexpr std::string_view kNodeNumber = "node";

/// Beginning of MTG files written by Coppice; the unit of their lengths follows.
inline constexpr std::string_view kMtgMark = "# MTG written by Coppice";

}  // namespace coppice
