#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/kernel/host_device.h"

namespace coppice::tetra_kernel {

/// A transformation of a field to a height that is 0 on its surface, positive inside, and nearly linear
/// across it; never NaN or infinite.
class Profile {
  public:
    /// Creates the profile of a field with iso value `level`.
    COPPICE_HOST_DEVICE explicit Profile(float level) : level_(level) {}

    /// Returns the height for a value of the field.
    COPPICE_HOST_DEVICE float height(float value) const {
        constexpr float kMax = 1e12f;
        if (level_ <= 0) {
            if (std::isnan(value)) return -1;
            return std::clamp(value - level_, -kMax, kMax);
        }
        if (!(value > 0)) return -1;
        const float h = std::pow(std::min(value / level_, kMax), kPower) - 1;
        // Rounding must not change the side.
        return value > level_ ? std::max(h, std::numeric_limits<float>::min()) : std::min(h, 0.0f);
    }

    /// Returns the derivative of the height with respect to the value.
    COPPICE_HOST_DEVICE float slope(float value) const {
        if (level_ <= 0) return 1;
        return value > 0 ? kPower * (1 + height(value)) / value : 0;
    }

  private:
    static constexpr float kPower = 0.4f;
    float level_;
};

}  // namespace coppice::tetra_kernel
