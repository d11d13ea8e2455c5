#pragma once

#include "coppice/base/kernel/host_device.h"
#include "coppice/implicit/field_ref.h"

namespace coppice {

/// Divides a field by that of its rivals where `contact` times theirs is above the level 1, so that the two
/// meet at a wall with a gap: see ConvolutionField::set_regions.
COPPICE_HOST_DEVICE inline void press(const FieldSample& rivals, float contact, FieldSample& own) {
    const float against = contact * rivals.value;
    if (against <= 1) return;
    own.value /= against;
    own.gradient = own.gradient / against - rivals.gradient * (own.value / rivals.value);
}

}  // namespace coppice
