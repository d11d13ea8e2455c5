#pragma once

#include "coppice/cage/cage.h"
#include "coppice/measure/cone_union.h"

namespace coppice {

/// Returns the shape of the base or of the tips of a surface with these options, for the measured volume of
/// its skeleton; an open base counts as flat.
/// @{
inline EndShape base_end(const ControlOptions& options) {
    return options.base == BaseShape::round ? EndShape::round : EndShape::flat;
}
inline EndShape tip_end(const ControlOptions& options) {
    return options.tips == TipShape::round ? EndShape::round : EndShape::flat;
}
/// @}

}  // namespace coppice
