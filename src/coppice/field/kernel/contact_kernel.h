#pragma once

#include "coppice/base/kernel/host_device.h"
#include "coppice/implicit/field_ref.h"

namespace coppice {

/// Divides a field by `contact` times the field of the competing segments where that is above the iso value
/// 1, so that the two are separated by a gap: see ConvolutionField::set_regions.
COPPICE_HOST_DEVICE inline void press(const FieldSample& competitors, float contact, FieldSample& own) {
    const float against = contact * competitors.value;
    if (against <= 1) return;
    own.value /= against;
    own.gradient = own.gradient / against - competitors.gradient * (own.value / competitors.value);
}

}  // namespace coppice
