#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/kernel/host_device.h"

namespace coppice::tetra_kernel {

/// A field as a function that is 0 on its surface, greater inside, and near to a straight line across it;
/// never NaN or infinite.
class Profile {
  public:
    /// Of a field that is `level` on its surface.
    COPPICE_HOST_DEVICE explicit Profile(float level) : level_(level) {}

    /// Where the field has this value.
    COPPICE_HOST_DEVICE float height(float value) const {
        constexpr float kMost = 1e12f;
        if (level_ <= 0) {
            if (std::isnan(value)) return -1;
            return std::clamp(value - level_, -kMost, kMost);
        }
        if (!(value > 0)) return -1;
        const float h = std::pow(std::min(value / level_, kMost), kPower) - 1;
        // Rounding must not change the side.
        return value > level_ ? std::max(h, std::numeric_limits<float>::min()) : std::min(h, 0.0f);
    }

    /// Change of the height per change of the value, there.
    COPPICE_HOST_DEVICE float slope(float value) const {
        if (level_ <= 0) return 1;
        return value > 0 ? kPower * (1 + height(value)) / value : 0;
    }

  private:
    static constexpr float kPower = 0.4f;
    float level_;
};

}  // namespace coppice::tetra_kernel
