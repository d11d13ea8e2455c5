#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/implicit/solid/solid_field.h"

namespace coppice {

/// Returns the values of a field at many points, computed by all threads. Fastest if consecutive points are
/// close together. Throws Cancelled.
std::vector<float> values_at(const SolidField& field, std::span<const Vec3> places, const Context& ctx);

}  // namespace coppice
