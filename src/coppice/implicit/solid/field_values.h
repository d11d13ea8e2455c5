#pragma once

#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/implicit/solid/solid_field.h"

namespace coppice {

/// The values of a field at many places, by all threads. Places that lie close together should stand so.
/// Throws Cancelled.
std::vector<float> values_at(const SolidField& field, std::span<const Vec3> places, const Context& ctx);

}  // namespace coppice
