#pragma once

#include "coppice/cage/cage.h"
#include "coppice/measure/cone_union.h"

namespace coppice {

/// The end that a surface with these options has, as the volume of its skeleton is measured; an open base is
/// flat.
/// @{
inline EndShape base_end(const ControlOptions& options) {
    return options.base == BaseShape::round ? EndShape::round : EndShape::flat;
}
inline EndShape tip_end(const ControlOptions& options) {
    return options.tips == TipShape::round ? EndShape::round : EndShape::flat;
}
/// @}

}  // namespace coppice
