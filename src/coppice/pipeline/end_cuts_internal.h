#pragma once

#include <span>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/cage/cage.h"
#include "coppice/cuda/tetra/cut_convolution.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Returns whether a tree ends at this node in a plane across it.
bool ends_flat(const Skeleton& skeleton, NodeId node, const ControlOptions& ends);

/// Returns the planes through the flat ends of trees, each of which cuts off their field within a few radii.
/// Tips and roots (with one child) end as `ends` says; one box per region of the field.
EndCuts end_cuts(const Skeleton& skeleton, const ControlOptions& ends, std::span<const Box3> regions,
                 const Context& ctx);

}  // namespace coppice
